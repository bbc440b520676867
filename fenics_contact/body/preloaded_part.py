"""A preloaded part of a body: its ends, its shortening q, and the forces between q and the body.

Forces between a scalar q of the body's energy W(u, s, q) and u, a mean stress s. The bulk is
linear, so that its Hessian says all: ∂²W/∂u∂q are the forces of a unit of q, and with
∂²W/∂q² they make the force ∂W/∂q that does work on q.

A part of the body whose unstressed length is shorter than drawn by q, as that of a tight bolt. Its
strain free of stress is −(q/l) a ⊗ a, with the unit axis a and the length l along it, so its
energy is ½ a(e, e) of the elastic strain e = e(u) + (q/l) a ⊗ a. The derivative of the energy in q
is the force along the axis, N = (1/l) ∫ a · σ a.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.description import PreloadedGroup
from fenics_contact.body.elasticity import Law
from fenics_contact.body.spaces import Spaces, summed_over_ranks
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.mesh.tagged_mesh import Group

# Of the length, that a facet of an end may be off its plane.
_FLAT = 1e-6


class PartEnds:
    """The two ends of a group of cells; collective.

    Between them a part may have any free surface, but it may hang together with the rest of the
    body only at its ends, or along sides that are parallel to the axis.

    Attributes:
        distance: From one to the other (length).

    Args:
        group: Of cells.
        axis: Unit vector, (3,).
        spaces: Those of the body.
        words: What messages call the part.

    Raises:
        InputError: An end is not plane, or not normal to the axis.
    """

    def __init__(self, group: Group, axis: Array, spaces: Spaces, words: str) -> None:
        self._spaces, self._group = spaces, group
        self._along = spaces.body.mesh.geometry.x @ axis
        cells = spaces.body.entities(group)
        nodes = np.unique(compat.geometry_nodes(spaces.body.mesh)[cells])
        low = smallest(spaces.comm, self._along[nodes])
        high = largest(spaces.comm, self._along[nodes])
        self.distance = high - low
        facets, is_inside = self._surface()
        heights = self._heights(facets)
        close = _FLAT * self.distance
        at = [np.abs(heights - end).max(axis=1, initial=0.0) <= close for end in (low, high)]
        oblique = np.ptp(heights, axis=1) > close if len(heights) else np.zeros(0, dtype=bool)
        oblique &= ~self._is_parallel(facets, axis)
        astray = is_inside & ~at[0] & ~at[1] & (oblique | (np.ptp(heights, axis=1) <= close))
        found = [int(total(spaces.comm, int(flags.sum()))) for flags in (*at, astray)]
        if found[0] == 0 or found[1] == 0 or found[2] > 0:
            direction = ", ".join(f"{x:.4g}" for x in axis[: spaces.components])
            raise InputError(
                f"{words}: its ends must be plane and normal to the axis ({direction}), so that "
                "its length and the force at its ends are known"
            )

    def _surface(self) -> tuple[Integers, Flags]:
        """Facets of this rank's own cells of the part with no other cell of it beyond.

        And which of them have another part of the body beyond.
        """
        body = self._spaces.body
        topology, dimension = body.mesh.topology, body.dimension
        owned = topology.index_map(dimension).size_local
        facets_of = topology.connectivity(dimension, dimension - 1).array
        facets_of = facets_of.reshape(topology.connectivity(dimension, dimension - 1).num_nodes, -1)
        cells = body.entities(self._group)
        index_map = topology.index_map(dimension - 1)
        count = index_map.size_local + index_map.num_ghosts
        of_part = np.bincount(facets_of[cells].ravel(), minlength=count)
        of_own = np.bincount(facets_of[cells[cells < owned]].ravel(), minlength=count)
        of_body = np.bincount(facets_of.ravel(), minlength=count)
        facets = np.flatnonzero((of_part == 1) & (of_own == 1))
        return facets, of_body[facets] > 1

    def _nodes(self, facets: Integers) -> Integers:
        """Return the nodes of facets by the mesh's geometry, (facets, nodes)."""
        body = self._spaces.body
        return compat.nodes_of_entities(body.mesh, body.dimension - 1, facets.astype(np.int32))

    def _heights(self, facets: Integers) -> Array:
        """Coordinates of their nodes along the axis, (facets, nodes) (length)."""
        if len(facets) == 0:
            return np.zeros((0, self._spaces.body.dimension))
        return np.asarray(self._along[self._nodes(facets)])

    def _is_parallel(self, facets: Integers, axis: Array) -> Flags:
        """Whether the axis lies in the facets, to round-off and what cells make of curves."""
        if len(facets) == 0:
            return np.zeros(0, dtype=bool)
        places = self._spaces.body.mesh.geometry.x[self._nodes(facets)]
        arms = places[:, 1:] - places[:, :1]
        if self._spaces.body.dimension == 2:
            across = arms[:, 0] - np.outer(arms[:, 0] @ axis, axis)
            return np.asarray(
                np.linalg.norm(across, axis=1) <= _FLAT * np.linalg.norm(arms[:, 0], axis=1)
            )
        normals = np.cross(arms[:, 0], arms[:, 1])
        return np.asarray(np.abs(normals @ axis) <= _FLAT * np.linalg.norm(normals, axis=1))


