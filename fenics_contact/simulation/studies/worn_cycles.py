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

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest
from fenics_contact.common.timings import Timings
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.quantities import contact_points, contact_quantities
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import Steps
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.worn_cycle import Jumps, WornCycle
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.step_control import FixedPace
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.linear_theory.worn_width import worn_share

logger = logging.getLogger(__name__)

# Of a cycle: so much before its begin stands the step after which what was worn is in the gap.
_SETTLING = 1e-6
# Jumps grow at most by this from one to the next, and shrink at most to the other.
_GROWTH, _SHRINKING = 3.0, 0.2
# Of what is allowed, at which jumps aim, and beyond which they are taken again.
_AIM, _TOO_FAR = 0.8, 1.25
# Of so many jumps each may have its part of the error, where there is hardly any wear left.
_MANY = 50


@dataclass(frozen=True, eq=False)
class _Rates:
    """What a cycle wears.

    Attributes:
        number: Of the cycle.
        begin: Depths at which it begins, of each contact (length).
        depths: What it adds, likewise.
        work: Of friction in it (energy).
        solution: At its end, with the depths then.
        end: Its last load step, to go on from.
    """

    number: int
    begin: list[Array]
    depths: list[Array]
    work: float
    solution: Solution
    end: AcceptedStep

    @property
    def pressures(self) -> list[Array]:
        """At its end (stress)."""
        return [state.contact_pressure for state in self.solution.states]


