"""All contacts over the unknowns of the condensed problem, as what faces what at present.

Two bodies that slide over each other are paired again: then these are others, on the same body.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gathered_on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody, ScalarLoad
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent, OfSchur
from fenics_contact.solve.condensed.contact_jump import ContactJump
from fenics_contact.solve.condensed.tangent import ContactTangent
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.solve.systems.pair_stiffness import Entries
from fenics_contact.solve.systems.step_springs import free_motions, sprung


class CondensedContacts:
    """The jumps of contacts over the unknowns, their forces and tangents; collective.

    Attributes:
        variables: What stands for the contact dofs as unknowns.
        jumps: The jump of each contact in scene order; None of those that exert no forces.
        tangent: The dense tangent on rank 0; None on others.
        size: Number of unknowns that contacts are coupled with: all but the body's scalars.
        sprung: Unknowns that have a spring in steps (``step_springs``).

    Args:
        problem: The problem.
        body: The body, condensed.
        surfaces: Tangents of the contacts in scene order; None of those that exert no forces.
        scalar_loads: What a unit of each scalar unknown does to the bulk.
        ends_with_body: Whether S is for these contacts alone, and may be given up with them.
    """

    def __init__(
        self,
        problem: Problem,
        body: CondensedBody,
        surfaces: Sequence[SurfaceMatrix | None],
        scalar_loads: Sequence[ScalarLoad],
        ends_with_body: bool,
    ) -> None:
        self._problem, self._body, self._scalar_loads = problem, body, scalar_loads
        # The scalars of the body come last.
        count = len(problem.unknowns) - len(problem.body_scalars)
        self._unknowns = problem.unknowns[:count]
        self.size = len(body.dofs.free) + count
        self.variables = ContactVariables(body.dofs, [s for s in surfaces if s is not None])
        self.jumps = [None if s is None else self._jump(s) for s in surfaces]
        self.tangent = self._tangent(self._schur(ends_with_body))
        motions = [
            self.variables.unknowns(body.dofs.gathered(motion.reshape(-1))[body.dofs.is_free])
            for motion in free_motions(problem)
        ]
        self.sprung = sprung(np.array(motions).T)

    def _jump(self, surface: SurfaceMatrix) -> ContactJump:
        places, variables = self._body.dofs.places(surface.dofs), self.variables
        far = [load.displacements[places] for load in self._scalar_loads]
        sizes = variables.count, variables.derived_count
        points = variables.own_unknowns(surface)
        return ContactJump.over(surface, points, sizes, self._unknowns, far)

    def _schur(self, ends_with_body: bool) -> OfSchur | None:
        """S between the unknowns, on rank 0; that of a body of its own is given up with it."""
        if not ends_with_body:
            return self._body.of_unknowns(self.variables)
        if not self._problem.can_pair_anew:
            return self._body.give_up(self.variables)
        schur = self._body.bulk.schur
        return None if schur is None else OfSchur(self.variables.stiffness(schur))

    def _tangent(self, schur: OfSchur | None) -> ContactTangent | None:
        """A on rank 0, with what scalars do to the contact dofs through the bulk."""
        if schur is None:
            return None
        variables, free = self.variables, self._body.dofs.free
        count = len(self._unknowns)
        condensed = [variables.forces(load.condensed) for load in self._scalar_loads[:count]]
        columns = -np.array(condensed).reshape(count, len(free)).T
        own = np.array([unknown.own for unknown in self._unknowns])
        constant = ConstantTangent(schur.matrix, columns, own, variables.derived, schur)
        nodes = free // self._problem.spaces.components
        return ContactTangent(constant, nodes, self._body.scalars.border(variables, self.size))

    @property
    def is_held(self) -> Flags:
        """Whether each of the body's scalars is held, (body_scalars,)."""
        return np.array([one.held is not None for one in self._problem.body_scalars], dtype=bool)

    def held_parts(self, held: Array) -> list[Array | None]:
        """The part of each jump that prescribed displacements are.

        Args:
            held: These displacements at all contact dofs (length).
        """
        return [
            None if jump is None else self.variables.held_part(jump.surface, held)
            for jump in self.jumps
        ]

    def displacements(
        self, values: Array, held_parts: Sequence[Array | None]
    ) -> list[Array | None]:
        """Displacements relative to a body opposite, at this rank's nodes of each surface.

        Args:
            values: The unknowns.
            held_parts: As of ``held_parts``.
        """
        derived = self.variables.derived_jumps(values[: self.variables.count])
        unknowns = np.concatenate([values[: self.size], derived])
        return [
            None if jump is None or held is None else _relative(jump, held, unknowns)
            for jump, held in zip(self.jumps, held_parts, strict=True)
        ]

    def onto_unknowns(self, forces: Sequence[Array]) -> list[Array]:
        """Forces of each contact on the unknowns that contacts are coupled with, on rank 0.

        Collective.

        Args:
            forces: On the body at the nodes of each surface, (nodes, components).
        """
        found = []
        for jump, force in zip(self.jumps, forces, strict=True):
            if jump is None:
                continue
            owned = jump.surface.contact.trace.surface.owned_nodes
            parts = gathered_on_root(self._problem.comm, force[:owned].reshape(-1))
            if self.tangent is not None and parts is not None:
                own = jump.forces(np.concatenate(parts))
                found.append(self.tangent.constant.onto_unknowns(own))
        return found

    def linearise(self, springs: float) -> None:
        """W = Σ Lᵀ K_c B; collective.

        Args:
            springs: Stiffness of springs at ``sprung``, over that of the body.
        """
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        for jump in (jump for jump in self.jumps if jump is not None):
            jump.surface.contact.follow()
            parts = gathered_on_root(self._problem.comm, jump.surface.entries())
            found += [jump.tangent(part) for part in parts or ()]
        tangent = self.tangent
        if tangent is not None:
            tangent.border.hold(self.is_held)
            if springs:
                stiffness = tangent.constant.schur.diagonal()[self.sprung]
                found.append((self.sprung, self.sprung, springs * stiffness))
            tangent.set(*(np.concatenate(part) for part in zip(*found, strict=True)))

    def compliances(
        self, number: int, across: csr_matrix, ways: list[csr_matrix]
    ) -> tuple[Array, list[Array]] | None:
        """How far forces at a contact move its points; see ``CondensedSystem.compliances``."""
        jump = self.jumps[number]
        if jump is None or self.tangent is None:
            return None
        return self.tangent.compliance.between(jump.relative_to, across, ways)


def _relative(jump: ContactJump, held: Array, unknowns: Array) -> Array:
    """Displacements relative to a body opposite, at this rank's nodes of a surface."""
    surface = jump.surface.contact.trace.surface
    found = jump.displacement(unknowns) + held
    return np.asarray(found.reshape(-1, surface.components)[surface.numbers])
