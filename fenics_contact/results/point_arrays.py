"""The arrays at contact points: one list, from which they are kept, gathered and written."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PointArray:
    """A named array at the contact points.

    Attributes:
        name: Of the attribute that it is, where points are.
        unit: Such as ``length``.
        is_vector: Whether it is (points, components), not (points,).
        columns: Of ``contact.csv``, three of a vector; none of what is not written there.
    """

    name: str
    unit: str
    is_vector: bool = False
    columns: tuple[str, ...] = ()


def _vector(name: str, unit: str, column: str) -> PointArray:
    return PointArray(name, unit, True, tuple(f"{column}_{axis}" for axis in "xyz"))


# Numbers of ``ContactState``, beside the status.
AT_POINTS = (
    PointArray("gap", "length", columns=("gap",)),
    PointArray("contact_pressure", "stress", columns=("contact_pressure",)),
    _vector("friction_traction", "stress", "traction"),
    _vector("slip", "length", "slip"),
    PointArray("penalty_energy", "energy/area"),
)
WRITTEN = tuple(array for array in AT_POINTS if array.columns)
