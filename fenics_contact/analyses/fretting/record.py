"""Fretting in a result: criteria of fatigue at the nodes near contacts, and their worst places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.results.records.record import ErrorRow, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class WorstPlace(Record):
    """Where a criterion is largest.

    Attributes:
        value: Of the criterion (stress).
        errors: Estimated errors of it; of the mesh, as the difference of two recoveries of the
            stress, or 2.4 times what it changes by within two cells, where that is more.
        at: The place, undeformed, three coordinates (length).
        body: The connected part of the body that it is of.
        contact: The contact on whose surface it lies; empty below a surface or beside it.
        plane: Unit normal of the critical plane, of `swt`.
        life: Cycles to a crack, of `swt` where the scene has constants of the material; null where
            it is endless.
        life_errors: Estimated errors of these.
        safety_factor: The fatigue limit in torsion over the value, of the others; null where no
            load of this kind ever reaches it.
        safety_factor_errors: Estimated errors of it.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"plane", "life_errors", "safety_factor_errors"})

    value: float
    errors: ErrorRow
    at: list[float]
    body: str
    contact: str = ""
    plane: list[float] = field(default_factory=list)
    life: float | None = None
    life_errors: ErrorRow = field(default_factory=dict)
    safety_factor: float | None = None
    safety_factor_errors: ErrorRow = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class FrettingRecord(Record):
    """Criteria of fatigue by the history of stress near contacts.

    Attributes:
        steps: How many states of the body make the cycle, its begin with them.
        places: At how many nodes, all of them in `fretting.csv`.
        crossland_alpha: Factor of the mean stress, by the fatigue limits.
        dang_van_alpha: Likewise.
        worst: `swt`, `crossland`, `dang_van` → where it is largest; empty where nothing touched.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"crossland_alpha", "dang_van_alpha"})

    steps: int
    places: int
    crossland_alpha: float | None = None
    dang_van_alpha: float | None = None
    worst: Mapping[str, WorstPlace] = field(default_factory=dict)


# What each column is.
FRETTING_COLUMNS = {
    "swt": "σ_n,max Δε_n/2 of the critical plane (stress)",
    "life": "cycles to a crack by it",
    "shear_amplitude": "√J₂a, of the smallest ball around the path of the deviator (stress)",
    "max_mean_stress": "largest third of the trace, > 0 in tension (stress)",
    "crossland": "√J₂a + α p_max (stress)",
    "dang_van": "largest τ + α p (stress)",
}


@dataclass(frozen=True, eq=False)
class FrettingPlaces:
    """Nodes near where contacts touched.

    Attributes:
        coordinates: Undeformed, (places, 3) (length).
        body: The connected part that each is of.
        contact: The contact on whose surface each lies; empty off the surfaces.
        values: Column → values at the places, of those in ``FRETTING_COLUMNS``.
        bars: Column → their estimated errors by the mesh.
        planes: Unit normals of the critical planes, (places, 3).
    """

    coordinates: Array
    body: list[str]
    contact: list[str]
    values: Mapping[str, Array]
    bars: Mapping[str, Array]
    planes: Array

    def rows(self) -> list[list[str]]:
        """The lines of ``fretting.csv``, its header first; empty where a number is none."""
        names = [name for name in FRETTING_COLUMNS if name in self.values]
        header = ["body", "contact", "x", "y", "z", "plane_x", "plane_y", "plane_z"]
        header += [column for name in names for column in (name, f"{name}_error")]
        columns = [*self.coordinates.T, *self.planes.T]
        columns += [array for name in names for array in (self.values[name], self.bars[name])]
        numbers = np.stack(columns, axis=1).tolist()
        return [header] + [
            [body, contact, *(_written(number) for number in row)]
            for body, contact, row in zip(self.body, self.contact, numbers, strict=True)
        ]


def _written(number: float) -> str:
    return f"{number:.8g}" if np.isfinite(number) else ""
