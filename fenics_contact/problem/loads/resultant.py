"""Forces and moments over a surface: a traction that is linear over it, or a bearing pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import SymmetryPlane
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad, LoadSite
from fenics_contact.problem.loads.affine import AffineLoad, Moments, rotations
from fenics_contact.problem.loads.bearing import Bearing
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.values import AXES

# Of the largest moment of inertia of a surface: it is as thin as a line.
_LINE = 1e-10
# Of a moment: a part of it that is nothing.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, eq=False)
class Resultant(AffineLoad):
    """A force and a moment over a surface, spread so that it is not stiffened.

    The traction a + b × (x − c) is that of a distributing coupling whose weights are areas. A
    surface that ends in a plane of symmetry is half of one: the moments that its mirror image takes
    away are those of supports there.

    Attributes:
        axes: Axes, of ``rotations``, about which it has moments.
    """

    kind: ClassVar[str] = "force"
    axes: Integers

    @classmethod
    def of(
        cls, load: Load, components: Sequence[Any], key: str, site: LoadSite
    ) -> ActingLoad | None:
        """Return the load; collective.

        Args:
            load: As the scene gives it.
            components: Of the force, then of the moment; or their derivatives.
            key: Of the load.
            site: The body.

        Raises:
            InputError: The body has no such boundary, or this cannot take the moment.
        """
        spaces, given = site.spaces, load.value
        if given.get("distribution") == "bearing":
            return Bearing.of(load, components, key, site)
        group = cls.place(load.on, f"{key}.on", spaces)
        if not any(components):
            return None
        force = np.array(components[: spaces.components], float)
        moment = np.array(components[spaces.components :], float)
        moments = site.discrete.once(
            ("moments", group), lambda: Moments.of(ufl.as_ufl(1.0), _measure(group, spaces), spaces)
        )
        planes = site.planes_at(group)
        turns = rotations(spaces.components)
        _require_symmetric(given, planes, key, load.on)
        axes = _symmetric_axes(spaces, planes)
        if "at" in given:
            arm = np.array(given["at"], float) - moments.centroid
            moment = moment + np.einsum("kij,j,i->k", turns, arm, force)
        about = _spread(moments, moment, axes)
        if about is None:
            raise InputError(
                f"{key}.moment: '{load.on}' is as thin as a line, about which no traction turns it"
            )
        uniform = force / moments.size
        linear = np.tensordot(about, turns, 1)
        return cls(group, spaces, f"{key}.force", uniform, linear, moments, axes)

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the surface, by one rule for resultants and nodal forces."""
        return _measure(self.group, self.spaces)

    def missed_density(self, displacement: Expr, sides: CurvedSides) -> Expr:
        """On the surface further out, where a traction that is linear in the place is another."""
        further = ufl.dot(fem.Constant(self.spaces.body.mesh, self.linear), sides.normal)
        more = sides.offset * ufl.dot(further, displacement)
        return super().missed_density(displacement, sides) + more

    def missed(self, sides: CurvedSides) -> Array:
        """Nodal forces of what is missed, whose resultants are 0: those are given."""
        found = super().missed(sides)
        force, moment = self.moments.resultants(found)
        if self.spaces.kinematics == "axisymmetric":
            force[0] = 0.0
        about = _spread(self.moments, moment, self.axes)
        assert about is not None
        linear = np.tensordot(about, rotations(self.spaces.components), 1)
        return found - self.moments.nodal(force / self.moments.size, linear)


def _measure(group: Group, spaces: Spaces) -> ufl.Measure:
    return spaces.boundary(group, {"quadrature_degree": spaces.bulk_degree + 2})


def _symmetric_axes(spaces: Spaces, planes: Sequence[SymmetryPlane]) -> Integers:
    """Axes about which a moment is its own mirror image in all of some planes."""
    if spaces.kinematics == "axisymmetric" or (planes and spaces.components == 2):
        return np.zeros(0, dtype=np.int64)
    every = range(3 if spaces.components == 3 else 1)
    return np.array(
        [axis for axis in every if all(plane.axis == axis for plane in planes)], dtype=np.int64
    )


def _require_symmetric(
    given: dict[str, Any], planes: Sequence[SymmetryPlane], key: str, on: str
) -> None:
    """Refuse moments that the mirror image of a surface takes away.

    Raises:
        InputError: There are such.
    """
    for plane in planes:
        where = f"the plane of symmetry '{plane.on}', in which '{on}' ends"
        moment = given.get("moment", 0.0)
        across = [moment] if not isinstance(moment, tuple) else [*moment]
        if isinstance(moment, tuple):
            del across[plane.axis]
        if any(across):
            about = f" about axes other than {AXES[plane.axis]}" if len(across) > 1 else ""
            raise InputError(
                f"{key}.moment: a moment{about} has no mirror image like it in {where}; model "
                "the whole"
            )
        if "at" in given and given["force"][plane.axis]:
            raise InputError(
                f"{key}.at: not of a force across {where}; leave it out, or model the whole"
            )


def _spread(moments: Moments, moment: Array, axes: Integers) -> Array | None:
    """Return b of the traction b × (x − c) that has a moment about some axes, (rotations,).

    Args:
        moments: Of the surface.
        moment: About its centroid, (rotations,) (force times length).
        axes: Those that count.

    Returns:
        None where no traction has it, as on a line about itself.
    """
    found = np.zeros(len(moment))
    if not moment[axes].any():
        return found
    second = moments.second[np.ix_(axes, axes)]
    sizes, directions = np.linalg.eigh((second + second.T) / 2)
    is_line = sizes <= _LINE * moments.second.max()
    if (np.abs(directions[:, is_line].T @ moment[axes]) > _ROUND_OFF * np.abs(moment).max()).any():
        return None
    found[axes] = np.linalg.lstsq(second, moment[axes], rcond=_LINE)[0]
    return found
