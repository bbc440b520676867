"""Forces of inertia in a step of motion, and whether momenta change by the impulses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.evaluate.contact_quantities import resultant
from fenics_contact.evaluate.internal_forces import InternalForces, ScalarBalance
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.moving import moving
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import BodyScalar
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    DAMPING_WORK,
    FRICTION_FORCE,
    IMPULSE,
    KINETIC_ENERGY,
    MOMENTUM,
)
from fenics_contact.results.result import Check
from fenics_contact.solve.load_steps.load_stepper import forces_of_step
from fenics_contact.solve.systems.solution import Solution


class MovingForces(BulkForces):
    """Internal forces of a step of motion; friction and reactions are means of the step.

    Attributes:
        inertia: Masses, and what the step began from.
    """

    rests = False

    def __init__(self, problem: Problem, solution: Solution) -> None:
        super().__init__(problem, solution)
        self.inertia, self.load = moving(problem.inertia), problem.given_load
        self._step = forces_of_step(problem, solution)
        self._unbalanced = self._step.needed - self.contacts

    @property
    def strain_energy(self) -> float:
        """½ a(e, e) of the elastic strain e: beyond what is free of stress (energy)."""
        product = self._summed(self.displacement * self._step.internal)
        return 0.5 * (product + self.solution.work_on_scalars)

    @property
    def momenta(self) -> Array:
        """M v at its end, at the nodes (mass × velocity)."""
        return self.inertia.masses.times(self._step.velocity)

    def momentum_changes(self) -> Array:
        """M (v₁ − v₀) at the nodes (mass × velocity)."""
        return self.momenta - self.inertia.masses.times(self.inertia.state.velocity)

    def mean_forces(self) -> Array:
        """Mean forces on the nodes in the step, but for the bulk's own (force)."""
        inertia, step = self.inertia, self._step
        rubbed = self.contacts - step.pressed
        pressed = inertia.state.pressed + step.pressed
        given = 0.5 * (inertia.state.load + self.load + pressed - inertia.missing)
        return given + self.reactions + rubbed - step.dragged

    def works_since(self, before: InternalForces | None) -> tuple[float, float]:
        """Works of loads, by the trapezoidal rule, and of reactions, which are means (energy)."""
        state = self.inertia.state  # that the step began from
        moved = self.displacement - state.displacement
        acting = state.load + self.load - self.inertia.missing
        loads = 0.5 * self._summed(acting * moved)
        held = self._summed(self.reactions * moved) - self._work_of_kinks()
        return loads, held + self._work_at_points(moved)

    def _work_of_kinks(self) -> float:
        """Work that supports do less than their mean force times the way (energy); collective.

        They take nodes along by the mean velocity of each step. So they change it between steps, at
        once, by an impulse at the mean of the velocities before and after it.
        """
        jumped = self._step.velocity - self.inertia.state.velocity
        momenta = self.inertia.masses.times(jumped) + self.inertia.points.momenta(jumped)
        return 0.5 * self._summed(self.inertia.of_given(jumped) * momenta)

    def _work_at_points(self, moved: Array) -> float:
        """Work on points besides that of what they push their faces with (energy); collective."""
        asked, _, pushed = self._on_points
        return float((asked - pushed) @ self.inertia.points.along(moved))

    @cached_property
    def _on_points(self) -> tuple[Array, Array, Array]:
        """Mean forces on points in the step, as asked and as found, and on their faces (force)."""
        points = self.inertia.points
        pushed = points.pushed(self._rigid_reactions, self.solution.scalars)
        ends = self.displacement, self._step.velocity
        return *points.mean_forces(self.inertia.state, ends, pushed), pushed

    def scalar_balances(self) -> list[ScalarBalance]:
        """Balance of each of the body's scalars, of points by the mean forces of the step."""
        every = zip(self.inertia.points.every, *self._on_points, strict=True)
        of_points: dict[BodyScalar, ScalarBalance] = {
            one: ScalarBalance(one, float(asked), float(found), abs(float(pushed)))
            for one, asked, found, pushed in every
        }
        return [of_points.get(row.scalar, row) for row in super().scalar_balances()]

    @property
    def left_open(self) -> float:
        """Work of stops that begin or cease to act within the step, by the mean of both ends."""
        joints, points = self.problem.elastic.joints, self.inertia.points
        before, now = points.values(self.inertia.state.displacement), self._scalars
        done = 0.5 * (joints.pull(before) + joints.pull(now)) @ (now - before)
        return abs(float(done) - joints.energy(now) + joints.energy(before))

    def quantities(self) -> dict[str, Any]:
        """Quantities of the whole model besides those of statics; collective."""
        spaces, velocity = self.problem.spaces, self._step.velocity
        momenta = self.momenta + self.inertia.points.momenta(velocity)
        damped = {} if self.inertia.damping is None else {DAMPING_WORK: self._step.drag.lost}
        return {
            KINETIC_ENERGY: self.inertia.kinetic_energy(self._step.velocity),
            **self.inertia.masses.quantities(self._step.velocity),
            **damped,
            MOMENTUM: resultant(spaces, momenta[: spaces.owned_nodes]).tolist(),
        }


