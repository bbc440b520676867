"""The answer of load steps once more with something changed: to see what the change makes of it.

All is there again afterwards, as it was. No matrix of the bulk is factorised anew by the
condensed solver.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import AtEachStep, StepEnd, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.step_tries import Warm
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

# Of the imbalance that a change makes, what may be left of it where it is solved for roughly, and
# over the forces at the most: where gaps change, penalties make much of it.
_ENOUGH, _ROUGHEST = 1e-2, 1e-4

# By name, or by a contact's number and the name.
Quantities = Mapping[Hashable, QuantityValue]
Measure = Callable[[Solution], Quantities]
Change = Callable[[Problem], None]
# A change of which a share is made.
ChangeByShare = Callable[[float, Problem], None]
# Called with an answer, in its state.
Look = Callable[[Solution], None]
# Called with pseudo-time and solution of each load step that is taken again, in its state.
Visit = Callable[[float, Solution], None]


@dataclass(frozen=True)
class Again:
    """A way to an answer with something changed.

    Attributes:
        answer: Quantities without the change.
        displacement: Of that answer at the nodes, (nodes, components) (length).
        changed: Quantities with a change; what is to be called with that answer besides, if
            anything. None where it is not found; collective.
        stands_for: Load steps of the history over those that are taken again: of each of these a
            point creeps anew.
        share: Of a change, what is made of it; what all of it does is in proportion.
        walk: Takes the load steps again without a change; None of the last one alone; collective.
    """

    answer: Quantities
    displacement: Array
    changed: Callable[[Change, Look | None], Quantities | None]
    stands_for: float = 1.0
    share: float = 1.0
    walk: Callable[[Visit], object] | None = None

    @classmethod
    def of_last_step(cls, load_steps: LoadSteps, measure: Measure, roughly: bool = False) -> Again:
        """The last load step alone.

        Args:
            load_steps: At their end.
            measure: As of ``last_step_again``.
            roughly: Likewise.
        """
        answer = measure(_answer(load_steps))
        return cls(
            answer,
            _answer(load_steps).displacement,
            lambda change, look: last_step_again(
                load_steps, seen(measure, look), change, roughly=roughly
            ),
        )

    def effects(
        self, change: ChangeByShare, look: Look | None = None, factor: float = 1.0
    ) -> dict[Hashable, float] | None:
        """How far a change moves quantities, of vectors the length of the difference; collective.

        Args:
            change: Made by the share of it that it is called with.
            look: Is called with the answer, in its state; None for nothing.
            factor: To multiply with.

        Returns:
            By key; None where the answer with the change was not found.
        """
        other = self.changed(partial(change, self.share), look)
        return differences(self.answer, other, factor / self.share)

    @classmethod
    def of_steps(cls, load_steps: LoadSteps, measure: Measure, times: Sequence[float]) -> Again:
        """All load steps from the start.

        Args:
            load_steps: At their end.
            measure: As of ``last_step_again``.
            times: Their pseudo-times.
        """
        answer = measure(_answer(load_steps))
        return cls(
            answer,
            _answer(load_steps).displacement,
            lambda change, look: steps_again(load_steps, seen(measure, look), times, change),
            walk=lambda visit: steps_again(load_steps, measure, times, listener=AtEachStep(visit)),
        )


def seen(measure: Measure, look: Look | None) -> Measure:
    """Measures answers, and shows them besides.

    Args:
        measure: As of ``last_step_again``.
        look: Is called with each answer, in its state; None for nothing.
    """
    if look is None:
        return measure

    def measured(solution: Solution) -> Quantities:
        look(solution)
        return measure(solution)

    return measured


class AlongLine:
    """Answers to several sizes of one change: each begins where those nearest to it lead.

    Args:
        load_steps: At their end, which is size 0.
    """

    def __init__(self, load_steps: LoadSteps) -> None:
        assert load_steps.last is not None
        unknowns, system = load_steps.last.unknowns, load_steps.newton.system
        self._known = [(0.0, unknowns.position_in(system), unknowns.scalars)]
        self._size = 0.0

    def at(self, size: float) -> AlongLine:
        """Return itself, for the size that comes next."""
        self._size = size
        return self

    def begin(self, newton: Newton) -> None:
        """Go to where the two nearest answers lead; collective."""
        nearest = sorted(self._known, key=lambda known: abs(known[0] - self._size))
        (size, position, scalars), *others = nearest
        if others:
            other, *to = others[0]
            share = (self._size - size) / (other - size)
            position = position + share * (to[0] - position)
            scalars = scalars + share * (to[1] - scalars)
        newton.begin.at(position, scalars)

    def note(self, newton: Newton) -> None:
        """Remember the answer that was found; collective."""
        system = newton.system
        found = self._size, system.position(), system.scalar_values(system.state)
        self._known.append(found)


def last_step_again(
    load_steps: LoadSteps,
    measure: Measure,
    change: Change,
    line: AlongLine | None = None,
    roughly: bool = False,
) -> Quantities | None:
    """Solve the last load step again, from its answer; collective.

    Args:
        load_steps: At their end.
        measure: Quantities of a solution, called in its state; collective.
        change: What is to be different, called in the state of the answer.
        line: Answers to other sizes of the change, to begin at.
        roughly: Whether to about a hundredth of what the change does, where another answer costs
            much and each digit of it as much as the one before.

    Returns:
        Quantities; None where neither Newton's method from there nor the strategies of a load step
        converge.
    """
    newton = load_steps.newton
    ways: tuple[tuple[AlongLine | None, Callable[[], Solution]], ...] = (
        (line, lambda: newton_again(load_steps, roughly=roughly)),
        (None, lambda: solve_step(newton)),
    )
    try:
        for near, way in ways:
            begin_at_answer(load_steps)
            change(load_steps.problem)
            if near is not None:
                near.begin(newton)
            newton.begin.from_last_step()
            try:
                found = load_steps.settled(way)
                if line is not None:
                    line.note(newton)
                return measure(found)
            except NotConvergedError as error:
                logger.debug("  solving again: %s", error)
    finally:
        restore(load_steps)
    return None


def steps_again(
    load_steps: LoadSteps,
    measure: Measure,
    times: Sequence[float],
    change: Change | None = None,
    near: Warm | None = None,
    ends: dict[float, StepEnd] | None = None,
    listener: StepListener | None = None,
) -> Quantities | None:
    """Solve all load steps again from the start, each with the ε that it needs; collective.

    Args:
        load_steps: At their end.
        measure: As of ``last_step_again``.
        times: Pseudo-times of the steps, increasing.
        change: As of ``last_step_again``, called in the state of the start.
        near: Solves a step from an answer near by, as of ``LoadSteps.begin_near``.
        ends: Where the ends of the steps are to be kept, if they are.
        listener: Is told of each step; None for nobody.

    Returns:
        Quantities of the last step; None where a step does not converge, or has no loads.
    """
    system = load_steps.newton.system
    earlier, system.earlier_forces = system.earlier_forces, 0.0
    try:
        again = load_steps.afresh(times, near, ends)
        if change is not None:
            change(load_steps.problem)
        return measure(again.solve(*([] if listener is None else [listener])))
    except (NotConvergedError, InputError) as error:  # a load's function may know no other times
        logger.debug("  the load steps again: %s", error)
        return None
    finally:
        system.earlier_forces = earlier
        restore(load_steps)


def begin_at_answer(load_steps: LoadSteps) -> None:
    """Go to the answer, to be solved again from there; collective."""
    load_steps.go_back()
    load_steps.newton.forget()
    load_steps.newton.begin.paired_anew = False


def newton_again(
    load_steps: LoadSteps, tolerance: float | None = None, roughly: bool = False
) -> Solution:
    """Newton's method on contact and friction together, from the present state; collective.

    Args:
        load_steps: Their contacts follow the law.
        tolerance: As of ``Newton.run``.
        roughly: As of ``last_step_again``.

    Raises:
        NotConvergedError: As ``Newton.run``.
    """
    newton, problem = load_steps.newton, load_steps.problem
    if newton.exact is not None:
        return newton.solve_exactly(newton.exact)
    for contact in problem.coulomb:
        contact.friction_term.follow_pressure()
    if roughly and not newton.system.repeats_cheaply:
        tolerance = _rough_tolerance(newton)
    newton.run(False if problem.coulomb else None, tolerance)
    return newton.solution()


def _rough_tolerance(newton: Newton) -> float:
    """Imbalance over the forces that is a share of the present one; collective."""
    system = newton.system
    system.balance(system.state, system.residual)
    wanted = _ENOUGH * system.imbalance() / max(system.forces, np.finfo(float).tiny)
    return max(newton.problem.scene.solver.tolerance, min(wanted, _ROUGHEST))


def differences(
    answer: Quantities, other: Quantities | None, factor: float = 1.0
) -> dict[Hashable, float] | None:
    """How far quantities are apart that both have, of vectors the length of the difference.

    Args:
        answer: By name.
        other: Likewise; None if there are none. What it lacks is left out: a zone may be a disc
            in one answer alone.
        factor: To multiply with.
    """
    if other is None:
        return None
    return {
        name: factor * float(np.linalg.norm(np.subtract(other[name], value)))
        for name, value in answer.items()
        if name in other
    }


def _answer(load_steps: LoadSteps) -> Solution:
    assert load_steps.last is not None
    return load_steps.last.solution


def restore(load_steps: LoadSteps) -> None:
    """Have all as it was in the answer, whatever was changed of it; collective."""
    for contact in load_steps.problem.contacts:
        contact.normal.penalty.soften(1.0)
        contact.friction.regularisation.scale(1.0)
        contact.friction.scale_coefficient(1.0)
    if load_steps.problem.far_field is not None:
        load_steps.problem.far_field.beyond[:] = 0.0
    load_steps.problem.disturbance = None
    if load_steps.problem.conduction is not None:
        load_steps.problem.conduction.disturb(None, load_steps.time)
    load_steps.problem.scalar_disturbance[:] = 0.0
    load_steps.problem.feet.disturbance = []
    load_steps.go_back()
