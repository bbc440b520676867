"""The far field: a body's outer boundary moves as that of a half-space would.

The displacement there is that of point forces on the surface (J. Boussinesq; K. L. Johnson,
Contact Mechanics, Cambridge 1985, (3.18)), of line forces in plane strain (A. Flamant; Johnson
(2.19)): the resultants of the contacts, with their mirror images in planes of symmetry. Where
a resultant is not known beforehand it is an unknown of the problem, in which this is linear.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact import ContactSurface
from fenics_contact.errors import InputError
from fenics_contact.parallel import gather_rows, largest, smallest
from fenics_contact.scene import Scene
from fenics_contact.scene_contact import HalfSpace
from fenics_contact.spaces import Spaces
from fenics_contact.supports import Supports

Array = NDArray[np.float64]

_FLAT = 1e-6


def boussinesq(points: Array, inward: Array, youngs_modulus: float, poissons_ratio: float) -> Array:
    """Displacement of a half-space under a unit point force on its surface.

    Args:
        points: Relative to the force, shape (points, 3) (length).
        inward: Unit normal into the half-space, along which the force acts, (3,).
        youngs_modulus: E (stress).
        poissons_ratio: ν.

    Returns:
        Displacement over force, shape (points, 3) (Johnson, (3.18)).
    """
    nu = poissons_ratio
    z = points @ inward
    aside = points - np.outer(z, inward)
    rho = np.linalg.norm(points, axis=1)
    shear_modulus = youngs_modulus / (2 * (1 + nu))
    deep = z**2 / rho**3 + 2 * (1 - nu) / rho
    wide = z / rho**3 - (1 - 2 * nu) / (rho * (rho + z))
    return (np.outer(deep, inward) + wide[:, None] * aside) / (4 * np.pi * shear_modulus)


def flamant(
    points: Array, inward: Array, youngs_modulus: float, poissons_ratio: float, datum: float
) -> Array:
    """Displacement of a half-plane in plane strain under a unit line force on its edge.

    A logarithm needs a datum: it is zero straight below the force, at the given distance.
    The other arguments and shapes are those of ``boussinesq``.

    Returns:
        Displacement over force per thickness, shape (points, 3) (Johnson, (2.19)).
    """
    nu = poissons_ratio
    z = points @ inward
    aside = points - np.outer(z, inward)
    distance = np.linalg.norm(aside, axis=1)
    sideways = aside / np.where(distance > 0, distance, 1.0)[:, None]
    rho = np.hypot(z, distance)
    angle = np.arctan2(distance, z)
    logarithm = np.log(rho / datum)
    sine, cosine = np.sin(angle), np.cos(angle)
    first, second = 2 * (1 - nu**2), (1 - 2 * nu) * (1 + nu)
    radial = -first * cosine * logarithm - second * angle * sine
    around = first * sine * logarithm + 2 * nu * (1 + nu) * sine
    around += second * (sine - angle * cosine)
    deep = radial * cosine - around * sine
    wide = radial * sine + around * cosine
    return (np.outer(deep, inward) + wide[:, None] * sideways) / (np.pi * youngs_modulus)


def outer_dofs(described: HalfSpace | None, spaces: Spaces) -> NDArray[np.int64]:
    """All dofs of the outer boundary of a half-space (local indices, owned and ghost), sorted."""
    found = [np.zeros(0, dtype=np.int64)]
    for number, on in enumerate(described.on if described else ()):
        group = spaces.body.boundary(on, f"half_space.on[{number}]")
        found.append(spaces.nodes(group).astype(np.int64))
    nodes = np.unique(np.concatenate(found))
    return (nodes[:, None] * spaces.components + np.arange(spaces.components)).ravel()


class FarField:
    """The outer boundary of a piece of a half-space.

    Args:
        scene: What is described.
        spaces: Displacements.
        supports: Those beside it.
        outer: The dofs of the outer boundary.
        contacts: In scene order.

    Attributes:
        on: The groups' names, for results.
        dofs: Those that follow the far field (local indices, owned and ghost).
        columns: Number of a contact → displacement of the dofs over its force.
    """

    def __init__(
        self,
        scene: Scene,
        spaces: Spaces,
        supports: Supports,
        outer: NDArray[np.int64],
        contacts: list[ContactSurface],
    ) -> None:
        described = scene.half_space
        assert described is not None
        self.on = ", ".join(described.on)
        self._spaces = spaces
        self._supports = supports
        self._modulus, self._ratio = _homogeneous(scene)
        self.dofs = np.setdiff1d(outer, supports.dofs)
        self.columns = {
            number: self._column(contact, f"contact[{number}]")
            for number, contact in enumerate(contacts)
        }
        if supports.parallel_planes:
            raise InputError("symmetry: planes that face each other leave no half_space")
        if not contacts:
            raise InputError("half_space: without a contact there is no force to follow")

    def _column(self, contact: ContactSurface, key: str) -> Array:
        """Displacement of the dofs over the contact's force, with its mirror images."""
        spaces = self._spaces
        inward = np.zeros(3)
        inward[: spaces.components] = contact.kinematics.direction
        foot = self._foot(contact, inward, key)
        components = spaces.components
        points = spaces.coordinates[self.dofs // components]
        reach = largest(spaces.comm, np.linalg.norm(points - foot, axis=1))
        column = np.zeros_like(points)
        planes = self._supports.planes
        for mirrored in product((False, True), repeat=len(planes)):
            image = foot.copy()
            for plane, is_mirrored in zip(planes, mirrored, strict=True):
                if is_mirrored:
                    image[plane.axis] = 2 * plane.at - image[plane.axis]
            if spaces.kinematics == "plane strain":
                column += flamant(points - image, inward, self._modulus, self._ratio, reach)
            else:
                column += boussinesq(points - image, inward, self._modulus, self._ratio)
        return column[np.arange(len(self.dofs)), self.dofs % components]

    def _foot(self, contact: ContactSurface, inward: Array, key: str) -> Array:
        """Where the resultant acts: the obstacle's apex, on the surface."""
        trace, comm = contact.trace, self._spaces.comm
        rows = np.hstack([trace.coordinates, trace.normals])[trace.owned]
        rows = gather_rows(comm, rows)
        normals = np.zeros((len(rows), 3))
        normals[:, : self._spaces.components] = rows[:, 3:]
        flat = largest(comm, np.abs(normals + inward).ravel()) <= _FLAT
        if contact.contact.kind == "prescribed" or not flat:
            raise InputError(
                f"{key}: a half_space needs a flat contact surface and an obstacle that is driven "
                "straight into it"
            )
        if self._spaces.kinematics == "plane strain" and contact.force is None:
            raise InputError(
                f"{key}.obstacle: in plane strain the indentation of a half-space has no datum (it "
                "grows with the logarithm of the distance), so give its force"
            )
        apex = self._apex(contact, key)
        foot = apex + ((rows[0, :3] - apex) @ inward) * inward
        self._require_inside(rows[:, :3], foot, contact, key)
        return foot

    def _apex(self, contact: ContactSurface, key: str) -> Array:
        """The obstacle's apex; without one, the middle of the contact surface."""
        obstacle = contact.contact.obstacle
        apex = np.zeros(3)
        if obstacle is not None and obstacle.position is not None:
            apex[: self._spaces.components] = obstacle.position
        elif obstacle is not None and obstacle.gap is not None:
            raise InputError(
                f"{key}.obstacle.position is missing: a half_space needs to know where a gap's "
                "force acts"
            )
        elif obstacle is None or obstacle.shape is None:
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
        facet = contact.trace.relative_facet_size() * contact.trace.extent()
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
