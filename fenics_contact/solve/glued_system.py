"""The condensed problem of contacts so large that S is not formed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import raise_together
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import acting_sides
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent, OfSchur
from fenics_contact.solve.condensed.elimination import Eliminated
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.tangent import UnknownsTangent
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.glued.glued_bulk import GluedBulk
from fenics_contact.solve.glued.glued_tangent import GluedTangent
from fenics_contact.solve.near_system import NearSystem
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.solve.systems.near_nodes import NearNodes
from fenics_contact.solve.systems.system import free_motions


def is_glueable(problem: Problem, near: Sequence[NearNodes | None]) -> bool:
    """Whether all that a problem has can be solved without S; collective.

    Args:
        problem: The problem.
        near: The nodes of each contact that take part.
    """
    elastic = problem.elastic
    scene = problem.scene
    about_answer = scene.modes or scene.damping or scene.stability
    if scene.is_exact or scene.solver.exact_check is True or about_answer is not None:
        return False  # these need S or its inverse
    own = len(problem.unknowns) == len(problem.body_scalars)
    plain = elastic.mixed is None and not elastic.ties and problem.discrete.cut is None
    still = not problem.inertia.moves and problem.conduction is None
    if not (own and plain and still and problem.between_bodies):
        return False
    sides = acting_sides(problem)
    dofs = ContactDofs(problem.spaces, problem.constrained, sides, near)
    acting = [SurfaceMatrix(one) for one in problem.contacts if one.forces.terms]
    return ContactVariables(dofs, acting).derived_count == 0


class GluedSystem(NearSystem):
    """The problem condensed onto the jumps at its contacts, by back-substitutions."""

    body: GluedBody
    # At least the round-off of a product; and steps that find out what touches and slips are hardly
    # better for more exact solves.
    _shares_left: ClassVar = 1e-6, 1e-3

    def _condense(self) -> CondensedBody:
        return GluedBody(self, self._acting)

    def _make_tangent(self, constant: ConstantTangent, nodes: Integers) -> UnknownsTangent:
        stiffness = self.body.bulk.of_jumps
        assert stiffness is not None
        return GluedTangent(constant, nodes, stiffness)

    def update_pairing(self) -> None:
        """Update the pairing of contacts: with another factorisation; collective."""
        scalars = self.scalar_values(self.state)
        self.body.destroy()
        self._destroy_vectors()
        self._take_body(self._condense())
        displacement = self.problem.displacement.x.array
        self._set_state(self.dofs.gathered(displacement)[self.dofs.is_free], scalars)
        self.follow_loads()
        self._started = self._displacements(self._values(self.state))


class GluedBody(CondensedBody):
    """A body condensed onto the jumps at its contacts.

    Args:
        system: Whose problem it is, at present.
        acting: The contacts that exert forces.
    """

    bulk: GluedBulk

    def __init__(self, system: GluedSystem, acting: Sequence[ContactSurface]) -> None:
        self._acting, self._problem = acting, system.problem
        problem = self._problem
        known = problem.discrete, problem.constrained, acting_sides(problem)
        super().__init__(*known, system._timings, near=system.near)

    def _make_bulk(self, schur: tuple[Array | None] | None) -> CondensedBulk:
        surfaces = [SurfaceMatrix(contact) for contact in self._acting]
        self._variables = ContactVariables(self.dofs, surfaces)
        return GluedBulk(self.stiffness, self.held, self.dofs.free, self._variables)

    def give_up(self, variables: ContactVariables, acted_on: Flags) -> OfSchur | Eliminated | None:
        """S' between the jumps, on rank 0, which is applied and not written."""
        found = self.bulk.of_jumps
        motions = [self.dofs.gathered(one.reshape(-1)) for one in free_motions(self._problem)]
        if found is not None:
            free = [variables.unknowns(one[self.dofs.is_free])[found.kept] for one in motions]
            found.directions.free(free)
        error = None
        if found is not None and not np.array_equal(np.flatnonzero(acted_on), found.kept):
            error = NotConvergedError("the stiffness is singular: is the body held?", ())
        raise_together(self.bulk.comm, error)
        return found

    def bulk_forces(self, position: Array) -> Array | None:
        """S x of displacements of the free contact dofs, on rank 0, None on others (force)."""
        found = self.bulk.of_jumps
        if found is None:
            return None
        forces = np.zeros(self._variables.count)
        forces[found.kept] = found.own.product(self._variables.unknowns(position)[found.kept])
        return self._variables.nodal_forces(forces)
