"""Moments of the reactions of supports: Σ (x − c) × r over the nodes that each support holds.

The moment about an axis is the work of the reactions on a unit rotation about that axis, as the
resultant is their work on a unit translation. It is exact as the nodal reactions are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import ufl

from fenics_contact.body.supports import AppliedSupport
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.loads.affine import Moments, rotations
from fenics_contact.scene.scene import Scene


class SupportMoments:
    """The points that moments of reactions are about, and rotations about these; collective.

    Supports of the same name have one point, so that their moments add up.

    Attributes:
        centres: The point of each support, (components,) each (length); none in axisymmetric
            models, which have no moments, and in finite strains, where arms change.

    Args:
        scene: Which may give the points.
        supports: All of the problem.
        discrete: The body.
    """

    def __init__(
        self, scene: Scene, supports: Sequence[AppliedSupport], discrete: DiscreteBody
    ) -> None:
        self._spaces, self._discrete = discrete.spaces, discrete
        self._supports = supports
        self.centres: list[Array] = []
        if scene.kinematics == "axisymmetric" or scene.has_finite_strains:
            return
        given = {
            one.label: np.array(one.moment_about, dtype=np.float64)
            for one in scene.support
            if one.moment_about is not None
        }
        given |= {face.described.label: face.at for face in discrete.elastic.faces}
        found: dict[str, Array] = {}
        for support in supports:
            label = support.label
            if label not in found:
                same = [one for one in supports if one.label == label]
                found[label] = given[label] if label in given else self._centroid(same)
            self.centres.append(found[label])

    def of_unit_rotations(self, number: int, dofs: Integers) -> Array:
        """Displacements of dofs by small unit rotations about the point of a support.

        Args:
            number: Of the support.
            dofs: Local indices into the flat displacement array.

        Returns:
            (rotations, dofs), of the three axes in space, of one in the plane (length).
        """
        size = self._spaces.components
        if not self.centres:
            return np.zeros((0, len(dofs)))
        nodes, axes = np.divmod(dofs, size)
        arms = self._spaces.coordinates[nodes, :size] - self.centres[number]
        return np.asarray(np.einsum("kdj,dj->kd", rotations(size)[:, axes], arms))

    def reach(self, number: int) -> float:
        """Largest distance of what a support holds from its point; collective (length).

        Args:
            number: Of the support.
        """
        ways = self.of_unit_rotations(number, self._supports[number].dofs)
        return largest(self._spaces.comm, np.linalg.norm(ways, axis=0))

    def _centroid(self, supports: Sequence[AppliedSupport]) -> Array:
        """Centroid of the groups that supports hold, each counted once; collective (length)."""
        spaces = self._spaces
        groups = {name: spaces.body.find(name) for name in dict.fromkeys(s.on for s in supports)}
        sizes = [self._moments(group) for group in groups.values() if group is not None]
        known = [one for one in sizes if one is not None]
        if known and len(known) == len(groups):
            weights = np.array([one.size for one in known])
            return np.asarray(weights @ [one.centroid for one in known] / weights.sum())
        dofs = np.concatenate([support.dofs for support in supports])
        nodes = np.unique(dofs // spaces.components)
        nodes = nodes[nodes < spaces.owned_nodes]
        places = spaces.coordinates[nodes, : spaces.components]
        summed = total(spaces.comm, np.array([len(nodes), *places.sum(axis=0)]))
        return np.asarray(summed[1:] / summed[0])

    def _moments(self, group: Group) -> Moments | None:
        """Integrals over a group of cells or of facets; None of another one; collective."""
        spaces, dimension = self._spaces, self._spaces.body.dimension
        rule = {"quadrature_degree": spaces.bulk_degree + 2}
        if group.dimension == dimension:
            measure = spaces.part(group, rule)
        elif group.dimension == dimension - 1:
            if total(spaces.comm, len(spaces.facets(group))) == 0:
                return None
            measure = spaces.boundary(group, rule)
        else:
            return None
        return self._discrete.once(
            ("moments", group), lambda: Moments.of(ufl.as_ufl(1.0), measure, spaces)
        )
