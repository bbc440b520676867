"""The far field: a body's outer boundary moves as that of a half-space would.

The displacement there is that of point forces on the surface, of line forces in plane strain
(``half_space_fields``): the resultants of the contacts, into the half-space and along its surface,
with their mirror images in planes of symmetry. Where a resultant is not known beforehand it is an
unknown of the problem, in which this is linear.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from fenics_contact.analytic.complex_step import slope
from fenics_contact.analytic.half_space import boussinesq, cerruti, flamant, flamant_along
from fenics_contact.common.arrays import Array, Integers, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import gather_rows, largest, smallest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.facets import relative_facet_size
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.scene.scene import Scene

_FLAT = 1e-6
# Places around half a revolution that stand for a ring: moments up to twice their number are right.
_ON_A_RING = 4
# Pairs of points and forces at once.
_AT_ONCE = 200_000


class FarField:
    """The outer boundary of a piece of a half-space.

    Args:
        scene: What is described.
        discrete: The body.
        contacts: In scene order.

    Attributes:
        on: The groups' names, for results.
        dofs: Those that follow the far field (local indices, owned and ghost).
        columns: Number of a contact → displacement of the dofs over its force.
        sideways: Number of a contact → unit vectors (components,) along which it may exert a
            force on the surface, each with the displacement of the dofs over it.
        beyond: Displacement of the dofs beyond that of the resultants: none, but where it is to be
            seen what that leaves out (length).
    """

    def __init__(
        self,
        scene: Scene,
        discrete: DiscreteBody,
        contacts: list[ContactSurface],
    ) -> None:
        described = scene.half_space
        assert described is not None
        self.on = described.label
        self._spaces, self._held = discrete.spaces, discrete.held
        self._modulus, self._ratio = _homogeneous(scene)
        self.dofs: Integers = discrete.once(
            "far field dofs", lambda: np.setdiff1d(discrete.outer, discrete.held.dofs)
        )
        self.beyond = np.zeros(len(self.dofs))
        self._columns: dict[bytes, Array] = discrete.found.setdefault("far field", {})
        self.columns: dict[int, Array] = {}
        self.sideways: dict[int, list[tuple[Array, Array]]] = {}
        self._known_feet: dict[tuple[object, ...], Array] = discrete.found.setdefault("feet", {})
        self._feet: dict[int, Array] = {}
        self._inward: dict[int, Array] = {}
        for number, contact in enumerate(contacts):
            self._place(number, contact)
        if discrete.held.parallel_planes:
            raise InputError("symmetry: planes that face each other leave no half_space")
        if not contacts:
            raise InputError("half_space: without a contact there is no force to follow")

    def _place(self, number: int, contact: ContactSurface) -> None:
        """The columns of a contact."""
        components = self._spaces.components
        inward = np.zeros(3)
        inward[:components] = contact.kinematics.direction
        foot = self._kept_foot(number, contact, inward)
        self._feet[number], self._inward[number] = foot, inward
        self.columns[number] = self._column(foot, inward, None)
        self.sideways[number] = [
            (along[:components], self._column(foot, inward, along))
            for along in (self._tangents(inward) if contact.can_shear else ())
            if not self._cancels(foot, along)
        ]

    def _column(self, foot: Array, inward: Array, along: Array | None) -> Array:
        """Displacement of the dofs over a force into the half-space or along its surface."""
        parts = (foot, inward, np.zeros(0) if along is None else along)
        key = b"".join(part.tobytes() for part in parts)
        if key not in self._columns:
            self._columns[key] = self._new_column(foot, inward, along)
        return self._columns[key]

    def _new_column(self, foot: Array, inward: Array, along: Array | None) -> Array:
        points, reach = self._points(), self._reach(foot)
        column = np.zeros_like(points)
        for image, signs in self._images(foot):
            turned = None if along is None else signs * along
            column = column + self._unit_field(points - image, inward, turned, reach)
        return self._at_dofs(column)

    def slopes(self, name: str) -> FarField:
        """The far field with the slopes of all its columns in a modulus in their place.

        Args:
            name: ``youngs_modulus`` or ``poissons_ratio``.
        """
        found, moved = copy.copy(self), copy.copy(self)
        present = self._modulus if name == "youngs_modulus" else self._ratio

        def columns(number: int) -> list[Array]:
            foot, inward = self._feet[number], self._inward[number]
            ways = [None, *(in_3d(along) for along, _ in self.sideways[number])]
            return [moved._new_column(foot, inward, way) for way in ways]

        def every(value: complex) -> list[Array]:
            moved._take_modulus(name, value)
            return [column for number in self.columns for column in columns(number)]

        slopes = iter(slope(every, present))
        found.columns, found.sideways = {}, {}
        for number in self.columns:
            found.columns[number] = next(slopes)
            found.sideways[number] = [(along, next(slopes)) for along, _ in self.sideways[number]]
        return found

    def _take_modulus(self, name: str, value: Any) -> None:
        """Have another Young's modulus or Poisson's ratio, which may be complex."""
        if name == "youngs_modulus":
            self._modulus = value
        else:
            self._ratio = value

    def _unit_field(self, arms: Array, inward: Array, along: Array | None, reach: float) -> Array:
        """Displacement over a force, into the half-space or along its surface, (points, 3)."""
        constants = inward, self._modulus, self._ratio
        if self._spaces.kinematics == "plane strain":
            if along is None:
                return flamant(arms, *constants, reach)
            return flamant_along(arms, along, *constants, reach)
        return boussinesq(arms, *constants) if along is None else cerruti(arms, along, *constants)

    def _points(self) -> Array:
        """Where the dofs are, (dofs, 3)."""
        return np.asarray(self._spaces.coordinates[self.dofs // self._spaces.components])

    def _reach(self, foot: Array) -> float:
        """Distance of the outer boundary's farthest point; collective."""
        return largest(self._spaces.comm, np.linalg.norm(self._points() - foot, axis=1))

    def _at_dofs(self, displacement: Array) -> Array:
        """The component of each dof out of displacements of shape (dofs, 3)."""
        return displacement[np.arange(len(self.dofs)), self.dofs % self._spaces.components]

    def left_out(self, number: int, places: Array, forces: Array) -> Array:
        """Displacement of the dofs by a contact's forces where they act, less by their resultant.

        Collective.

        Args:
            number: Of the contact, in scene order.
            places: Of all forces of it, on every rank, (places, 3) (length).
            forces: On the body; in axisymmetric models of a full revolution, (places, 3) (force).

        Returns:
            Of shape (dofs,) (length).
        """
        components = self._spaces.components
        foot, inward = self._feet[number], self._inward[number]
        reach = self._reach(foot)
        nodes, of_node = np.unique(self.dofs // components, return_inverse=True)
        points = self._spaces.coordinates[nodes]
        found = -self.columns[number] * (forces @ inward).sum()
        for along, column in self.sideways[number]:
            found -= column * (forces[:, :components] @ along).sum()
        if self._spaces.kinematics == "axisymmetric":
            places, forces = _around(places, forces)
        moved = np.zeros_like(points)
        ways = [None, *np.linalg.svd(inward[None])[2][1:]]  # into the surface, and along it
        if self._spaces.kinematics == "plane strain":
            ways = [None, *self._tangents(inward)]
        size = max(1, _AT_ONCE // max(1, len(points)))
        for begin in range(0, len(places), size):
            here = slice(begin, begin + size)
            for image, signs in self._images(places[here]):
                arms = (points[:, None] - image).reshape(-1, 3)
                for way in ways:
                    turned = None if way is None else signs * way
                    part = forces[here] @ (inward if way is None else way)
                    field = self._unit_field(arms, inward, turned, reach)
                    moved += np.einsum("ijk,j->ik", field.reshape(len(points), len(part), 3), part)
        return found + self._at_dofs(moved[of_node])

    def _tangents(self, inward: Array) -> list[Array]:
        """Unit vectors along the surface, along axes where it is, (3,) each.

        Around an axis of revolution tangential forces have no resultant.
        """
        if self._spaces.kinematics == "axisymmetric":
            return []
        components = self._spaces.components
        first = np.eye(3)[np.argmin(np.abs(inward[:components]))]
        first = first - (first @ inward) * inward
        first /= np.linalg.norm(first)
        return [first, np.cross(inward, first)][: components - 1]

    def _images(self, foot: Array) -> Iterator[tuple[Array, Array]]:
        """Points (…, 3) and their mirror images, each with the signs of mirrored components."""
        planes = self._held.planes
        for mirrored in product((False, True), repeat=len(planes)):
            image, signs = foot.copy(), np.ones(3)
            for plane, is_mirrored in zip(planes, mirrored, strict=True):
                if is_mirrored:
                    image[..., plane.axis] = 2 * plane.at - image[..., plane.axis]
                    signs[plane.axis] = -1.0
            yield image, signs

    def _cancels(self, foot: Array, along: Array) -> bool:
        """Whether a force across a plane of symmetry acts in it, so that its image undoes it."""
        size = largest(self._spaces.comm, np.abs(self._spaces.coordinates - foot).ravel())
        return any(
            abs(along[plane.axis]) > _FLAT and abs(foot[plane.axis] - plane.at) <= _FLAT * size
            for plane in self._held.planes
        )

    def _kept_foot(self, number: int, contact: ContactSurface, inward: Array) -> Array:
        """``_foot``, found and tested once for all that it depends on besides the body."""
        apex, law = self._apex(contact), contact.normal
        is_driven = contact.force is not None
        known = number, apex.tobytes(), inward.tobytes(), law.has_counterpart, is_driven
        if known not in self._known_feet:
            self._known_feet[known] = self._foot(contact, apex, inward, f"contact[{number}]")
        return self._known_feet[known]

    def _foot(self, contact: ContactSurface, apex: Array, inward: Array, key: str) -> Array:
        """Where the resultant acts: the obstacle's apex, on the surface."""
        trace, comm = contact.trace, self._spaces.comm
        rows = np.hstack([trace.coordinates, trace.normals])[trace.owned]
        rows = gather_rows(comm, rows)
        normals = np.zeros((len(rows), 3))
        normals[:, : self._spaces.components] = rows[:, 3:]
        flat = largest(comm, np.abs(normals + inward).ravel()) <= _FLAT
        if not (contact.normal.has_counterpart and flat):
            raise InputError(
                f"{key}: a half_space needs a flat contact surface and an obstacle that is driven "
                "straight into it"
            )
        if self._spaces.kinematics == "plane strain" and contact.force is None:
            raise InputError(
                f"{key}.obstacle: in plane strain the indentation of a half-space has no datum (it "
                "grows with the logarithm of the distance), so give its force"
            )
        foot = apex + ((rows[0, :3] - apex) @ inward) * inward
        self._require_inside(rows[:, :3], foot, contact, key)
        return foot

    def _apex(self, contact: ContactSurface) -> Array:
        """The obstacle's position, by default the origin; without any, the surface's middle."""
        obstacle = contact.contact.obstacle
        apex = np.zeros(3)
        if obstacle is not None and obstacle.position is not None:
            apex[: self._spaces.components] = obstacle.position
        elif obstacle is None or not obstacle.has_form:
            trace = contact.trace
            apex = trace.integral(trace.coordinates) / trace.integral(np.ones(len(trace.weights)))
            if self._spaces.kinematics == "axisymmetric":
                apex[0] = 0.0
        return apex

    def _require_inside(
        self, points: Array, foot: Array, contact: ContactSurface, key: str
    ) -> None:
        """The force acts on the contact surface, and well inside the outer boundary."""
        spaces, comm = self._spaces, self._spaces.comm
        facet = relative_facet_size(contact.trace.surface) * contact.trace.extent()
        outer = spaces.coordinates[self.dofs // spaces.components]
        distance = smallest(comm, np.linalg.norm(outer - foot, axis=1))
        lowest, highest = points.min(axis=0) - facet, points.max(axis=0) + facet
        around = (foot >= lowest) & (foot <= highest)  # a ring has its foot in the middle
        if spaces.kinematics == "axisymmetric":
            around[0] = True
        if not around.all() or distance < facet:
            where = ", ".join(f"{x:.4g}" for x in foot[: spaces.components])
            raise InputError(
                f"{key}.obstacle.position: its force on the half_space would act at ({where}), "
                "which must lie on the contact surface and well inside the outer boundary"
            )


def _around(places: Array, forces: Array) -> tuple[Array, Array]:
    """Rings as places around half of each; the other half mirrors it, in the plane of the model."""
    angles = np.pi * (np.arange(_ON_A_RING) + 0.5) / _ON_A_RING

    def turned(vectors: Array) -> Array:
        radial, along = vectors[:, None, 0], np.tile(vectors[:, None, 1], len(angles))
        rows = radial * np.cos(angles), along, radial * np.sin(angles)
        return np.stack(rows, axis=-1).reshape(-1, 3)

    return turned(places), turned(forces) / _ON_A_RING


def _homogeneous(scene: Scene) -> tuple[float, float]:
    """Young's modulus and Poisson's ratio of a half-space, which must be uniform."""
    material = scene.material[0]
    young, poisson = material.youngs_modulus, material.poissons_ratio
    numbers = isinstance(young, float | int) and isinstance(poisson, float | int)
    if len(scene.material) == 1 and numbers:
        return float(young), float(poisson)  # type: ignore[arg-type]
    raise InputError(
        "half_space: the material must be one, isotropic and uniform (numbers for youngs_modulus "
        "and poissons_ratio)"
    )
