"""The problem condensed onto its contacts: what is nonlinear, and nothing else.

Unknowns are the displacements of the contact surfaces that no support holds, then the scalars;
rank 0 has all of them. The bulk is factorised once, and solved for once a load step, where somebody
asks for the displacement of the body.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from functools import partial
from typing import ClassVar

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarState
from fenics_contact.solve.condensed.adjoint import CondensedAdjoint
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_contacts import CondensedContacts, ContactJump
from fenics_contact.solve.condensed.condensed_loads import PresentLoads
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent
from fenics_contact.solve.condensed.split_solver import LEFT, LEFT_AT_MOST, SplitSolver
from fenics_contact.solve.condensed.tangent import (
    ContactTangent,
    TangentOperator,
    UnknownsTangent,
)
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.solve.systems.solution import BodyAnswer, FindBody, LazyDisplacement
from fenics_contact.solve.systems.system import System

# Contact dofs from which the passes of a loop on the pressure cost more than the factorisation, and
# from which the factorisation is a small part of a run in load steps.
_MANY, _LARGE = 1000, 2500


class CondensedSystem(System):
    """Balance A y − b − Qᵀ Σ Lᵀ r_c(B Q y + c), A the Schur complement and the scalars' rows.

    Q y are the unknowns y, and the derived jumps after them.

    Attributes:
        body: The body condensed.
        stiffness: That of each rank's cells.
        dofs: The contact dofs.
        held: Which of this rank's unknowns of the stiffness supports hold.
        version: Changes when what faces what, or what scalars do, has changed.

    Args:
        problem: The problem.
        timings: Seconds so far.
        body: The body condensed, which is kept; by default it is condensed for this system alone.
    """

    name = "condensed"
    repeats_cheaply: ClassVar = True
    options: ClassVar = {"ksp_type": "preonly"}
    _shares_left: ClassVar = LEFT, LEFT_AT_MOST  # of an imbalance by a linear solve
    _make_tangent: Callable[[ConstantTangent, Integers], UnknownsTangent] = UnknownsTangent

    def __init__(
        self, problem: Problem, timings: Timings, body: CondensedBody | None = None
    ) -> None:
        super().__init__(problem)
        with timings.phase("assemble"):
            self._surfaces = [
                SurfaceMatrix(c) if c.forces.terms else None for c in problem.contacts
            ]
        self._root = self.comm.rank == 0
        self._timings = timings
        self._is_own = body is None  # then it ends with the system
        self.factorisations = self.version = 0
        self._take_body(body or self._condense())

    def _condense(self) -> CondensedBody:
        """The body condensed for this system alone; collective."""
        problem = self.problem
        step = problem.inertia.stiffness
        known = problem.discrete, problem.constrained, acting_sides(problem)
        return CondensedBody(*known, self._timings, step=step)

    def _take_body(self, body: CondensedBody) -> None:
        """Set up all that follows from a condensed body; collective."""
        self.body, problem = body, self.problem
        self.stiffness, self.held = self.body.stiffness, self.body.held
        self.dofs = self.body.dofs
        self.factorisations += 1
        self._scalar_loads = [self.body.scalar_load(unknown) for unknown in problem.unknowns]
        every = len(self.dofs.free) + self.scalars
        if every > _MANY:
            self.first_way = "monolithic"
        self.repeats_history_cheaply = every <= _LARGE
        with self._timings.phase("factorise"):
            self._place_contacts()
        self._create_vectors()

    def _place_contacts(self) -> None:
        """The contacts over the unknowns, and their tangent; collective."""
        self.version += 1
        known = self.problem, self.body, self._surfaces, self._scalar_loads
        self._contacts = CondensedContacts(*known, self._is_own, self._make_tangent)
        self._dense = self._contacts.tangent
        self._count = self._contacts.kept.count
        self._present: PresentLoads | None = None
        self.is_sprung = bool(self._contacts.sprung.size)

    @property
    def dense_tangent(self) -> ContactTangent | None:
        """The tangent on rank 0, with scalars held as they are now; None on others."""
        if self._dense is not None:
            self._dense.border.hold(self._contacts.is_held)
        return self._dense

    @property
    def width(self) -> int:
        """Number of unknowns that contacts are coupled with, on every rank."""
        return self._contacts.size

    def jump_of(self, contact: ContactSurface) -> ContactJump:
        """The jump of a contact that exerts forces, over the unknowns."""
        found = self._contacts.jumps[self.problem.contacts.index(contact)]
        assert found is not None
        return found

    def update_pairing(self) -> None:
        """Update the pairing of contacts, without another factorisation of the bulk; collective."""
        self.follow_loads()
        values = self._values(self.state)
        displacements, scalars = self.contact_displacements(), self._scalars_of(values)
        self._place_contacts()
        self._destroy_vectors()
        self._create_vectors()
        self._set_state(displacements, scalars)

    def follow_scalar_forces(self) -> None:
        """Take what the body's scalars do to it, after that has changed; collective."""
        self.body.renew_scalars()
        self._scalar_loads = [self.body.scalar_load(one) for one in self.problem.unknowns]
        self._contacts.follow_scalars(self._scalar_loads)
        self.version += 1
        self._present = None

    def follow_bulk(self) -> None:
        """Factorise the body again, without changing one kept for other scenes; collective."""
        self.follow_loads()
        values = self._values(self.state)
        displacements, scalars = self.contact_displacements(), self._scalars_of(values)
        self._destroy_own()
        self._is_own = True
        self._take_body(self._condense())
        self.follow_loads()
        self._set_state(displacements, scalars)

    def _set_state(self, position: Array, scalars: Array) -> None:
        """Set displacements of the free contact dofs, and scalars; collective."""
        with self.state as array:
            if self._root:
                array[:] = np.concatenate([self._contacts.kept.unknowns(position), scalars])

    def _create_vectors(self) -> None:
        size = self._count + self.scalars
        sizes = (size if self._root else 0, size)
        self.state = PETSc.Vec().createMPI(sizes, comm=self.comm)
        self.residual = self.state.duplicate()
        operator = TangentOperator(self._dense)
        self.tangent = PETSc.Mat().createPython((sizes, sizes), operator, comm=self.comm)
        self.tangent.setUp()
        self._balanced: Array | None = None  # unknowns of this rank, at the last balance

    def surface_size(self, number: int) -> int:
        """Number of nodes of a contact's surface, on all ranks."""
        return int(self.problem.contacts[number].trace.surface.space.dofmap.index_map.size_global)

    def compliances(
        self, number: int, across: csr_matrix, ways: list[csr_matrix]
    ) -> tuple[Array, list[Array]] | None:
        """How far forces at a contact move its points across, all other contacts being open.

        Args:
            number: Of the contact, in scene order.
            across: Takes jumps across the contact out of those at all nodes of its surface.
            ways: Take jumps along it, in several directions.

        Returns:
            For forces across, and along each way; None where only contact holds a body, and on
            ranks that have no part of the tangent.
        """
        return self._contacts.compliances(number, across, ways)

    def destroy(self) -> None:
        """Free PETSc's objects, but those of a body that is kept."""
        self._destroy_own()

    def _destroy_own(self) -> None:
        if self._is_own:
            self.body.destroy()
        self._destroy_vectors()

    def _destroy_vectors(self) -> None:
        for thing in (self.tangent, self.state, self.residual):
            thing.destroy()

    def prepare(self, snes: PETSc.SNES) -> None:
        """Solve with the dense tangent."""
        preconditioner = snes.getKSP().getPC()
        preconditioner.setType("python")
        preconditioner.setPythonContext(TangentOperator(self._dense))

    def position(self) -> Array:
        """Displacements of the free contact dofs, on every rank; collective."""
        return self.contact_displacements()

    def contact_displacements(self) -> Array:
        """Displacements of the free contact dofs, on every rank; collective."""
        return self._free_displacements(self._values(self.state))

    def _free_displacements(self, values: Array) -> Array:
        """Displacements of the free contact dofs from the unknowns; collective (length)."""
        own, scalars = values[: self._count], values[self._contacts.size :]
        carried = np.zeros(0) if self._present is None else self._condensed.carried
        return self._contacts.kept.displacements(own, scalars, carried)

    def position_of(self, displacement: Array) -> Array:
        """Displacements of the free contact dofs from nodal ones; collective."""
        return np.asarray(self.dofs.gathered(displacement.reshape(-1))[self.dofs.is_free])

    def at_contacts(self, find_body: FindBody) -> Array:
        """Without a solve inside the body, where its dofs are those of all contacts.

        What faces a body has no half-space behind it, so supports tell all that is held.
        """
        if None in self._contacts.jumps:
            return super().at_contacts(find_body)
        components = self.problem.spaces.components
        found = self.dofs.placed(self.contact_displacements()).reshape(-1, components)
        found = found + self.body.loads_at.supported(self.problem.prescribed, components)
        cut = self.problem.discrete.cut
        return found if cut is None else cut.followed(found)

    def begin(self, displacement: Array) -> None:
        """Start a solve from nodal displacements (nodes, components); collective."""
        super().begin(displacement)
        self.take(self.state)

    def begin_at(self, position: Array) -> None:
        """Start from displacements of the free contact dofs; collective."""
        self.follow_loads()
        self._set_state(position, self.starting_scalars())
        self._started = self._displacements(self._values(self.state))

    def follow_loads(self) -> None:
        """Loads and supports at their present values; collective."""
        present = self.body.loads_at.at(self.problem.load, self.problem.prescribed)
        if present is self._present:
            return
        self._present = present
        self._held_parts = self._contacts.held_parts(present.held)
        moved = self.body.bulk.moved(present.load)
        self._condensed = self._contacts.kept.load(present.condensed, moved)

    @property
    def _loads(self) -> PresentLoads:
        """The loads that were followed last."""
        assert self._present is not None
        return self._present

    def precompute_loads(self, loads: Sequence[Array]) -> None:
        """Solve for what several loads do inside the body together; collective."""
        self.body.precompute_loads(loads)

    def follow_supports(self) -> None:
        """Bring supports and loads to their present values; collective."""
        self.follow_loads()
        self.hold_scalars()
        self.take(self.state)

    def _values(self, state: PETSc.Vec) -> Array:
        """All unknowns, on every rank; collective."""
        return np.asarray(from_root(self.comm, np.array(state.array_r) if self._root else None))

    def _displacements(self, values: Array) -> Array:
        """Displacements of all contact dofs from the unknowns (length)."""
        found = self._loads.held.copy()
        found[self.dofs.is_free] = self._free_displacements(values)
        for value, load in zip(self._scalars_of(values), self._scalar_loads, strict=True):
            found += value * load.displacements
        return self.dofs.followed(found)

    def _scalars_of(self, values: Array) -> Array:
        return values[self._count :]

    def take(self, state: PETSc.Vec) -> None:
        """A vector of unknowns into the jumps; collective."""
        values = self._values(state)
        found = self._contacts.displacements(values, self._held_parts)
        moved = [None if n in self.idle else one for n, one in enumerate(found)]
        self.move_contacts(moved, self._scalars_of(values))

    def balance(self, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        """A y − b − Σ Lᵀ r_c; collective."""
        self.take(state)
        self._balanced = np.array(state.array_r)
        forces = self._contacts.onto_unknowns(self.all_contact_forces())
        left = self._bulk_forces(np.array(state.array_r))
        if self._dense is None:
            return
        driving = np.array([unknown.force for unknown in self.problem.unknowns])
        left -= np.concatenate([self._condensed.own, driving])
        left[self._contacts.size :] += self.problem.pull_of_stops
        left[[self._count + number for number in self.held_scalars]] = 0.0
        for force in forces:
            left[: self._contacts.size] -= force
        with residual as array:
            array[:] = left

    def _bulk_forces(self, values: Array) -> Array:
        """A y, and the forces on the body's scalars, on rank 0; collective."""
        found = np.zeros(0)
        if self._dense is not None:
            found = self._dense.times(values)
            found[self._contacts.size :] += self._loads.on_scalars + self._condensed.on_scalars
        self._note_scalar_forces(found)
        return found

    def linearise(
        self, state: PETSc.Vec, springs: float = 0.0, near: SplitSolver | None = None
    ) -> None:
        """W = Σ Lᵀ K_c B; collective.

        Args:
            state: The unknowns.
            springs: As of ``System.linearise``.
            near: As of ``UnknownsTangent.set``, on rank 0.
        """
        same = self._balanced is not None and np.array_equal(state.array_r, self._balanced)
        if not self.comm.allreduce(same, op=MPI.LAND):
            self.take(state)
        self._contacts.linearise(springs, near)
        left = self._left_by_a_step(self.imbalance(), self.given_forces or self.forces or 1.0)
        if self._dense is not None:
            self._dense.newton_left = left

    def _left_by_a_step(self, imbalance: float, forces: float) -> float:
        """Share of the imbalance that the linear solve of a Newton step may leave.

        A step gains no more than what the imbalance is off by; and what it leaves is to be little
        beside the loads, of which a bad start may be many times out of balance.

        Args:
            imbalance: Before the step (force).
            forces: Those of loads, or what stands for them (force).
        """
        off = imbalance / forces
        least, most = self._shares_left
        return float(np.clip(min(off, most / (off or 1.0)), least, most))

    def linearise_truly(self, near: SplitSolver | None = None) -> None:
        """Set the tangent of an answer in whose state the system is; collective.

        There friction's bound follows the pressure, and tractions turn with the slip as the law has
        it.

        Args:
            near: Solver of the tangent of an answer near this one, as ``split_solver`` gave it.
        """
        for contact in self.problem.frictional:
            if contact.is_coulomb:
                contact.friction_term.follow_pressure()
                contact.follow_pressure()
            kinematics, tangent = contact.kinematics, contact.friction_term.tangent_state
            tangent.take_true(kinematics.tangential(kinematics.jump_at_points()))
        self.linearise(self.state, near=near)

    @property
    def split_solver(self) -> SplitSolver | None:
        """The solver of the last tangent, which others take no part of; None if it is no such."""
        split = None if self._dense is None else self._dense.inner.split
        return None if split is None else copy.copy(split)

    def step_by_last_tangent(self) -> None:
        """Take the step of Newton's method that the last tangent gives, in full; collective."""
        self.balance(self.state, self.residual)
        with self.state as array:
            if self._dense is not None:
                array -= self._dense.solve(np.array(self.residual.array_r))
        self.take(self.state)

    def change(self, condensed: Array, on_scalars: Array) -> tuple[Array, Array]:
        """Changes of the unknowns by small forces, by the last tangent; collective.

        Args:
            condensed: Forces condensed onto the free contact dofs; used on rank 0 (force).
            on_scalars: Forces that they make on the body's scalars (force).

        Returns:
            Displacements of the free contact dofs (length), and the body's scalars.
        """
        kept, found = self._contacts.kept, None
        load = kept.load(condensed)
        if self._dense is not None:
            right = np.zeros(self._count + self.scalars)
            right[: self._count] = load.own
            on_scalars = on_scalars + load.on_scalars
            right[self._contacts.size :] = np.where(self._contacts.is_held, 0.0, -on_scalars)
            found = self._dense.solve(right)
        found = np.asarray(from_root(self.comm, found))
        own, scalars = found[: self._count], found[self._contacts.size :]
        return kept.displacements(own, scalars, load.carried), scalars

    def adjoint(self) -> CondensedAdjoint:
        """The adjoint of the tangent that was set last; collective."""
        jumps = self._contacts.jumps
        return CondensedAdjoint(self.problem, self.body, self._contacts.kept, self._dense, jumps)

    def imbalance(self) -> float:
        """1-norm of the last residual (force); collective."""
        return float(from_root(self.comm, float(np.abs(self.residual.array_r).sum())))

    def round_off(self) -> float:
        """20 × machine epsilon × ‖|M| |y|‖₁; collective."""
        left = 0.0 if self._dense is None else self._dense.magnitude(np.array(self.state.array_r))
        return float(from_root(self.comm, 20 * np.finfo(float).eps * left))

    def moved(self) -> float:
        """Largest displacement of the contacts since the start (length)."""
        present = self._displacements(self._values(self.state))
        return float(np.abs(present - self._started).max(initial=0.0))

    def finish(self) -> FindBody:
        """Return a function that finds the displacement inside when first asked; collective.

        At once where something follows it: contacts that exert no forces, or scalars of the body
        that are not given.
        """
        values = self._values(self.state)
        load = self._loads.load.copy()
        for value, one in zip(self._scalars_of(values), self._scalar_loads, strict=True):
            load += value * one.load
        at_contacts = self._free_displacements(values)
        values_of = [one.value for one in self.problem.body_scalars]
        scalars = list(zip(values_of, self.body.scalars.nodal, strict=True))
        find = LazyDisplacement(partial(self._expanded, load, at_contacts, scalars))
        if not self._are_given:
            find()
        if None in self._contacts.jumps:
            others = [
                contact.kinematics.relative(find().displacement) if jump is None else None
                for contact, jump in zip(self.problem.contacts, self._contacts.jumps, strict=True)
            ]
            self.move_contacts(others, self._scalars_of(values))
        return find

    @property
    def _are_given(self) -> bool:
        """Whether the scene gives the values of all of the body's scalars."""
        return all(one.is_given for one in self.problem.body_scalars)

    def scalar_states(self, find_body: FindBody) -> tuple[ScalarState, ...]:
        """States of the body's scalars; where all are given, from the contacts alone; collective.

        Args:
            find_body: As of ``finish``.
        """
        if not (self.problem.body_scalars and self._are_given):
            return super().scalar_states(find_body)
        self._bulk_forces(np.array(self.state.array_r))
        pairs = zip(self.problem.body_scalars, self.scalar_forces, strict=True)
        return tuple(one.state_at(float(force), one.value) for one, force in pairs)

    def _expanded(
        self, load: Array, at_contacts: Array, scalars: Sequence[tuple[float, Array]]
    ) -> BodyAnswer:
        """Displacement and K u at the nodes; the functions follow; collective.

        Args:
            load: On this rank's unknowns (force).
            at_contacts: Displacements of the free contact dofs (length).
            scalars: Value of each of the body's scalars, and nodal forces over it.
        """
        found = self.body.bulk.expand(load, at_contacts)
        self.stiffness.set_functions(found)
        components = self.problem.spaces.components
        internal = self.stiffness.forces(found)
        for value, nodal in scalars:
            internal += value * nodal
        values = np.array([value for value, _ in scalars])
        moved = self.problem.moved_by_scalars(values)
        if moved is not None:
            self.problem.displacement.x.array[:] += moved.reshape(-1)
        return BodyAnswer(
            self.problem.displacement.x.array.reshape(-1, components).copy(),
            internal,
            self.stiffness.round_off(found),
            self.problem.present_mean_stress(),
        )


def acting_sides(problem: Problem) -> list[ContactSides]:
    """The surfaces of the contacts that exert forces."""
    return [contact.sides for contact in problem.contacts if contact.forces.terms]
