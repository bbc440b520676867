"""Stress and strain along lines, as ``result.json`` and ``lines.csv`` have it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.results.records.record import Record


@dataclass(frozen=True, eq=False, kw_only=True)
class StressLineRecord(Record):
    """Stress and strain at points along a line in the last load step, without error bars.

    Attributes:
        name: Of the line.
        distances: From the beginning of the line to each point (length).
        places: The points in the undeformed body, [x, y, z] each (length).
        stress: Component → its value at each point, null outside the body (stress). It is the mean
            over the cells of one material around each node, interpolated between the nodes.
        temperature: At each point, null outside the body (temperature); null where the scene has no
            temperatures.
        strain: Component → its value at each point, null outside the body, as the stress; of all
            that strains the body, heat too. That of `xy` is half of the change of the angle.
    """

    name: str
    distances: list[float]
    places: list[list[float]]
    stress: Mapping[str, list[float | None]]
    temperature: list[float | None] | None = None
    strain: Mapping[str, list[float | None]] = field(default_factory=dict)

    @property
    def is_inside(self) -> list[bool]:
        """Whether each point is in the body."""
        return [value is not None for value in next(iter(self.stress.values()))]

    @property
    def von_mises(self) -> Array:
        """Von Mises stress at each point, not a number outside the body, (points,) (stress)."""
        known = {name: np.array(values, dtype=float) for name, values in self.stress.items()}
        xx, yy, zz = (known[name] for name in ("xx", "yy", "zz"))
        shear = sum(known[name] ** 2 for name in ("yz", "xz", "xy") if name in known)
        direct = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        return np.asarray(np.sqrt(direct / 2 + 3 * shear))


def line_record(
    name: str,
    places: Array,
    inside: Flags,
    stress: Mapping[str, Array],
    strain: Mapping[str, Array],
    temperature: Array | None = None,
) -> StressLineRecord:
    """The record of a line.

    Args:
        name: Of the line.
        places: Its points, (points, 3) (length).
        inside: Whether each is in the body, (points,).
        stress: By component, (points,) each (stress).
        strain: Likewise.
        temperature: (points,) (temperature); None without any.
    """
    values, strains = (
        {component: _where_inside(row, inside) for component, row in tensor.items()}
        for tensor in (stress, strain)
    )
    distances = np.linalg.norm(places - places[0], axis=1)
    return StressLineRecord(
        name=name,
        distances=distances.tolist(),
        places=places.tolist(),
        stress=values,
        temperature=None if temperature is None else _where_inside(temperature, inside),
        strain=strains,
    )


def _where_inside(values: Array, inside: Flags) -> list[float | None]:
    """Values of points, None outside the body."""
    return [float(value) if is_in else None for value, is_in in zip(values, inside, strict=True)]
