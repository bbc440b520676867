"""Units of a run's numbers, where the scene has some."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fenics_contact.results.records.record import Record
from fenics_contact.scene.units.names import UnitNames


@dataclass(frozen=True, eq=False, kw_only=True)
class UnitsRecord(Record):
    """Units of all numbers of a run's files.

    Attributes:
        length: Such as `mm`.
        force: Such as `N`.
        stress: Such as `MPa`.
        energy: Such as `mJ`.
        per_unit_thickness: Whether forces, areas and energies are per length, as in plane models
            without a thickness.
        quantities: Quantity → its unit in this run; without those that are pure numbers.
    """

    length: str
    force: str
    stress: str
    energy: str
    per_unit_thickness: bool = False
    quantities: Mapping[str, str] = field(default_factory=dict)

    def of(self, words: str) -> str:
        """The unit of what is measured, such as ``stress/length``; empty of a pure number."""
        if not self.length:
            return ""
        names = UnitNames(
            self.length, self.force, self.stress, self.energy, self.per_unit_thickness
        )
        return names.of(words)


#: Where a scene has none: nothing is said.
NO_UNITS = UnitsRecord(length="", force="", stress="", energy="")
