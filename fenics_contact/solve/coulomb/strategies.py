"""Strategies for Coulomb friction, their order, and what follows when one fails.

`campos` is the paper's loop and `lagged` its variant (``alternating_loop``); `monolithic` is
Newton's method on the whole, `continuation` the same with the coefficient brought up in steps
(``monolithic``). `auto` tries one after the other.
"""

from __future__ import annotations

import dataclasses
import logging

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.coulomb.alternating_loop import (
    AlternatingLoop,
    LaggedLoop,
    StalledError,
)
from fenics_contact.solve.coulomb.monolithic import GrowsError, continuation, fit_scale, monolithic
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution

logger = logging.getLogger(__name__)

_LOOPS: dict[str, type[AlternatingLoop]] = {"campos": AlternatingLoop, "lagged": LaggedLoop}
# Change of the pressure, over its peak, from which Newton's method is to take over from the loop
# that `auto` runs.
_NEAR = 0.1

_WORDS = {
    "campos": "the paper's alternation of friction and contact, accelerated",
    "lagged": "contact and friction with the bound of the last pass, accelerated",
    "monolithic": "Newton's method on contact and friction together",
    "continuation": "Newton's method on contact and friction, the coefficient brought up or down "
    "in steps",
}

_OTHERS = '; solver.strategy = "auto" tries other ways too'


def solve_step(newton: Newton) -> Solution:
    """Solve for the present loads, from the present state; collective."""
    try:
        return _solve_step(newton)
    except NotConvergedError as error:
        if not newton.begin.paired_anew:
            raise
        logger.info("%s; next: from the start, with what faces what now", error)
        newton.begin.anew()
        return _solve_step(newton)


def _solve_step(newton: Newton) -> Solution:
    problem = newton.problem
    if not problem.coulomb:
        _minimise(newton)
        return newton.solution()
    return _Strategies(newton).solve(problem.scene.solver.strategy)


def _minimise(newton: Newton) -> None:
    """The least energy, under pressures that are given or without friction: there is one.

    Full steps are the shortest way with friction, but can go round in circles between points that
    share nodes, as on tetrahedra of degree 2; a search along the steps does not.
    """
    start = newton.save()
    try:
        newton.run()
    except NotConvergedError as error:
        if not newton.problem.frictional:
            raise
        logger.info("%s; next: searching along the steps", error)
        newton.restore(start)
        for contact in newton.problem.frictional:
            contact.friction_term.tangent_state.stick_all()
        newton.run(search_energy=True)


class _Strategies:
    """The ways to bring friction and pressure of all Coulomb contacts together."""

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.passes = 0
        self.contraction: float | None = None
        self.start = newton.save()
        self.near = newton.problem.scene.solver.outer_tolerance

    def solve(self, strategy: str) -> Solution:
        """Solve by one strategy, or by one after the other until one converges."""
        chosen = [strategy]
        if strategy == "auto":
            self.near = _NEAR
            chosen = [self._first_way()]
        attempts: list[str] = []
        for number, way in enumerate(chosen):  # grows where the first way fails
            try:
                self._start_anew()
                self._go(way, of_growth=strategy == "auto" and number == 0)
                fit_scale(self.newton)
                return dataclasses.replace(
                    self.newton.solution(self.passes, _WORDS[way]),
                    contraction=self.contraction,
                    attempts=tuple(attempts),
                )
            except (StalledError, NotConvergedError) as error:
                attempts.append(f"{_WORDS[way]}: {error}")
                if strategy == "auto" and number == 0:
                    chosen += self._next_ways(way, isinstance(error, GrowsError))
                if number + 1 == len(chosen):
                    imbalances = tuple(self.newton.imbalances)
                    words = attempts[-1] + ("" if strategy == "auto" else _OTHERS)
                    raise NotConvergedError(words, imbalances, tuple(attempts)) from None
                logger.info("%s: %s; next: %s", _WORDS[way], error, _WORDS[chosen[number + 1]])
        raise AssertionError("a strategy returns or raises")

    def _first_way(self) -> str:
        """The way that `auto` tries first; collective."""
        # The answer of the last load step is near enough for Newton's method; between two bodies
        # it took fewer steps than the loop in all that was measured.
        if self.newton.begin.continues or self.problem.between_bodies:
            return "monolithic"
        return self._order(self.newton.system.first_way)[0]

    def _order(self, first: str) -> list[str]:
        """The ways that `auto` tries, where possible one of them first; collective."""
        order = sorted(_WORDS, key=lambda way: way != first)
        if RigidMotions(self.problem).count > 0:
            order.remove("campos")
        return order

    def _next_ways(self, first: str, grows: bool) -> list[str]:
        """The ways that `auto` tries where the first one fails; collective.

        Args:
            first: That failed.
            grows: Whether it was given up at once, as its imbalance grew. So it does where points
                stick, however small their pressure. Of their bound nearly nothing depends then:
                that of the last pass serves, to the end, before Newton's method is tried for long.
        """
        if not grows:
            return self._order(first)[1:]
        self.near = self.problem.scene.solver.outer_tolerance
        return self._order("lagged")

    def _start_anew(self) -> None:
        """Whatever a way that failed has left behind."""
        for contact in self.problem.coulomb:
            contact.normal_term.follow_law()
            contact.friction_term.use_share(1.0)
        self.newton.restore(self.start)

    def _go(self, way: str, of_growth: bool) -> None:
        if way == "monolithic":
            monolithic(self.newton, self.start, of_growth)
            return
        if way == "continuation":
            continuation(self.newton, self.start)
            return
        loop = _LOOPS[way](self.newton)
        try:
            loop.run(self.near)
        finally:
            self.passes += loop.passes
            if loop.contraction is not None:
                self.contraction = loop.contraction