class WornCycles:
    """The cycles of a scene whose contacts wear; collective, as all its methods.

    Attributes:
        computed: How many cycles were computed, those of jumps that were refused among them.

    Args:
        kept: The body.
        scene: Its load steps are those to the begin of a cycle, and those of one cycle.
        begin: Pseudo-time at which the cycle begins, at which loads are as at its end.
        jumps: How far cycles are passed over.

    Raises:
        InputError: No contact wears, or the cycle is none.
    """

    def __init__(self, kept: KeptBody, scene: Scene, begin: float, jumps: Jumps) -> None:
        times = np.array(scene.steps.all_times)
        self._close = _SETTLING * (times[-1] - begin)
        inside = times[times > begin + self._close]
        ends = np.abs(times - begin) <= self._close
        if scene.steps.automatic or not ends.any() or len(inside) == 0:
            raise InputError(
                f"begin = {begin:g}: a cycle begins at the end of a load step and has others to "
                "its own end, the last of all, none of them automatic"
            )
        timings = Timings()
        self._problem = Problem(scene, kept.discrete, timings, by_points=True)
        self._contacts, self._comm = self._problem.contacts, self._problem.comm
        if not any(contact.wear.wears for contact in self._contacts):
            raise InputError("contact.wear is missing: nothing changes from cycle to cycle")
        require_equilibrium(self._problem)
        self._system = CondensedSystem(
            self._problem, timings, kept.condense(self._problem, timings)
        )
        self._load_steps = LoadSteps(Newton(self._problem, self._system, timings), self._add)
        self._load_steps.finds_body = False
        self._begin, self._jumps = begin, jumps
        self._times = Steps(times=(begin, *inside.tolist()))
        self.computed = 0
        self._settled: tuple[list[Array], float] = ([], 0.0)

    def close(self) -> None:
        """Free the system; the body is kept."""
        self._system.destroy()

    def run(self, cycles: int) -> Iterator[WornCycle]:
        """Each cycle that is computed and counts, the last one among them.

        Args:
            cycles: How many there are.

        Raises:
            NotConvergedError: A load step of a cycle.
        """
        rates = self._first()
        errors = dict.fromkeys(("worn_volume", "max_wear_depth"), 0.0)
        number, before, size = 1, self._settled[1], self._jumps.fixed or 1
        earlier = rates
        yield self._cycle(1, 0, 0.0, errors, before, rates)
        while number < cycles:
            ahead = min(size, cycles - number)
            found = self._ahead(earlier, rates, ahead)
            size = self._next_size(found, ahead)
            if self._jumps.fixed is None and ahead > 1 and found.excess > _TOO_FAR:
                logger.info("cycle %d: %d cycles ahead is too far", number, ahead)
                continue
            before += ahead * rates.work + 0.5 * (ahead - 1) * (found.guessed.work - rates.work)
            number, earlier, rates = number + ahead, rates, found.rates
            errors = {name: errors[name] + more for name, more in found.errors.items()}
            yield self._cycle(number, ahead - 1, found.pressure_change, errors, before, rates)

    def _first(self) -> _Rates:
        """The way to the first cycle, and that cycle."""
        solution = self._load_steps.solve()
        self.computed = 1
        begin, rates, work = self._since_begin(solution)
        assert self._load_steps.last is not None
        return _Rates(1, begin, rates, work, solution, self._load_steps.last)

    def _rates(self, number: int, end: AcceptedStep, begin: list[Array]) -> _Rates:
        """Of a cycle that begins at some depths.

        Args:
            number: Of the cycle.
            end: Last load step of the cycle that friction remembers.
            begin: The depths, of each contact (length).
        """
        load_steps = self._load_steps
        load_steps.go_on_from(end, self._begin - self._close, begin)
        load_steps.pace = FixedPace(self._times)
        solution = load_steps.solve()
        self.computed += 1
        _, rates, work = self._since_begin(solution)
        states = [
            _with_depth(state, depth + rate) if contact.wear.wears else state
            for contact, state, depth, rate in zip(
                self._contacts, solution.states, begin, rates, strict=True
            )
        ]
        assert load_steps.last is not None
        at_end = dataclasses.replace(solution, states=states)
        return _Rates(number, begin, rates, work, at_end, load_steps.last)

    def _add(self, time: float, solution: Solution) -> None:
        """A load step is accepted: what comes before a cycle is of none.

        That is the way to the first one, and the slip by which what was worn takes effect.
        """
        if abs(time - self._begin) <= self._close:
            self._settled = self._worn(solution)

    def _since_begin(self, solution: Solution) -> tuple[list[Array], list[Array], float]:
        """Depths at the begin of a cycle, and what it adds to them and to the work of friction."""
        depths, work = self._worn(solution)
        begin, worked = self._settled
        return begin, [now - then for now, then in zip(depths, begin, strict=True)], work - worked

    def _worn(self, solution: Solution) -> tuple[list[Array], float]:
        """Depths of each contact at the end of a step (length), and work of friction (energy)."""
        pairs = list(zip(self._contacts, solution.states, strict=True))
        depths = [
            state.own["worn_depth"] if contact.wear.wears else np.zeros(len(state.gap))
            for contact, state in pairs
        ]
        return depths, sum(contact.work.of_friction(state) for contact, state in pairs)

    def _ahead(self, earlier: _Rates, rates: _Rates, ahead: int) -> _Ahead:
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
        self, earlier: _Rates, rates: _Rates, guessed: _Rates, found: _Rates
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
            "worn_volume": sum(float(one.trace.integral(depth)) for one, depth in pairs),
            "max_wear_depth": max(largest(self._comm, depth) for depth in depths),
        }

    def _next_size(self, found: _Ahead, ahead: int) -> int:
        """How many cycles further on the next one that is computed is thought to be."""
        if self._jumps.fixed is not None:
            return self._jumps.fixed
        factor = _AIM / found.excess if found.excess > 0 else _GROWTH
        return max(1, int(ahead * min(max(factor, _SHRINKING), _GROWTH)))

    def _cycle(
        self,
        number: int,
        passed_over: int,
        change: float,
        errors: dict[str, float],
        before: float,
        rates: _Rates,
    ) -> WornCycle:
        contacts = []
        for place in range(len(self._contacts)):
            found = contact_quantities(self._problem, rates.solution, place)
            del found["friction_work"]  # of the cycles that were computed
            contacts.append(found)
        points = contact_points(self._problem, rates.solution)
        work = before + rates.work
        pairs = zip(self._contacts, rates.solution.states, strict=True)
        slope = max(worn_share(contact, state) for contact, state in pairs)
        return WornCycle(number, passed_over, change, errors, work, slope, contacts, points)


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

    guessed: _Rates
    rates: _Rates
    pressure_change: float
    errors: dict[str, float]
    excess: float


def _with_depth(state: ContactState, depth: Array) -> ContactState:
    return dataclasses.replace(state, own={**state.own, "worn_depth": depth})
