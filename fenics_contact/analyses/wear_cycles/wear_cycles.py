"""Wear over many cycles of loads: some of them computed, the others passed over by their rates.

A cycle takes worn depths h to h + R(h). Over n cycles this is summed as by the trapezoidal rule,
n R₀ + (n − 1)/2 (R* − R₀), with the rate R* at h + n R₀: Heun's method, of second order, and exact
where n is 1. Its error is estimated by what the rate at the depth reached differs from R* by, and
by how the rates of three cycles bend.
"""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fenics_contact.analyses.wear_cycles.rates import Progress, Rates, Sticking
from fenics_contact.analyses.wear_cycles.table import CycleJump
from fenics_contact.analyses.wear_cycles.wear_cycle import SETTLING, WearCycle
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.quantities import contact_points
from fenics_contact.quantities.names import FRICTION_WORK, MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.scene.settings import Steps
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.linear_range import worn_share

logger = logging.getLogger(__name__)

# Jumps grow at most by this from one to the next, and shrink at most to the other.
_GROWTH, _SHRINKING = 3.0, 0.2
# Of what is allowed, at which jumps aim, and beyond which they are taken again.
_AIM, _TOO_FAR = 0.8, 1.25
# Of so many jumps each may have its part of the error, where there is hardly any wear left.
_MANY = 50


