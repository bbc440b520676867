"""A part of the body whose unstressed length is shorter than drawn by q, as that of a tight bolt.

Its strain free of stress is −(q/l) a ⊗ a, with the unit axis a and the length l along it, so its
energy is ½ a(e, e) of the elastic strain e = e(u) + (q/l) a ⊗ a. The derivative of the energy in q
is the force along the axis, N = (1/l) ∫ a · σ a.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.description import PreloadedGroup
from fenics_contact.body.elasticity import Law
from fenics_contact.body.forms import Expr
from fenics_contact.body.parts.part_ends import PartEnds
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError


class PreloadedPart:
    """The part, and its strain free of stress; collective.

    Attributes:
        described: As in the scene.
        spaces: Those of the body.
        group: Its cells.
        length: Its extent along the axis (length).
        shortening: q, a constant in UFL (length).

    Args:
        described: As in the scene.
        key: Where, for messages.
        spaces: Those of the body.
        law: Of the body.

    Raises:
        InputError: The group has no cells, or its ends are not plane and normal to the axis.
    """

    def __init__(self, described: PreloadedGroup, key: str, spaces: Spaces, law: Law) -> None:
        body = spaces.body
        self.described, self.spaces = described, spaces
        self.group = body.group(described.on, f"{key}.on")
        if self.group.dimension != body.dimension:
            raise InputError(f"{key}.on = '{described.on}': must be a part of the body, not a side")
        axis = np.zeros(3)
        axis[: body.dimension] = described.axis
        axis /= np.linalg.norm(axis)
        self.length = PartEnds(self.group, axis, spaces, f"{key}.on = '{described.on}'").distance
        self.shortening = fem.Constant(body.mesh, 0.0)
        self._along = _unit_strain(axis, spaces, law)
        inside = fem.Function(fem.functionspace(body.mesh, ("DG", 0)))
        inside.x.array[body.entities(self.group)] = 1.0
        self._inside = inside

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the part, with the quadrature of the body's stiffness."""
        rule = {"quadrature_degree": self.spaces.bulk_degree}
        return self.spaces.part(self.group, rule)

    def stressless_strain(self, shortening: Expr) -> Expr:
        """−(q/l) a ⊗ a, (3, 3); in plane stress with what leaves that free across the plane.

        Args:
            shortening: q.
        """
        return -shortening / self.length * self._along

    @property
    def present_strain(self) -> Expr:
        """Present strain that is free of stress, anywhere in the body: 0 outside of the part."""
        return self._inside * self.stressless_strain(self.shortening)


def _unit_strain(axis: Array, spaces: Spaces, law: Law) -> Expr:
    """A ⊗ a; in plane stress with the thickness that it goes with."""
    along = np.outer(axis, axis)
    rows = along.tolist()
    if spaces.kinematics == "plane stress":
        xx, yy, xy = along[0, 0], along[1, 1], along[0, 1]
        rows[2][2] = law.thickness_strain(*(ufl.as_ufl(float(part)) for part in (xx, yy, xy)))
    return ufl.as_tensor(rows)