@dataclass(frozen=True, eq=False)
class ScalarForces:
    """Second derivative of the body's energy in a scalar q.

    Attributes:
        spaces: Those of the body.
        present: The present q, a constant in UFL (length).
        nodal: Forces on the displacements over q, ∂²W/∂u∂q, (nodes, components) (force/length).
        on_mean_stress: ∂²W/∂s∂q of the mean stress s, at its dofs of this rank (area); empty
            without one.
        owned_stresses: How many of these dofs this rank owns.
        stiffness: ∂²W/∂q² (force/length).
        others: Present values of the body's other scalars p, and ∂²W/∂p∂q (length, force/length).
    """

    spaces: Spaces
    present: fem.Constant
    nodal: Array
    on_mean_stress: Array
    owned_stresses: int
    stiffness: float
    others: list[tuple[fem.Constant, float]]

    def force(self, displacement: Array, mean_stress: Array) -> float:
        """∂W/∂q at the present q (force); collective.

        Args:
            displacement: Of this rank's nodes, (nodes, components) (length).
            mean_stress: At the dofs of this rank; empty without one (stress).
        """
        owned, nodes = self.owned_stresses, slice(0, self.spaces.owned_nodes)
        own = float(np.sum(self.nodal[nodes] * displacement[nodes]))
        own += float(self.on_mean_stress[:owned] @ mean_stress[:owned])
        own = float(total(self.spaces.comm, own)) + self.stiffness * float(self.present.value)
        return own + sum(value * float(present.value) for present, value in self.others)

    def follow(self, others: Sequence[ScalarForces], shares: Array) -> None:
        """Take other scalars of the body into account, with their forces over these, (others,)."""
        known = zip(others, shares, strict=True)
        self.others.extend((one.present, float(share)) for one, share in known)


@dataclass(frozen=True, eq=False)
class ScalarColumns:
    """Columns and corner of the scalars of the body's energy in a linear system.

    Attributes:
        nodal: Forces on the displacements, (nodes, components) each (force/length).
        on_mean_stress: On a mean stress at its dofs of this rank, each; empty without one (area).
        corner: Forces on the scalars, (scalars, scalars) (force/length).
    """

    nodal: Sequence[Array]
    on_mean_stress: Sequence[Array]
    corner: Array


