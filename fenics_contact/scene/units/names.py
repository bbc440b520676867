"""Names of units by dimension. No pint: the names are kept with a result."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class UnitNames:
    """Names of units.

    Attributes:
        length: Such as ``mm``.
        force: Such as ``N``.
        stress: Such as ``MPa``.
        energy: Such as ``mJ``.
        per_unit_thickness: Whether forces, areas and energies of the model are per length.

    >>> names = UnitNames("mm", "N", "MPa", "mJ")
    >>> names.of("force"), names.of("area"), names.of("length/stress"), names.of("")
    ('N', 'mm²', 'mm/MPa', '')
    >>> UnitNames("mm", "N", "MPa", "mJ", per_unit_thickness=True).of("force")
    'N/mm'
    """

    length: str
    force: str
    stress: str
    energy: str
    per_unit_thickness: bool = False

    def of(self, words: str) -> str:
        """The unit of what is measured.

        Args:
            words: Such as ``stress/length``; empty of a pure number.
        """
        if self.per_unit_thickness and words in ("force", "energy", "impulse"):
            return self._of_all(f"{words}/length")
        return self._of_all(_PER_THICKNESS.get(words, words) if self.per_unit_thickness else words)

    def _of_all(self, words: str) -> str:
        if words in ("mass", "mass/volume"):
            return f"{self.force}·s²/{self.length}{'' if words == 'mass' else '⁴'}"
        if words == "cycles/time":
            return "Hz"
        over, slash, under = words.partition("/")
        power = {"area": "²", "volume": "³", "length^m": "^m"}
        named = {"length": self.length, "force": self.force}
        named |= {"stress": self.stress, "energy": self.energy, "": "", "1": "1"}
        named |= {"time": "s", "impulse": f"{self.force}·s"}
        name = named[over] if over in named else self.length + power[over]
        if not slash:
            return name
        below = self._of_all(under)
        return f"{name}/{f'({below})' if set(below) & set('/·') else below}"


# What models of unit thickness have in place of it.
_PER_THICKNESS = {"area": "length", "volume": "area"}