class WearCycles(StepListener):
    """The cycles of a scene whose contacts wear; collective, as all its methods.

    Attributes:
        computed: How many cycles were computed, those of jumps that were refused among them.
        progress: How far they are, after each cycle that counts; None before there is one.

    Args:
        load_steps: Those to the begin of a cycle, and those of one cycle; nothing is taken yet.
        begin: Pseudo-time at which the cycle begins, at which loads are as at its end.
        jumps: How far cycles are passed over.
        progress: Of cycles of an earlier run that these go on from.
    """

    def __init__(
        self,
        load_steps: LoadSteps,
        begin: float,
        jumps: CycleJump,
        progress: Progress | None = None,
    ) -> None:
        self._load_steps, self._problem = load_steps, load_steps.problem
        self._contacts, self._comm = self._problem.contacts, self._problem.comm
        times = np.array(self._problem.scene.steps.all_times)
        self._period = float(times[-1] - begin)
        self._close = SETTLING * self._period
        self._begin, self._jumps = begin, jumps
        inside = times[times > begin + self._close]
        self._times = Steps(times=(begin, *inside.tolist()))
        self.computed = 0
        self.progress = progress
        self._sticking = Sticking(self._contacts)
        self._settled = self._worn(None)

    def run(self, cycles: int) -> Iterator[WearCycle]:
        """Each cycle that is computed and counts, the last one among them.

        Raises:
            NotConvergedError: A load step of a cycle; all is as at the end of the last one that
                counts, if there is one.
            StoppedError: Likewise.
        """
        if self.progress is None:
            rates = self._first()
            yield self._counts(Progress.first(rates, self._settled[1]))
        assert self.progress is not None
        while (now := self.progress).rates.number < cycles:
            number = now.rates.number
            ahead = min(self._jumps.fixed or now.size, cycles - number)
            try:
                found = self._ahead(now.earlier, now.rates, ahead)
            except (NotConvergedError, StoppedError):
                self._back_to(now.rates.end, number + ahead)
                raise
            size = self._next_size(found, ahead)
            if self._jumps.fixed is None and ahead > 1 and found.excess > _TOO_FAR:
                logger.info("cycle %d: %d cycles ahead is too far", number, ahead)
                self.progress = dataclasses.replace(now, size=size)
                continue
            works = now.rates.works
            passed = ahead * works + 0.5 * (ahead - 1) * (found.guessed.works - works)
            yield self._counts(
                Progress(
                    earlier=now.rates,
                    rates=found.rates,
                    before=now.before + passed,
                    size=size,
                    passed_over=ahead - 1,
                    pressure_change=found.pressure_change,
                    errors={name: now.errors[name] + more for name, more in found.errors.items()},
                )
            )

    def _counts(self, progress: Progress) -> WearCycle:
        """A cycle that counts."""
        self.progress = progress
        return self._cycle(progress)

    def _back_to(self, end: AcceptedStep, number: int) -> None:
        """To the end of the last cycle that counts, from a later one; collective."""
        self._load_steps.count_tried_from((number - 1) * self._period)
        self._load_steps.go_back_to(end)

    def _first(self) -> Rates:
        """The way to the first cycle, and that cycle."""
        solution = self._load_steps.solve(self)
        self.computed = 1
        return self._rates_of(1, solution)

    def _rates(self, number: int, end: AcceptedStep, begin: list[Array]) -> Rates:
        """Return the wear of a cycle that begins at given depths.

        Args:
            number: Of the cycle.
            end: Last load step of the cycle that friction remembers.
            begin: The depths, of each contact (length).
        """
        load_steps = self._load_steps
        load_steps.go_on_from(end, self._begin - self._close, begin, self._times)
        solution = load_steps.solve(self)
        self.computed += 1
        return self._rates_of(number, solution, begin)

    def _rates_of(self, number: int, solution: Solution, begin: list[Array] | None = None) -> Rates:
        """Return the wear of the cycle that was just solved.

        Args:
            number: Of the cycle.
            solution: Of its last load step.
            begin: Depths at which it begins; by default those that it had then (length).
        """
        depths, works = self._worn(solution)
        settled, worked = self._settled
        worn = [now - then for now, then in zip(depths, settled, strict=True)]
        end = self._load_steps.last
        assert end is not None
        return Rates(
            number=number,
            begin=settled if begin is None else begin,
            depths=worn,
            works=works - worked,
            stick_areas=self._sticking.areas(),
            solution=solution,
            end=end,
        )

    def accepted(self, step: AcceptedStep) -> None:
        """Follow a load step; what comes before a cycle is of none; collective.

        That is the way to the first one, and the slip by which what was worn takes effect.
        """
        if abs(step.time - self._begin) <= self._close:
            self._settled = self._worn(step.solution)
            self._sticking = Sticking(self._contacts)
        elif step.time > self._begin:
            self._sticking.follow(step.solution)

    def _worn(self, solution: Solution | None) -> tuple[list[Array], Array]:
        """Depths of each contact at the end of a step (length), and its work of friction (energy).

        Args:
            solution: Of the step; None before any.
        """
        if solution is None:
            none = [np.zeros(len(contact.trace.weights)) for contact in self._contacts]
            return none, np.zeros(len(self._contacts))
        pairs = list(zip(self._contacts, solution.states, strict=True))
        depths = [
            state.own["worn_depth"] if contact.wear.wears else np.zeros(len(state.gap))
            for contact, state in pairs
        ]
        return depths, np.array([contact.work.of_friction(state) for contact, state in pairs])

    def _ahead(self, earlier: Rates, rates: Rates, ahead: int) -> _Ahead:
        """A cycle further on.

        Args:
            earlier: Of the one computed before the last, or of the last.
            rates: Of the last one computed.
            ahead: How many cycles further on.
        """
        guess = [h + ahead * r for h, r in zip(rates.begin, rates.depths, strict=True)]
        number = rates.number + ahead
        guessed = found = self._rates(number, rates.end, guess)
        changes = [
            largest(self._comm, np.abs(new - old))
            for new, old in zip(guessed.pressures, rates.pressures, strict=True)
        ]
        pressure = max(largest(self._comm, old) for old in rates.pressures)
        change = max(changes) / pressure if pressure > 0 else 0.0
        if ahead > 1 and (self._jumps.fixed or change <= _TOO_FAR * self._jumps.pressure_change):
            # Friction has settled in the cycle before, so that its loop is about closed.
            both = zip(guess, rates.depths, guessed.depths, strict=True)
            found = self._rates(
                number, guessed.end, [h + 0.5 * (ahead - 1) * (new - old) for h, old, new in both]
            )
        errors = self._errors(earlier, rates, guessed, found)
        in_cycle, so_far = self._sizes(rates.depths), self._sizes(found.begin)
        wrong = 0.0
        for name, error in errors.items():
            allowed = self._jumps.error * max(ahead * in_cycle[name], so_far[name] / _MANY)
            wrong = max(wrong, error / allowed if allowed > 0 else 0.0)
        excess = max(change / self._jumps.pressure_change, np.sqrt(wrong))
        return _Ahead(guessed, found, change, errors, float(excess))

    def _errors(
        self, earlier: Rates, rates: Rates, guessed: Rates, found: Rates
    ) -> dict[str, float]:
        """Estimated, of a jump: of the volume, and the largest of the depths."""
        ahead, back = found.number - rates.number, rates.number - earlier.number
        off: list[Array] = []
        of_depths = (one.depths for one in (earlier, rates, guessed, found))
        for before, now, guess, then in zip(*of_depths, strict=True):
            by_guess = 0.5 * (ahead - 1) * np.abs(then - guess)
            bend = np.zeros_like(by_guess)
            if back > 0:
                bend = ((then - now) / ahead - (now - before) / back) / (ahead + back)
            off.append(by_guess + ahead * (ahead**2 - 1) / 6 * np.abs(bend))
        return self._sizes(off)

    def _sizes(self, depths: list[Array]) -> dict[str, float]:
        """Volume of depths of each contact, and the largest of them."""
        pairs = list(zip(self._contacts, depths, strict=True))
        return {
            WORN_VOLUME: sum(float(one.trace.integral(depth)) for one, depth in pairs),
            MAX_WEAR_DEPTH: max(largest(self._comm, depth) for depth in depths),
        }

    def _next_size(self, found: _Ahead, ahead: int) -> int:
        """How many cycles further on the next one that is computed is thought to be."""
        if self._jumps.fixed is not None:
            return self._jumps.fixed
        factor = _AIM / found.excess if found.excess > 0 else _GROWTH
        return max(1, int(ahead * min(max(factor, _SHRINKING), _GROWTH)))

    def _cycle(self, progress: Progress) -> WearCycle:
        rates = progress.rates
        solution = with_depths(self._contacts, rates)
        works = progress.before + rates.works
        contacts = []
        for place in range(len(self._contacts)):
            found = contact_quantities(self._problem, solution, place)
            contacts.append(found | {FRICTION_WORK: float(works[place])})
        pairs = zip(self._contacts, solution.states, strict=True)
        return WearCycle(
            number=rates.number,
            passed_over=progress.passed_over,
            pressure_change=progress.pressure_change,
            errors=progress.errors,
            losses=rates.works.tolist(),
            friction_work=float(works.sum()),
            stick_areas=rates.stick_areas,
            depth_over_width=max(worn_share(contact, state) for contact, state in pairs),
            contacts=contacts,
            points=contact_points(self._problem, solution),
        )


@dataclass(frozen=True, eq=False)
class _Ahead:
    """A cycle some way ahead.

    Attributes:
        guessed: By the rates of the cycle before alone.
        rates: By those of both.
        pressure_change: Largest change of a pressure, over the largest.
        errors: Estimated, of the jump.
        excess: By how much the jump is longer than it should be.
    """

    guessed: Rates
    rates: Rates
    pressure_change: float
    errors: dict[str, float]
    excess: float


def with_depths(contacts: list[ContactSurface], rates: Rates) -> Solution:
    """The end of a cycle with what is worn then, without the slip that none of them has."""
    states = [
        _with_depth(state, depth + more) if contact.wear.wears else state
        for contact, state, depth, more in zip(
            contacts, rates.solution.states, rates.begin, rates.depths, strict=True
        )
    ]
    return dataclasses.replace(rates.solution, states=states)


def _with_depth(state: ContactState, depth: Array) -> ContactState:
    return dataclasses.replace(state, own={**state.own, "worn_depth": depth})
