"""All contacts over the unknowns of the condensed problem, as what faces what at present.

Two bodies that slide over each other are paired again: then these are others, on the same body.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gathered_on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarUnknown
from fenics_contact.solve.condensed.condensed_body import CondensedBody, ScalarLoad
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent, OfSchur
from fenics_contact.solve.condensed.elimination import Eliminated, KeptUnknowns
from fenics_contact.solve.condensed.split_solver import SplitSolver
from fenics_contact.solve.condensed.tangent import ContactTangent, UnknownsTangent
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_stiffness import Entries, SurfaceMatrix
from fenics_contact.solve.systems.system import free_motions, sprung


@dataclass(frozen=True, eq=False)
class ContactJump:
    """The jump w = B (y, q, z) + c of one contact; rows are dofs of its surface.

    Each has one displacement y or derived jump z as its own, or none; scalars q may move all rows.

    Attributes:
        surface: Tangent in the jump.
        relative: What scalars make of the displacement relative to a body opposite, (rows,
            scalars): B without an obstacle's motion.
        motion: B of the scalars: an obstacle's motion, displacements that they prescribe.
        work: L of the scalars: rows of the balance that its forces enter, Lᵀ: as B, without the
            far field, and its direction for a resultant.
        rows: Those that have an unknown of their own, increasing.
        columns: That unknown of each.
        count: Number of displacements, which the scalars come after.
        width: Number of all unknowns, with derived jumps.
    """

    surface: SurfaceMatrix
    relative: Array
    motion: Array
    work: Array
    rows: Integers
    columns: Integers
    count: int
    width: int

    @classmethod
    def over(
        cls,
        surface: SurfaceMatrix,
        points: tuple[Integers, Integers],
        sizes: tuple[int, int],
        unknowns: Sequence[ScalarUnknown],
        far: Sequence[Array],
    ) -> ContactJump:
        """The jump of a contact, with the parts that scalar unknowns move.

        Args:
            surface: Tangent in the jump.
            points: Rows that have a displacement or a derived jump, and which.
            sizes: Numbers of displacements and of derived jumps.
            unknowns: The scalars.
            far: Displacements at the dofs of the surface that each of these adds.
        """
        rows, count = len(surface.dofs), sizes[0]
        relative, motion, work = np.zeros((3, rows, len(unknowns)))
        for column, unknown in enumerate(unknowns):
            if unknown.prescribes is not None:
                motion[:, column] = relative[:, column] = far[column]
            if unknown.contact is surface.contact:
                work[:, column] = -unknown.pushes * unknown.along
                if unknown.moves_obstacle:
                    motion[:, column] = -unknown.moved_along
        own, columns = points
        columns = columns + np.where(columns < count, 0, len(unknowns))
        width = sum(sizes) + len(unknowns)
        return cls(surface, relative, motion, work, own, columns, count, width)

    @cached_property
    def _place(self) -> Integers:
        """The unknown of each row, −1 of those that have none."""
        found = np.full(len(self.relative), -1)
        found[self.rows] = self.columns
        return found

    @property
    def _scalars(self) -> slice:
        return slice(self.count, self.count + self.work.shape[1])

    @cached_property
    def is_coupled(self) -> bool:
        """Whether any unknown moves it, or takes its forces."""
        return bool(len(self.rows)) or bool(self.motion.any() or self.work.any())

    def displacement(self, unknowns: Array) -> Array:
        """Relative to a body opposite at its dofs, (rows,), without what is held."""
        found = self.relative @ unknowns[self._scalars]
        found[self.rows] += unknowns[self.columns]
        return found

    def forces(self, force: Array) -> Array:
        """Lᵀ r, on all unknowns.

        Args:
            force: At its dofs, (rows,).
        """
        found = np.zeros(self.width)
        found[self._scalars] = force @ self.work
        found[self.columns] += force[self.rows]
        return found

    def virtual(self, unknowns: Array) -> Array:
        """L y: the jump by which its forces do work in a virtual displacement, (rows,)."""
        found = self.work @ unknowns[self._scalars]
        found[self.rows] += unknowns[self.columns]
        return np.asarray(found)

    def slopes(self, of_jump: Array) -> Array:
        """Bᵀ r: the gradient in all unknowns.

        Args:
            of_jump: In the jump at its dofs, (rows,).
        """
        found = np.zeros(self.width)
        found[self._scalars] = of_jump @ self.motion
        found[self.columns] += of_jump[self.rows]
        return found

    @property
    def motions(self) -> csr_matrix:
        """B over all of Q y, (rows, width)."""
        return self._over_all(self.motion)

    @property
    def works(self) -> csr_matrix:
        """L over all of Q y, (rows, width)."""
        return self._over_all(self.work)

    def _over_all(self, of_scalars: Array) -> csr_matrix:
        """Matrix of the jump's rows over all of Q y: own unknowns, and effects of scalars."""
        rows, numbers = np.nonzero(of_scalars)
        values = np.concatenate([np.ones(len(self.rows)), of_scalars[rows, numbers]])
        places = (
            np.concatenate([self.rows, rows]),
            np.concatenate([self.columns, self.count + numbers]),
        )
        return csr_matrix((values, places), (len(self.relative), self.width))

    def relative_to(self, chosen: Integers) -> csr_matrix:
        """The displacement over some of the unknowns, none of which is a scalar."""
        shape = (len(self.relative), self.width)
        ones = np.ones(len(self.rows))
        return csr_matrix((ones, (self.rows, self.columns)), shape=shape)[:, chosen]

    def tangent(self, entries: Entries) -> Entries:
        """Entries of Lᵀ K_c B; those at the same place add up.

        Args:
            entries: Of K_c, between the dofs of the surface.
        """
        rows, columns, values = entries
        mine, others = self._place[rows], self._place[columns]
        size = self.work.shape[1]
        if not size:
            kept = (mine >= 0) & (others >= 0) & (values != 0)
            return mine[kept], others[kept], values[kept]
        scalars = self.count + np.arange(size)
        moved = values[:, None] * self.motion[columns]
        pushed = values[:, None] * self.work[rows]
        corner = pushed.T @ self.motion[columns]
        found = [
            (mine, others, values),
            (mine.repeat(size), np.tile(scalars, len(mine)), moved.ravel()),
            (np.tile(scalars, len(mine)), others.repeat(size), pushed.ravel()),
            (scalars.repeat(size), np.tile(scalars, size), corner.ravel()),
        ]
        rows, columns, values = (np.concatenate(part) for part in zip(*found, strict=True))
        kept = (rows >= 0) & (columns >= 0) & (values != 0)
        return rows[kept], columns[kept], values[kept]


