"""Internal forces and forces of inertia in a step of motion, against contacts."""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.evaluate.contact_resultants import resultant
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.inertia.moving import moving
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import DAMPING_WORK, KINETIC_ENERGY, MOMENTUM
from fenics_contact.solve.load_steps.load_stepper import forces_of_step
from fenics_contact.solve.newton.solution import Solution


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
        return loads, self._summed(self.reactions * moved) - self._work_of_kinks()

    def _work_of_kinks(self) -> float:
        """Work that supports do less than their mean force times the way (energy); collective.

        They take nodes along by the mean velocity of each step. So they change it between steps, at
        once, by an impulse at the mean of the velocities before and after it.
        """
        jumped = self._step.velocity - self.inertia.state.velocity
        change = np.where(self.problem.free, 0.0, jumped)
        return 0.5 * self._summed(change * self.inertia.masses.times(change))

    def quantities(self) -> dict[str, Any]:
        """Quantities of the whole model besides those of statics; collective."""
        spaces = self.problem.spaces
        damped = {} if self.inertia.damping is None else {DAMPING_WORK: self._step.drag.lost}
        return {
            KINETIC_ENERGY: self.inertia.kinetic_energy(self._step.velocity),
            **self.inertia.masses.quantities(self._step.velocity),
            **damped,
            MOMENTUM: resultant(spaces, self.momenta[: spaces.owned_nodes]).tolist(),
        }
