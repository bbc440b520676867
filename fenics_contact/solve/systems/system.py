"""The system that Newton's method solves: bulk, contacts and scalars in balance.

A system turns
PETSc's vectors of unknowns into jumps of the contacts, and forces of the contacts into residuals
and tangents. The full one has every displacement as an unknown, the condensed one only those of
the contact surfaces.

Springs keep steps of Newton's method short where contact alone holds a body. A roller that
touches a ring at a few points can roll: nothing but the neighbours of these points resists, once
they touch. The tangent is singular, or nearly so, and a step by it goes far beyond what is drawn.
Springs at as many dofs as there are free motions are added to the tangent, and to nothing else:
the forces in balance have none, so that the answer has none (proximal point method: R. T.
Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from petsc4py import PETSc
from scipy.linalg import qr

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root, total
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.problem.scalar_unknown import ScalarState, ScalarUnknown
from fenics_contact.solve.systems.solution import FindBody


class System(ABC):
    """Force imbalance and tangent of a problem; rank 0 has the scalar unknowns last.

    Attributes:
        problem: What is solved.
        state: The unknowns, a PETSc vector.
        residual: The force imbalance, likewise.
        tangent: Its derivative, a PETSc matrix.
        options: PETSc's options for its linear solves.
        first_way: Which strategy of Coulomb friction ``auto`` begins with.
        repeats_cheaply: Whether another answer of the body costs little beside the first.
        repeats_history_cheaply: Whether all load steps once more do.
        scale_tolerance: Imbalance over the forces from which the ε of a contact that carries
            most of the forces is known well enough; None where further steps cost little.
        factorisations: How often a matrix of the bulk was factorised.
        is_sprung: Whether it has ``step_springs``, for steps of Newton's method.
        earlier_forces: Largest of ``present_forces`` in the load steps that are done (force).
        scalar_forces: Forces of the body that do work on its scalars, at the last residual,
            (body_scalars,), on every rank (force).
        idle: Numbers of contacts of which no point can touch at present: a solve passes them over.
    """

    name: ClassVar[str]
    options: ClassVar[dict[str, Any]]
    first_way: str = "campos"
    repeats_cheaply: ClassVar[bool] = False
    repeats_history_cheaply: bool = False
    scale_tolerance: ClassVar[float | None] = None
    is_sprung: bool = False
    state: PETSc.Vec
    residual: PETSc.Vec
    tangent: PETSc.Mat
    factorisations: int
    idle: frozenset[int] = frozenset()

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.comm = problem.comm
        self.earlier_forces = 0.0
        self._contact_norm = 0.0
        self._load_norm: tuple[Array, float] | None = None
        self.scalar_forces = np.zeros(len(problem.body_scalars))

    def begin_again(self) -> None:
        """Forget all forces so far, as its problem is that of another scene now."""
        self.earlier_forces = self._contact_norm = 0.0

    def begin(self, displacement: Array) -> None:
        """Start a solve from nodal displacements (nodes, components); collective."""
        self.begin_at(self.position_of(displacement))

    @abstractmethod
    def position(self) -> Array:
        """The unknowns as displacements, to begin at again; collective."""

    @abstractmethod
    def position_of(self, displacement: Array) -> Array:
        """The position that nodal displacements (nodes, components) have; collective."""

    def at_contacts(self, find_body: FindBody) -> Array:
        """Displacement of the present state, at least at the contacts' nodes; collective.

        Returns:
            At the body's nodes of this rank, (nodes, components) (length).
        """
        return find_body().displacement

    @abstractmethod
    def begin_at(self, position: Array) -> None:
        """Start a solve from displacements as ``position`` gives them; collective."""

    @abstractmethod
    def follow_supports(self) -> None:
        """Bring supports and loads of the state to their present values; collective."""

    @abstractmethod
    def take(self, state: PETSc.Vec) -> None:
        """A vector of unknowns into the contacts' jumps; collective."""

    @abstractmethod
    def balance(self, state: PETSc.Vec, residual: PETSc.Vec) -> None:
        """The force imbalance of a state; collective."""

    @abstractmethod
    def linearise(self, state: PETSc.Vec, springs: float = 0.0) -> None:
        """Set the tangent to that of a state; collective.

        Args:
            state: The unknowns.
            springs: Stiffness of ``step_springs``, over that of the body at their dofs.
        """

    @abstractmethod
    def imbalance(self) -> float:
        """1-norm of the last residual (force); collective."""

    @abstractmethod
    def round_off(self) -> float:
        """20 × machine epsilon × ‖|J| |u|‖₁: what round-off leaves of a residual; collective."""

    @abstractmethod
    def moved(self) -> float:
        """Largest displacement since the start (length); collective."""

    @abstractmethod
    def finish(self) -> FindBody:
        """Return a function that finds the body's displacement in this state; collective."""

    @abstractmethod
    def update_pairing(self) -> None:
        """Take what faces what as the contacts of bodies know it now; collective."""

    @abstractmethod
    def destroy(self) -> None:
        """Free PETSc's objects: factors hold communicators, of which there are few."""

    @abstractmethod
    def prepare(self, snes: PETSc.SNES) -> None:
        """Set whatever the linear solver needs besides its options."""

    def take_in_closed(self) -> bool:
        """Take in contact dofs where points have closed that the last answer left out; collective.

        Returns:
            Whether there are any: the step is to be solved again.
        """
        return False

    def take_in_all(self) -> bool:
        """Take in all contact dofs, after a solve without some has failed; collective.

        Returns:
            Whether there were others: the step is to be tried again.
        """
        return False

    def precompute_loads(self, loads: Sequence[Array]) -> None:  # noqa: B027  (most have nothing to prepare)
        """Prepare for answers under further loads; collective.

        Args:
            loads: At the nodes of this rank, (nodes, components) each (force).
        """

    @property
    def forces(self) -> float:
        """Force against which an imbalance is small: the largest so far (force); collective.

        Not only what acts at present: a body that is unloaded keeps the round-off of before.
        """
        return max(self.present_forces, self.earlier_forces)

    @property
    def present_forces(self) -> float:
        """1-norm of the forces on the body at the last residual (force); collective."""
        return self.given_forces + self._contact_norm

    @property
    def given_forces(self) -> float:
        """1-norm of loads, and of forces on the body's scalars (force); collective."""
        owned = self.problem.spaces.owned_nodes
        load, known = self.problem.load, self._load_norm
        if known is None or known[0] is not load:  # another load is another array
            known = load, float(total(self.comm, self.problem.applied[:owned].sum()))
            self._load_norm = known
        pairs = zip(self.problem.body_scalars, self.scalar_forces, strict=True)
        return known[1] + sum(scalar.applied(float(force)) for scalar, force in pairs)

    @property
    def scalars(self) -> int:
        """Number of scalar unknowns."""
        return len(self.problem.unknowns)

    def scalar_values(self, state: PETSc.Vec) -> Array:
        """Values of the scalar unknowns, on every rank; collective."""
        if not self.scalars:
            return np.zeros(0)
        last = np.array(state.array_r[-self.scalars :]) if self.comm.rank == 0 else None
        return np.asarray(from_root(self.comm, last))

    def set_scalars(self, values: Array) -> None:
        """Give the scalar unknowns values, (scalars,)."""
        with self.state as array:
            if self.scalars and self.comm.rank == 0:
                array[-self.scalars :] = values

    def follow_bulk(self) -> None:
        """Take the body's stiffness, and what its scalars do to it, after a change; collective.

        Raises:
            NotImplementedError: The system cannot.
        """
        raise NotImplementedError("only a condensed system follows moduli that change")

    def follow_scalar_forces(self) -> None:
        """Take what the body's scalars do to it, after that has changed; collective.

        Raises:
            NotImplementedError: The system cannot.
        """
        raise NotImplementedError("only a condensed system follows temperatures that are found")

    def _note_scalar_forces(self, forces: Array) -> None:
        """Tell every rank the forces on the body's scalars, which rank 0 has last; collective."""
        count = len(self.problem.body_scalars)
        if count:
            own = np.array(forces[-count:]) if self.comm.rank == 0 else None
            self.scalar_forces = np.asarray(from_root(self.comm, own))

    def scalar_states(self, find_body: FindBody) -> tuple[ScalarState, ...]:
        """States of the body's scalars in the present state; collective.

        Args:
            find_body: As of ``finish``.
        """
        if not self.problem.body_scalars:
            return ()
        return self.problem.scalar_states(find_body().displacement)

    def set_mean_stress(self) -> None:  # noqa: B027  (most systems have none)
        """Start from the mean stress that its function has, where it is an unknown here."""

    def starting_scalars(self) -> Array:
        """Values of the scalar unknowns at which a solve starts, (scalars,)."""
        return np.array([unknown.start for unknown in self.problem.unknowns])

    @property
    def held_scalars(self) -> list[int]:
        """Numbers of the scalar unknowns that are held at their values."""
        return [i for i, unknown in enumerate(self.problem.unknowns) if unknown.held is not None]

    def hold_scalars(self) -> None:
        """Bring scalars that are held to their values."""
        with self.state as array:
            for number in self.held_scalars if self.comm.rank == 0 else ():
                array[len(array) - self.scalars + number] = self.problem.unknowns[number].held

    def all_contact_forces(self) -> list[Array]:
        """Forces on the body at the nodes of each surface; remembers their 1-norm; collective."""
        found = [
            contact.forces.none() if number in self.idle else contact.forces.all()
            for number, contact in enumerate(self.problem.contacts)
        ]
        own = sum(
            np.abs(force[: contact.trace.surface.owned_nodes]).sum()
            for contact, force in zip(self.problem.contacts, found, strict=True)
        )
        self._contact_norm = float(total(self.comm, own))
        return found

    def move_contacts(self, displacements: Sequence[Array | None], scalars: Array) -> None:
        """Set the jumps from displacements relative to bodies opposite, at all nodes of surfaces.

        None where they are not known. And give bodies and obstacles the values of their scalars.
        """
        for unknown, value in zip(self.problem.unknowns, scalars, strict=True):
            unknown.take(float(value))
        for contact, displacement in zip(self.problem.contacts, displacements, strict=True):
            if displacement is not None:
                contact.kinematics.move(displacement)
                contact.follow_pressure()

    def pushed(self, unknown: ScalarUnknown, forces: list[Array]) -> float:
        """Work of the force of a scalar unknown's contact on the body in it, 0 without one.

        Collective.
        """
        if unknown.contact is None:
            return 0.0
        force = forces[self.problem.contacts.index(unknown.contact)]
        owned = unknown.contact.trace.surface.owned_nodes
        return float(total(self.comm, np.sum(force[:owned] * unknown.field[:owned])))

    def scalar_imbalances(self, values: Array, forces: list[Array]) -> Array:
        """Imbalances of the scalar unknowns' equations, (scalars,) (force); collective.

        Without the forces that the body itself has in them.
        """
        pairs = zip(self.problem.unknowns, values, strict=True)
        found = [u.imbalance(float(value), self.pushed(u, forces)) for u, value in pairs]
        first = len(found) - len(self.problem.body_scalars)
        return np.array([*found[:first], *(found[first:] + self.problem.pull_of_stops)])


# Of the largest row of motions, below which a row tells of no further motion.
_TELLS = 1e-6


def free_motions(problem: Problem) -> list[Array]:
    """Rigid motions of bodies that only contact resists; collective.

    There are none where inertia resists every motion.

    Args:
        problem: The problem, with its supports.

    Returns:
        Nodal displacements in each motion, (nodes, components).
    """
    if problem.inertia.moves:
        return []
    motions = RigidMotions(problem)
    if motions.body_is_held:
        return []
    return [motions.displacement(one) for one in np.eye(motions.count)]


def sprung(motions: Array) -> Integers:
    """Rows of motions (rows, motions) which together tell all of them apart."""
    if motions.size == 0:
        return np.zeros(0, dtype=np.int64)
    upper, order = qr(motions.T, mode="r", pivoting=True)
    sizes = np.abs(upper.diagonal())
    return np.asarray(order[: int((sizes > _TELLS * sizes.max(initial=0.0)).sum())], dtype=np.int64)
