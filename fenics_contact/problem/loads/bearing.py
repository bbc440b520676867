"""A pin's pressure on a hole: the cosine of the angle from the force, on the half that it loads.

With the outward normal n of the facets the pressure is max(−n · q, 0), which is a cosine around a
cylinder. The vector q is along the force there; on other meshes it is found so that the resultant
is the force.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad, LoadSite
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.values import AXES

# Shares of areas by their normals, and of the force, along the axis of a hole: but for this, none.
_AXIAL = 0.02
# Of q, between two solves for the loaded half; and how many there may be.
_SAME, _MOST = 1e-13, 50


@dataclass(frozen=True, eq=False)
class Bearing(ActingLoad):
    """A pressure of a pin on the loaded half of a hole.

    Attributes:
        hole: The hole.
        loaded: q that tells which half is loaded, (components,) (stress).
        size: q of the pressure there, (components,) (stress).
        rest: A traction that is the same everywhere, for what the facets of a mesh leave of the
            force, (components,) (stress).
    """

    kind: ClassVar[str] = "force"
    hole: Hole
    loaded: Array
    size: Array
    rest: Array

    @classmethod
    def of(cls, load: Load, components: Sequence[Any], key: str, site: LoadSite) -> Self | None:
        """Return the load; collective.

        Args:
            load: As the scene gives it: its force tells which half is loaded.
            components: Of the force, then of no moment; or their derivatives.
            key: Of the load.
            site: The body.

        Raises:
            InputError: The body has no such hole, or the force is not at right angles to it.
        """
        spaces, given = site.spaces, np.array(load.value["force"], float)
        group = cls.place(load.on, f"{key}.on", spaces)
        if not any(components) or not given.any():
            return None
        planes = site.planes_at(group)
        for plane in planes:
            if given[plane.axis]:
                raise InputError(
                    f"{key}.force: a bearing load along {AXES[plane.axis]} is across the plane of "
                    f"symmetry '{plane.on}', in which '{load.on}' ends"
                )
        hole = Hole(group, spaces, [plane.axis for plane in planes], f"{key}.on = '{load.on}'")
        loaded = hole.solve(given, f"{key}.force")
        size, rest = hole.spread(np.array(components[: len(given)], float), loaded)
        return cls(group, spaces, f"{key}.force", hole, loaded, size, rest)

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the surface, by one rule for resultants and nodal forces."""
        return self.hole.measure

    @property
    def force(self) -> Expr:
        """Force over area, against the normal."""
        return self._traction(ufl.FacetNormal(self.spaces.body.mesh))

    def missed_density(self, displacement: Expr, sides: CurvedSides) -> Expr:
        """On the surface further out, which is longer, and whose normal is turned."""
        flat, turned = self.force, self._traction(sides.normal - sides.slope)
        more = ufl.dot(turned * (1 + sides.stretch) - flat, displacement)
        return more + ufl.dot(flat, sides.further_motion(displacement))

    def missed(self, sides: CurvedSides) -> Array:
        """Nodal forces of what is missed, whose resultant is 0: the force is given."""
        found = super().missed(sides)
        size, rest = self.hole.spread(self.hole.resultant(found), self.loaded)
        return found - replace(self, size=size, rest=rest).nodal()

    def _traction(self, normal: Expr) -> Expr:
        mesh = self.spaces.body.mesh
        loaded, size, rest = (
            fem.Constant(mesh, value) for value in (self.loaded, self.size, self.rest)
        )
        return self.hole.traction(normal, loaded, size) + rest