# Rows of each surface that have a jump, and its number among the unknowns and derived jumps.
Points = Mapping[SurfaceMatrix, tuple[Integers, Integers]]


class CondensedContacts:
    """The jumps of contacts over the unknowns, their forces and tangents; collective.

    Attributes:
        kept: What stands for the contact dofs as unknowns.
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
        make_tangent: Makes the tangent of all unknowns but the body's scalars.
    """

    def __init__(
        self,
        problem: Problem,
        body: CondensedBody,
        surfaces: Sequence[SurfaceMatrix | None],
        scalar_loads: Sequence[ScalarLoad],
        ends_with_body: bool,
        make_tangent: Callable[[ConstantTangent, Integers], UnknownsTangent] = UnknownsTangent,
    ) -> None:
        self._make_tangent = make_tangent
        self._problem, self._body, self._scalar_loads = problem, body, scalar_loads
        # The scalars of the body come last.
        count = len(problem.unknowns) - len(problem.body_scalars)
        self._unknowns = problem.unknowns[:count]
        acting = [surface for surface in surfaces if surface is not None]
        variables = ContactVariables(body.dofs, acting)
        points = {surface: variables.own_unknowns(surface) for surface in acting}
        springs = self._springs(variables, points)
        acted_on = self._acted_on(variables, points, springs)
        schur = self._schur(variables, acted_on, ends_with_body)
        scalars = body.scalars
        self.kept = KeptUnknowns(
            problem.comm, variables, schur, scalars.condensed, scalars.at_contacts
        )
        self.size = self.kept.count + count
        self._place = np.full(variables.count, -1)
        self._place[self.kept.numbers] = np.arange(self.kept.count)
        self.sprung = self._place[springs]
        self.jumps = [None if s is None else self._jump(s, points[s]) for s in surfaces]
        self.tangent = self._tangent(schur)

    def _springs(self, variables: ContactVariables, points: Points) -> Integers:
        """Unknowns that tell free motions apart, of those on which contacts act if these do."""
        dofs = self._body.dofs
        motions = np.array(
            [
                variables.unknowns(dofs.gathered(motion.reshape(-1))[dofs.is_free])
                for motion in free_motions(self._problem)
            ]
        ).T
        every = sprung(motions)
        if not len(every):
            return every
        numbers = np.flatnonzero(_has_jump(variables, points))
        found = numbers[sprung(motions[numbers])]
        return found if len(found) == len(every) else every

    def _acted_on(self, variables: ContactVariables, points: Points, springs: Integers) -> Flags:
        """Unknowns on which contacts act by themselves, or with scalars; needed on rank 0."""
        if self._unknowns or self._problem.comm.rank > 0:
            return np.ones(variables.count, dtype=bool)
        found = _has_jump(variables, points) | variables.derived.any(axis=0)
        found[springs] = True
        return np.asarray(found)

    def _jump(self, surface: SurfaceMatrix, points: tuple[Integers, Integers]) -> ContactJump:
        places, variables = self._body.dofs.places(surface.dofs), self.kept.variables
        far = [load.displacements[places] for load in self._scalar_loads]
        rows, columns = points
        own = columns < variables.count
        derived = columns - variables.count + self.kept.count
        columns = np.where(own, self._place[np.where(own, columns, 0)], derived)
        sizes = self.kept.count, variables.derived_count
        return ContactJump.over(surface, (rows, columns), sizes, self._unknowns, far)

    def _schur(
        self, variables: ContactVariables, acted_on: Flags, ends_with_body: bool
    ) -> OfSchur | Eliminated | None:
        """S between the unknowns, on rank 0; that of a body of its own is given up with it."""
        find = self._body.give_up if ends_with_body else self._body.of_unknowns
        return find(variables, acted_on)

    def _tangent(self, schur: OfSchur | Eliminated | None) -> ContactTangent | None:
        """A on rank 0, with what scalars do to the contact dofs through the bulk."""
        if schur is None:
            return None
        kept, count = self.kept, len(self._unknowns)
        own = schur.own if isinstance(schur, Eliminated) else schur
        self._stiffness = schur.diagonal  # of springs: eliminated masters would make it soft
        nodes = self._body.dofs.free[kept.numbers] // self._problem.spaces.components
        condensed = [kept.load(load.condensed).own for load in self._scalar_loads[:count]]
        columns = -np.array(condensed).reshape(count, kept.count).T
        corner = np.array([unknown.own for unknown in self._unknowns])
        derived = kept.variables.derived[:, kept.numbers]
        constant = ConstantTangent(columns, corner, derived, own)
        return ContactTangent(
            self._make_tangent(constant, nodes), self._body.scalars.border(kept, self.size)
        )

    def follow_scalars(self, scalar_loads: Sequence[ScalarLoad]) -> None:
        """Take what the body's scalars do to it, after that has changed.

        Args:
            scalar_loads: What a unit of each scalar unknown does to the bulk.
        """
        self._scalar_loads = scalar_loads
        scalars = self._body.scalars
        self.kept.take_scalars(scalars.condensed, scalars.at_contacts)
        if self.tangent is not None:
            self.tangent.border = self._body.scalars.border(self.kept, self.size)

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
            None if jump is None else self.kept.variables.held_part(jump.surface, held)
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
        derived = self.kept.derived_jumps(values[: self.kept.count])
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
            if jump is None or not jump.is_coupled:
                continue
            owned = jump.surface.contact.trace.surface.owned_nodes
            parts = gathered_on_root(self._problem.comm, force[:owned].reshape(-1))
            if self.tangent is not None and parts is not None:
                own = jump.forces(np.concatenate(parts))
                found.append(self.tangent.inner.onto_unknowns(own))
        return found

    def linearise(self, springs: float, near: SplitSolver | None = None) -> None:
        """W = Σ Lᵀ K_c B; collective.

        Args:
            springs: Stiffness of springs at ``sprung``, over that of the body.
            near: As of ``UnknownsTangent.set``, on rank 0.
        """
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        for jump in (jump for jump in self.jumps if jump is not None and jump.is_coupled):
            jump.surface.contact.follow()
            parts = gathered_on_root(self._problem.comm, jump.surface.entries())
            found += [jump.tangent(part) for part in parts or ()]
        tangent = self.tangent
        if tangent is not None:
            tangent.border.hold(self.is_held)
            tangent.border.stiffen(self._problem.stop_tangent)
            if springs:
                stiffness = self._stiffness[self.sprung]
                found.append((self.sprung, self.sprung, springs * stiffness))
            rows, columns, values = (np.concatenate(part) for part in zip(*found, strict=True))
            tangent.set((rows, columns, values), near)

    def compliances(
        self, number: int, across: csr_matrix, ways: list[csr_matrix]
    ) -> tuple[Array, list[Array]] | None:
        """How far forces at a contact move its points; see ``CondensedSystem.compliances``."""
        jump = self.jumps[number]
        if jump is None or self.tangent is None:
            return None
        return self.tangent.inner.compliances(jump.relative_to, across, ways)


def _has_jump(variables: ContactVariables, points: Points) -> Flags:
    """Unknowns that are the jump of a contact, (displacements,)."""
    found = np.zeros(variables.count, dtype=bool)
    for _, columns in points.values():
        found[columns[columns < variables.count]] = True
    return found


def _relative(jump: ContactJump, held: Array, unknowns: Array) -> Array:
    """Displacements relative to a body opposite, at this rank's nodes of a surface."""
    surface = jump.surface.contact.trace.surface
    found = jump.displacement(unknowns) + held
    return np.asarray(found.reshape(-1, surface.components)[surface.numbers])