@dataclass(frozen=True, eq=False)
class ScalarForms:
    """Compiled forms of the second derivatives of the body's energy in a scalar q.

    Attributes:
        spaces: Those of the body.
        present: The present q, a constant in UFL (length).
        nodal: Of forces on the displacements over q.
        on_mean_stress: Of those on a mean stress, None without one.
        mean_stress: That, or None.
        stiffness: Of ∂²W/∂q².
    """

    spaces: Spaces
    present: fem.Constant
    nodal: fem.Form
    on_mean_stress: fem.Form | None
    mean_stress: fem.Function | None
    stiffness: fem.Form

    @classmethod
    def of(
        cls,
        spaces: Spaces,
        present: fem.Constant,
        energy: tuple[Expr, ufl.Measure, Expr],
        displacement: fem.Function,
        mean_stress: fem.Function | None,
    ) -> ScalarForms:
        """From the energy; collective.

        Args:
            spaces: Those of the body.
            present: The present q.
            energy: Its density, weighted, the measure, and q in the density, a UFL variable.
            displacement: u in it.
            mean_stress: s in it, or None.
        """
        density, measure, scalar = energy
        force = ufl.diff(density, scalar) * measure
        stiffness = ufl.diff(ufl.diff(density, scalar), scalar) * measure
        on_mean_stress = None
        if mean_stress is not None:
            on_mean_stress = form_cache.form(ufl.derivative(force, mean_stress))
        nodal = form_cache.form(ufl.derivative(force, displacement))
        compiled = form_cache.form(stiffness)
        return cls(spaces, present, nodal, on_mean_stress, mean_stress, compiled)

    def assembled(self) -> ScalarForces:
        """The derivatives with the present coefficients of the forms; collective."""
        spaces, on_mean_stress, owned = self.spaces, np.zeros(0), 0
        if self.on_mean_stress is not None and self.mean_stress is not None:
            found = fem.assemble_vector(self.on_mean_stress)
            index_map = self.mean_stress.function_space.dofmap.index_map
            on_mean_stress = summed_over_ranks(index_map, np.array(found.array))
            owned = index_map.size_local
        nodal = spaces.assemble(self.nodal)
        own = float(total(spaces.comm, fem.assemble_scalar(self.stiffness)))
        return ScalarForces(spaces, self.present, nodal, on_mean_stress, owned, own, [])


class PreloadedPart:
    """The part, and its strain free of stress; collective.

    Attributes:
        described: As in the scene.
        spaces: Those of the body.
        group: Its cells.
        length: Its extent along the axis (length).
        scalar: The shortening q, a constant in UFL (length).

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
        self.group = body.part(described.on, f"{key}.on")
        axis = np.zeros(3)
        axis[: body.dimension] = described.axis
        axis /= np.linalg.norm(axis)
        self.length = PartEnds(self.group, axis, spaces, f"{key}.on = '{described.on}'").distance
        self.scalar = fem.Constant(body.mesh, 0.0)
        self._along = _unit_strain(axis, spaces, law)
        inside = fem.Function(fem.functionspace(body.mesh, ("DG", 0)))
        inside.x.array[body.entities(self.group)] = 1.0
        self._inside = inside

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the part, with the quadrature of the body's stiffness."""
        rule = {"quadrature_degree": self.spaces.bulk_degree}
        return self.spaces.part(self.group, rule)

    def stressless_strain(self, scalar: Expr) -> Expr:
        """−(q/l) a ⊗ a, (3, 3); in plane stress with what leaves that free across the plane."""
        return -scalar / self.length * self._along

    @property
    def present_strain(self) -> Expr:
        """Present strain that is free of stress, anywhere in the body: 0 outside of the part."""
        return self._inside * self.stressless_strain(self.scalar)


def _unit_strain(axis: Array, spaces: Spaces, law: Law) -> Expr:
    """A ⊗ a; in plane stress with the thickness that it goes with."""
    along = np.outer(axis, axis)
    rows = along.tolist()
    if spaces.kinematics == "plane stress":
        xx, yy, xy = along[0, 0], along[1, 1], along[0, 1]
        rows[2][2] = law.thickness_strain(*(ufl.as_ufl(float(part)) for part in (xx, yy, xy)))
    return ufl.as_tensor(rows)
