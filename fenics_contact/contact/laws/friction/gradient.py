"""Derivatives of a quantity in what a law along a contact works on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from fenics_contact.common.arrays import Array


@dataclass(frozen=True, eq=False)
class FrictionGradient:
    """Derivatives of a quantity in what a law along a contact works on, at the points.

    Attributes:
        slip: In the slip since the start, (points, components).
        reference: In the slip that counts as none, likewise.
        pressure: In the pressure that the bound follows, (points,).
        fields: In each parameter of the law by name, the arrays of its rule's state among them,
            (points,), or (points, components) of vectors.
    """

    slip: Array
    reference: Array
    pressure: Array
    fields: Mapping[str, Array]
