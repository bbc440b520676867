"""Results of the load steps of a run, and the whole state of the last one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any, Generic, TypeVar

from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import attempt
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.contact_quantities import contact_quantities, slid
from fenics_contact.evaluate.energy_balance import EnergyBalance, load_records
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.momentum_balance import MomentumBalance, MovingForces
from fenics_contact.evaluate.quantities import (
    global_quantities,
    scalar_records,
    stretch_quantities,
    support_records,
)
from fenics_contact.evaluate.stress_at_places import stress_at_points
from fenics_contact.evaluate.temperatures import ModelTemperatures
from fenics_contact.problem.existence.slip_shares import share_of_contact, slip_shares
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import SLIP_SHARE
from fenics_contact.results.records.contacts import SlipLimitRecord, StepContact
from fenics_contact.results.records.steps import Largest, LoadRecord, StepRecord
from fenics_contact.results.result import Check
from fenics_contact.simulation.description import regularisation_of
from fenics_contact.simulation.output.functions import Fields, fields_of
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.linear_range import LinearRange, linear_range
from fenics_contact.trust.run_checks import made, run_checks

# Steps of a motion that are many, of which strains are looked at in every fourth.
_MANY, _SELDOM = 100, 4

_Forces = TypeVar("_Forces", bound=InternalForces)


class StepHistory(Generic[_Forces]):
    """The load steps that were accepted.

    Args:
        problem: The model.
        timings: To which what it takes is counted.
        forces_of: What the bulk needs in a solution, in whose state all is; collective.

    Attributes:
        steps: What came out of each.
        energy_balance: Work and energies along them.
        momenta: Impulses along them, where bodies move.
        solution: Nodal values of this rank of the last one, None before there is one.
        forces: Nodal forces that the bulk needs there.
        by_contact: Quantities of each contact there.
        supports: Each support there.
        preloads: Each preload there, by its name.
        notes: Sentences on what could not be found of a load step beside its answer.
    """

    def __init__(
        self, problem: Problem, timings: Timings, forces_of: Callable[[Solution], _Forces]
    ) -> None:
        self._problem, self._timings, self._forces_of = problem, timings, forces_of
        self.steps: list[StepRecord] = []
        self.notes: list[str] = []
        self.solution: Solution | None = None
        self._fields: tuple[Solution, Fields] | None = None

    @property
    def fields(self) -> Fields:
        """The last load step as functions of dolfinx, made when first asked for; collective.

        Raises:
            InputError: There is none yet.
        """
        if self.solution is None:
            raise InputError("fields: there are none before a load step is solved; call solve()")
        if self._fields is None or self._fields[0] is not self.solution:
            self._fields = self.solution, fields_of(self._problem, self.solution)
        return self._fields[1]

    def begin(self, steps: Sequence[StepRecord]) -> None:
        """Forget all, but steps of an earlier run to go on from."""
        self.steps, self.notes = list(steps), []
        self.energy_balance = EnergyBalance(self._problem)
        self.momenta = MomentumBalance(self._problem)
        self.solution = None

    @property
    def sums(self) -> list[float]:
        """Sums of energies and momenta so far, for ``resume``."""
        moves = self._problem.inertia.moves
        return [*self.energy_balance.sums, *(self.momenta.sums if moves else [])]

    def resume(self, solution: Solution, sums: Sequence[float]) -> None:
        """Take over the last step of an earlier run; collective.

        Args:
            solution: Of that step.
            sums: Those of its balances.
        """
        self._measure(solution)
        of_energies = len(self.energy_balance.sums)
        self.energy_balance.resume(sums[:of_energies], self.forces)
        if self._problem.inertia.moves:
            self.momenta.resume(sums[of_energies:], self.by_contact)

    def add(self, time: float, solution: Solution) -> None:
        """Keep what came out of a load step, before slip is counted anew; collective.

        Args:
            time: Its pseudo-time.
            solution: Of the step.
        """
        quantities = self._measure(solution)
        if isinstance(self.forces, MovingForces):
            quantities |= self.forces.quantities()
            quantities |= self.momenta.count(self.forces, self.by_contact)
        quantities |= self._work_along(quantities)
        if solution.cycle is not None:
            self._end_cycle(quantities)
        with self._timings.phase("output"):
            sizes = self._sizes(solution) if self._looks_inside else {}
        self.steps.append(
            StepRecord(
                load_factor=time,
                newton_iterations=solution.newton_iterations,
                outer_iterations=solution.outer_iterations,
                outer_contraction=solution.contraction,
                attempts=list(solution.attempts),
                residual_history=list(solution.residual_history),
                imbalance_limit=solution.imbalance_limit,
                quantities=quantities,
                contacts=[
                    StepContact(
                        name=contact.label,
                        regularisation_parameter=regularisation_of(contact),
                        quantities=found,
                    )
                    for contact, found in zip(self._problem.contacts, self.by_contact, strict=True)
                ],
                supports=self.supports,
                preloads=self.scalars,
                loads=self._loads(),
                linear_range={what: Largest(**row) for what, row in sizes.items()},
                cycle=solution.cycle,
                unstable_motions=solution.unstable_motions or None,
            )
        )

    def _sizes(self, solution: Solution) -> dict[str, dict[str, Any]]:
        """Return the sizes that linear theory takes to be small; collective."""
        missing = "The range of linear theory was not checked"
        found: dict[str, dict[str, Any]] = {}

        def find() -> dict[str, dict[str, Any]]:
            return self._linear_range.of(solution)

        return attempt(self._problem.comm, missing, find, found, self.notes)

    @property
    def _looks_inside(self) -> bool:
        """Whether strains of the next step are looked at, which takes a quarter of its time."""
        motion, number = self._problem.scene.motion, len(self.steps) + 1
        if not self._problem.elastic.is_linear:  # strains need not be small
            return False
        if motion is None or not self.forces.tells_inside:
            return self.forces.tells_inside
        every = _SELDOM if motion.steps.number >= _MANY else 1
        return number % every == 0 or number == motion.steps.number

    def pass_by(self, time: float, solution: Solution) -> None:
        """Take in a load step whose quantities are not asked for; collective.

        Its work counts, and how far bodies slid in it: what is said of the last step goes by these.

        Args:
            time: Its pseudo-time.
            solution: Of the step.
        """
        self.solution = solution
        with self._timings.phase("output"):
            self.forces = self._forces_of(solution)
        self._count()
        self.steps.append(
            StepRecord(
                load_factor=time,
                newton_iterations=solution.newton_iterations,
                outer_iterations=solution.outer_iterations,
                quantities={},
                contacts=[
                    StepContact(
                        name=contact.label,
                        regularisation_parameter=regularisation_of(contact),
                        quantities=slid(contact),
                    )
                    for contact in self._problem.contacts
                ],
            )
        )

    def _loads(self) -> list[LoadRecord]:
        """Return the records of given loads, in a history of several load steps; collective."""
        if not self._problem.scene.load_steps.several:
            return []
        return load_records(self._problem, self.forces.displacement)

    def _work_along(self, quantities: dict[str, Any]) -> dict[str, Any]:
        """Work since the start, at the end of a load step; collective.

        Args:
            quantities: The other ones there.
        """
        self._count()
        return dict(self.energy_balance.quantities(quantities))

    def _count(self) -> None:
        """The work of the step whose forces these are; collective."""
        if self._problem.scene.load_steps.several:  # else there is no path to count along
            self.energy_balance.count(self.forces)

    def _end_cycle(self, quantities: dict[str, Any]) -> None:
        """Have the energy balance compare a cycle that ends with the one before.

        Args:
            quantities: At its end.
        """
        self.energy_balance.end_cycle(quantities)

    def checks(self) -> dict[str, Check]:
        """Return the checks of the last load step; collective."""
        with self._timings.phase("output"):
            checks = run_checks(self.forces, len(self.steps))
            for name, check in self._checks_of_path().items():
                found = made(self._problem.comm, check)
                checks |= {} if found is None else {name: found}
        return checks

    def _checks_of_path(self) -> dict[str, Callable[[], Check | None]]:
        """Return functions for the checks that need all load steps; collective."""
        last = self.steps[-1]
        checks: dict[str, Callable[[], Check | None]] = {}
        if not self.forces.rests:
            checks |= {"momentum_balance": self.momenta.check}
        checks |= {"energy_balance": partial(self.energy_balance.check, last.quantities)}
        if last.cycle is not None and last.cycle.is_closed:
            checks |= {"cycle_loss": self.energy_balance.check_cycle}
        checks |= {"linear_range": partial(linear_range, self.steps)}
        return checks

    def _measure(self, solution: Solution) -> dict[str, Any]:
        """Forces and quantities of a load step; collective."""
        self.solution = solution
        with self._timings.phase("output"):
            self.forces = self._forces_of(solution)
            self.supports = support_records(self.forces)
            self.scalars = scalar_records(self._problem, solution)
            self.by_contact = [
                self._of_contact(solution, number) | self._slip_share(solution, number)
                for number in range(len(self._problem.contacts))
            ]
            found = global_quantities(self.forces, self.by_contact)
            found |= stretch_quantities(self.forces)
            found |= stress_at_points(self._problem, solution)
            return found if self._temperatures is None else found | self._temperatures.quantities()

    @cached_property
    def _temperatures(self) -> ModelTemperatures | None:
        """Temperatures of the model, where the scene gives such; collective when first asked."""
        return ModelTemperatures(self._problem) if self._problem.scene.has_temperatures else None

    def _of_contact(self, solution: Solution, number: int) -> dict[str, Any]:
        """Quantities of a contact, by its number in scene order; collective."""
        return contact_quantities(self._problem, solution, number)

    def slip_limit(self) -> SlipLimitRecord | None:
        """How near parts are to slipping in the last load step, where any may; collective."""
        assert self.solution is not None
        with self._timings.phase("output"):
            found = slip_shares(self._problem, self.solution.states) if self.forces.rests else None
            largest = None if found is None else found.largest()
            if found is None or largest is None:
                return None
            return SlipLimitRecord(parts=found.of_parts(), motion=largest.motion)

    def _slip_share(self, solution: Solution, number: int) -> dict[str, Any]:
        """Return the share of its friction that a contact uses, if it has any; collective."""
        contact = self._problem.contacts[number]
        if not contact.friction.has_friction or not self._problem.elastic.is_linear:
            return {}
        return {SLIP_SHARE: share_of_contact(contact, solution.states[number])}

    @cached_property
    def _linear_range(self) -> LinearRange:
        """Strains and rotations of its load steps; collective, where it is first asked for."""
        return LinearRange(self._problem)