class Hole:
    """A round surface that is pressed on one half; collective.

    Attributes:
        measure: Of the surface.

    Args:
        group: The surface.
        spaces: Those of the body.
        mirrored: Axes across planes of symmetry in which it ends.
        key: Of the surface, for messages.

    Raises:
        InputError: It is not round, or no cylinder.
    """

    def __init__(self, group: Group, spaces: Spaces, mirrored: Sequence[int], key: str) -> None:
        self._spaces = spaces
        size, mesh = spaces.components, spaces.body.mesh
        self.measure = spaces.boundary(group, {"quadrature_degree": spaces.bulk_degree + 2})
        self._loaded, self._size = (fem.Constant(mesh, np.zeros(size)) for _ in range(2))
        self._across = fem.Constant(mesh, np.eye(size))
        traction = self.traction(ufl.FacetNormal(mesh), self._loaded, self._size)
        test = ufl.TestFunction(spaces.displacement_space)
        self._form = form_cache.form(spaces.weight * ufl.dot(traction, test) * self.measure)
        self._kept = np.array([axis not in mirrored for axis in range(size)])
        one = np.arange(1.0, size + 1)
        every = self._matrix(one) + self._matrix(-one)
        self._area = float(np.trace(every))
        sizes, directions = np.linalg.eigh(every)
        is_round = sizes[-2] > _AXIAL * sizes[-1]
        if not is_round or (size == 3 and sizes[0] > _AXIAL * sizes[-1]):
            raise InputError(f"{key}: a bearing load needs a round hole, such as a cylinder")
        self._axis = directions[:, 0] if size == 3 else np.zeros(size)
        self._across.value[:] = np.eye(size) - np.outer(self._axis, self._axis)
        inside = self._across.value[np.ix_(self._kept, self._kept)]
        shares, vectors = np.linalg.eigh(inside)
        self._free = np.zeros((int((shares > 0.5).sum()), size))
        self._free[:, self._kept] = vectors[:, shares > 0.5].T

    def traction(self, normal: Expr, loaded: Expr, size: Expr) -> Expr:
        """Return the force over area where the outward normal is against a vector, in UFL.

        Args:
            normal: n, of which the part along the axis of the hole does not count.
            loaded: The vector.
            size: q of (n · q) n.
        """
        normal = ufl.dot(self._across, normal)
        pressed = ufl.conditional(ufl.lt(ufl.dot(normal, loaded), 0.0), 1.0, 0.0)
        return pressed * ufl.dot(normal, size) * normal

    def solve(self, force: Array, key: str) -> Array:
        """Return q of the pressure max(−n · q, 0) whose resultant is a force; collective.

        By Newton's method: the resultant is the gradient of a convex function, and linear in q as
        long as the same points are loaded.

        Args:
            force: The resultant, (components,) (force).
            key: Of the force, for messages.

        Raises:
            InputError: It is not at right angles to the hole.
        """
        if abs(force @ self._axis) > _AXIAL * np.linalg.norm(force):
            raise InputError(f"{key}: a bearing load must be at right angles to the hole's axis")
        found = force
        for _ in range(_MOST):
            before, (found, _) = found, self.spread(force, found)
            if np.linalg.norm(found - before) <= _SAME * np.linalg.norm(found):
                break
        return found

    def spread(self, force: Array, loaded: Array) -> tuple[Array, Array]:
        """Return q on a loaded half, and the uniform traction, that have a resultant; collective.

        Args:
            force: The resultant, (components,) (force).
            loaded: Vector that tells which half is loaded.
        """
        matrix = self._matrix(loaded)
        inside = self._free @ matrix @ self._free.T
        size = self._free.T @ np.linalg.solve(inside, self._free @ force)
        return size, np.where(self._kept, force - matrix @ size, 0.0) / self._area

    def resultant(self, nodal: Array) -> Array:
        """Return the sum of nodal forces, (components,); collective (force)."""
        return np.asarray(total(self._spaces.comm, nodal[: self._spaces.owned_nodes].sum(axis=0)))

    def _matrix(self, loaded: Array) -> Array:
        """∫ n nᵀ over the half that a vector loads, (components, components); collective (area)."""
        self._loaded.value[:] = loaded
        columns = []
        for unit in np.eye(len(loaded)):
            self._size.value[:] = unit
            columns.append(self.resultant(self._spaces.assemble(self._form)))
        return np.array(columns).T