# Round-off of sums over the body, of the impulses and momenta that are added up.
_ROUND_OFF = 1e-9
# Of the largest momentum of a part: below that another part has not been touched yet.
_UNTOUCHED = 1e-6


class MomentumBalance:
    """Impulses of contacts, summed over the steps, and what is left of the balance of momenta.

    Pressures act by the mean of both ends of a step, friction and supports by their mean of it.

    Attributes:
        impulses: Of each contact on the body of ``on``, (contacts, components) (force × time).
        worst: Largest share of the momenta and impulses of a connected part that a step left open.
        part: Which part that was, by its number.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        shape = (len(problem.contacts), problem.spaces.components)
        self.impulses, self._last = np.zeros(shape), problem.inertia.first.pressures.copy()
        self.worst, self.part = 0.0, 0
        self._accepted = 0.0
        self._largest = np.zeros(problem.spaces.parts.count)

    def count(self, forces: MovingForces, contacts: list[dict[str, Any]]) -> dict[str, Any]:
        """Count a step that was accepted; collective.

        Args:
            forces: Of its solution.
            contacts: Quantities of each contact, to which its impulse is added.

        Returns:
            The impulse of the only contact, as a quantity of the whole model; none of several.
        """
        size = forces.inertia.size
        for number, found in enumerate(contacts):
            friction = np.array(found[FRICTION_FORCE])
            pressed = np.array(found[CONTACT_FORCE]) - friction
            mean = 0.5 * (self._last[number] + pressed) + friction
            self._last[number] = pressed
            self.impulses[number] += size * mean
            found[IMPULSE] = self.impulses[number].tolist()
        self._balance(forces)
        return {IMPULSE: contacts[0][IMPULSE]} if len(contacts) == 1 else {}

    def _balance(self, forces: MovingForces) -> None:
        parts, owned = self._problem.spaces.parts, self._problem.spaces.owned_nodes
        size, changes = forces.inertia.size, forces.momentum_changes()
        acting = size * forces.mean_forces()
        left = changes - acting
        if self._problem.spaces.kinematics == "axisymmetric":
            left[:, 0] = 0.0  # radial forces cancel around the ring
        off = np.linalg.norm(parts.sums(left[:owned]), axis=1)
        carried = np.abs(acting) + np.abs(changes) + np.abs(forces.momenta)
        self._largest = np.maximum(self._largest, parts.sums(carried[:owned].sum(axis=1)))
        allowed = 2 * size * forces.solution.imbalance_limit
        # What has not been touched yet has round-off of the others alone; what waves have hardly
        # reached, the imbalance that was accepted.
        least = max(_UNTOUCHED * self._largest.max(), allowed / _ROUND_OFF)
        sizes = np.maximum(self._largest, least)
        shares = np.divide(off, sizes, out=np.zeros_like(off), where=sizes > 0)
        self._accepted = max(self._accepted, allowed / (self._largest.max() or 1.0))
        number = int(np.argmax(shares))
        if not shares[number] <= self.worst:
            self.worst, self.part = float(shares[number]), number

    def check(self) -> Check:
        """The worst step against what round-off and the accepted imbalance may leave."""
        part = self._problem.spaces.parts.names[self.part] if self.worst > 0 else ""
        return Check(self.worst, _ROUND_OFF + self._accepted, part=part)

    @property
    def sums(self) -> list[float]:
        """Sums so far, to be given to ``resume``."""
        few = [self.worst, float(self.part), self._accepted]
        return [*few, *map(float, self.impulses.ravel()), *map(float, self._largest)]

    def resume(self, sums: Sequence[float], contacts: list[dict[str, Any]]) -> None:
        """Go on from the last step of another run.

        Args:
            sums: Those of its balance.
            contacts: Quantities of each contact in that step.
        """
        few, impulses, self._largest = np.split(np.array(sums), [3, 3 + self.impulses.size])
        self.worst, self.part, self._accepted = float(few[0]), int(few[1]), float(few[2])
        self.impulses = impulses.reshape(self.impulses.shape)
        for number, found in enumerate(contacts):
            self._last[number] = np.subtract(found[CONTACT_FORCE], found[FRICTION_FORCE])
