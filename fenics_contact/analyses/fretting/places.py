"""Criteria of fatigue at the nodes near contacts: the rows of ``fretting.csv``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

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
