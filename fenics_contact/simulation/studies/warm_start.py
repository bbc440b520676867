"""Where the load steps of the next answer begin: at those of the last one, where that is safe.

Contact without friction, and friction under given pressures, have one answer, wherever Newton's
method begins. So has Coulomb's friction, by an estimate, up to a coefficient that is a matter of
the body and its contact surfaces (``trust/uniqueness.py``). Beyond it an answer that begins at
another one may follow a branch that a separate run would not be on: then it begins as that does,
unless it is asked to follow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import carries_more_than
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import differing
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.coulomb.monolithic import fit_scale, is_out_of_scale
from fenics_contact.solve.coulomb.without_friction import (
    contact_without_friction,
    set_needed,
    telling_pressure,
)
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.uniqueness import uniqueness_limit

# Keys that have no part in the pressures without friction, and those that are looked at further.
_OF_SCENE, _OF_COULOMB = {"title", "contact"}, {"friction_coefficient"}

# Imbalance over the forces where pressures are wanted for ε alone, which knows them as well: an ε
# that is off by a hundredth changes forces by some 1e-9.
_SCALE_TOLERANCE = 1e-7

_WORDS = "Newton's method on contact and friction together, from the last answer"


@dataclass(frozen=True, eq=False)
class SolvedState:
    """The unknowns of an answer.

    Attributes:
        position: Displacements as ``System.position`` gives them (length).
        scalars: Values of the scalar unknowns.
        opposite: Of each contact, gap and motion of what stands opposite at the points (length).
        counted_from: Of each contact, the slip from which its law counts (length).
        jumps: Of each contact, that at its points (length).
    """

    position: Array
    scalars: Array
    opposite: list[tuple[Array, Array]]
    counted_from: list[Array]
    jumps: list[Array]

    @classmethod
    def of(cls, newton: Newton) -> SolvedState:
        """The present one; collective."""
        system, contacts = newton.system, newton.problem.contacts
        return cls(
            system.position(),
            system.scalar_values(system.state),
            [_opposite(contact) for contact in contacts],
            [contact.friction.reference for contact in contacts],
            [contact.kinematics.jump_at_points() for contact in contacts],
        )

    def position_in(self, newton: Newton) -> Array:
        """The displacements with which points are as deep, and have slipped as far, as they had.

        In what stands opposite now; slipped as their law counts it, from the load step before. So
        the first step of Newton's method has the tangent of the other answer, and goes where that
        leads to: an obstacle that stood deeper would leave few points in contact with it, at
        pressures that none of them has. So would two bodies, if the points of either were measured
        from others of the other one than they were then. Collective.
        """
        problem = newton.problem
        shift = np.zeros_like(problem.load)
        anew = [contact.kinematics.paired_at is not None for contact in problem.contacts]
        if any(anew):
            newton.begin.at(self.position, self.scalars)
        before = zip(problem.contacts, self.opposite, self.counted_from, strict=True)
        for number, (contact, (gap, motion), counted_from) in enumerate(before):
            present, moved = _opposite(contact)
            known = np.isfinite(gap) & np.isfinite(present)
            wider = np.where(known, present, 0.0) - np.where(known, gap, 0.0)
            shifts = wider[:, None] * contact.trace.normals + (moved - motion)
            shifts += contact.friction.reference - counted_from
            if anew[number]:
                measured_anew = self.jumps[number] - contact.kinematics.jump_at_points()
                shifts += np.where(known[:, None], measured_anew, 0.0)
            shift[contact.nodes] = shifts[: len(contact.nodes)]
        return self.position + newton.system.position_of(shift)


def _opposite(contact: ContactSurface) -> tuple[Array, Array]:
    """Gap at the points, and how far what is known of its motion takes the obstacle (length)."""
    kinematics = contact.kinematics
    return kinematics.gap, kinematics.field(contact.known_motion)


@dataclass(frozen=True, eq=False)
class WithoutFriction:
    """The answer without friction, whose pressures tell the ε of each Coulomb contact.

    Attributes:
        scene: Of which it is.
        state: The unknowns.
        pressures: At the points of each Coulomb contact, by its number in scene order; None where
            it carries too little to tell (stress).
    """

    scene: Scene
    state: SolvedState
    pressures: dict[int, Array | None]

    @classmethod
    def solved(cls, newton: Newton) -> WithoutFriction:
        """From the present state on; sets ε; collective."""
        problem = newton.problem
        contact_without_friction(newton, _SCALE_TOLERANCE)
        if not all([carries_more_than(contact, newton.limit) for contact in problem.coulomb]):
            contact_without_friction(newton)
        pressures = {
            number: telling_pressure(contact, newton.limit)
            for number, contact in enumerate(problem.contacts)
            if contact.is_coulomb
        }
        return cls(problem.scene, SolvedState.of(newton), pressures)

    def is_of(self, problem: Problem) -> bool:
        """Whether a problem differs from that in coefficients of such contacts at the most."""
        coulomb = [n for n, contact in enumerate(problem.contacts) if contact.is_coulomb]
        if coulomb != list(self.pressures) or differing(self.scene, problem.scene) - _OF_SCENE:
            return False
        contacts = zip(self.scene.contact, problem.scene.contact, strict=True)
        return not any(
            differing(*pair) - (_OF_COULOMB if number in self.pressures else set())
            for number, pair in enumerate(contacts)
        )

    def set_scales(self, problem: Problem) -> None:
        """Set ε as solving it again would; collective."""
        for number, pressure in self.pressures.items():
            contact = problem.contacts[number]
            if pressure is not None and contact.friction.regularisation.follows_pressure:
                set_needed(contact, pressure)


@dataclass(frozen=True, eq=False)
class SolvedStep:
    """A load step of an answer.

    Attributes:
        state: The unknowns.
        tangents: Of each contact's friction, what its tangent was at.
        forces: At the points, where an exact solver found them; else None (force).
    """

    state: SolvedState
    tangents: list[tuple[Array, Array]]
    forces: Array | None = None


class WarmStart:
    """Solves load steps from those of an answer on the same body; collective.

    Attributes:
        steps: Those of the answer, in order.
        without_friction: The first one without friction, which tells ε; None until it is found.
    """

    def __init__(self) -> None:
        self.steps: list[SolvedStep] = []
        self.without_friction: WithoutFriction | None = None

    def know_without_friction(self, found: WithoutFriction | None) -> None:
        """Have an answer without friction that was found before."""
        self.without_friction = found

    def keep(self, newton: Newton) -> None:
        """A step of the answer, just solved; collective."""
        every = [contact.friction_term.tangent_state for contact in newton.problem.contacts]
        tangents = [state.slip_and_direction for state in every]
        forces = None if newton.exact is None else newton.exact.last_forces
        self.steps.append(SolvedStep(SolvedState.of(newton), tangents, forces))

    def suits(self, problem: Problem) -> bool:
        """Whether the unknowns are the same, and no bolt is to be tightened from nothing."""
        is_tight = all(scalar.has_force for scalar in problem.body_scalars)
        points = [len(contact.trace.weights) for contact in problem.contacts]
        first = self.steps[0]
        same_points = points == [len(slip) for slip, _ in first.tangents]
        return is_tight and same_points and len(problem.unknowns) == len(first.state.scalars)

    def solve(self, newton: Newton, number: int) -> Solution | None:
        """The present step; collective.

        Args:
            newton: At the beginning of a load step.
            number: Of the step in the answer that begins here, from 0.

        Returns:
            None where there was no such step, or its ε does not tell how a separate run goes on.

        Raises:
            NotConvergedError: In words, with the history of the force imbalance.
        """
        if number >= len(self.steps):
            return None
        problem, step = newton.problem, self.steps[number]
        if newton.exact is not None:
            self._place(newton, step.state)
            return newton.solve_exactly(newton.exact, step.forces)
        if not problem.coulomb:
            self._place(newton, step.state)
            self._take_tangents(problem, step)
            newton.run()
            return newton.solution()
        if number == 0 and any(
            contact.friction.regularisation.follows_pressure for contact in problem.coulomb
        ):
            self._find_scales(newton)
        if number and not all(
            contact.friction.regularisation.is_known for contact in problem.coulomb
        ):
            return None
        self._place(newton, step.state)
        self._take_tangents(problem, step)
        for contact in problem.coulomb:
            contact.friction_term.follow_pressure()
        newton.run(search_energy=False)
        if number and is_out_of_scale(newton):
            return None
        fit_scale(newton)
        return newton.solution(0, _WORDS)

    def _find_scales(self, newton: Newton) -> None:
        """Set ε from pressures without friction: the last ones, where coefficients alone differ."""
        known = self.without_friction
        if known is not None and known.is_of(newton.problem):
            known.set_scales(newton.problem)
            return
        self._place(newton, self.steps[0].state if known is None else known.state)
        self.without_friction = WithoutFriction.solved(newton)

    def _place(self, newton: Newton, state: SolvedState) -> None:
        for scalar in newton.problem.body_scalars:
            scalar.keep(None)
        newton.begin.at(state.position_in(newton), state.scalars)

    def _take_tangents(self, problem: Problem, step: SolvedStep) -> None:
        for contact, state in zip(problem.contacts, step.tangents, strict=True):
            contact.friction_term.tangent_state.take(state)


class Uniqueness:
    """Up to which coefficients the contacts of a body have one answer, worked out once each.

    Of all points of a contact, so that it holds whatever touches.
    """

    def __init__(self) -> None:
        self._limits: dict[tuple[int, float], float | None] = {}

    def is_sure(self, system: CondensedSystem) -> bool:
        """Whether the present problem has but one answer, by the estimate; collective."""
        contacts = system.problem.contacts
        return all([self._is_below(system, n, c) for n, c in enumerate(contacts) if c.is_coulomb])

    def _is_below(self, system: CondensedSystem, number: int, contact: ContactSurface) -> bool:
        comm = contact.spaces.comm
        if not contact.friction.rule.is_linear:
            return False
        coefficient = contact.friction.largest_coefficient
        most = largest(comm, coefficient)
        if contact.kinematics.pairing is not None or smallest(comm, coefficient) < most:
            return False
        neighbours = contact.friction.neighbours
        key = number, 0.0 if neighbours is None else neighbours.radius
        if key not in self._limits:
            self._limits[key] = uniqueness_limit(system, number, every=True)
        limit = self._limits[key]
        return limit is not None and most <= limit
