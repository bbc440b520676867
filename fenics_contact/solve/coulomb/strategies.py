"""The solve of a load step: slack that scalars take up, and strategies for Coulomb friction.

Strategies for Coulomb friction have an order, and one may fail: `campos` is the
paper's loop and `lagged` its variant (``alternating_loop``); `monolithic` is Newton's method on
the whole, `continuation` the same with the coefficient brought up in steps (``monolithic``).
`auto` tries one after the other, and where the first one fails, a solve at the points of small
contacts before the rest (``at_points``).

The body's scalars under forces are brought to bear before their equations are solved. Where
nothing touches yet, a bolt that is tightened to a force is a mechanism: no value of its scalar,
its shortening, finds a force to balance, and the tangent is singular. So scalars are held and
increased first, until the body pushes back. A value that would give the force between fixed ends
is never too much; where nothing pushes back it is doubled. Meanwhile contacts are glued where only
friction is to hold a body: it would drift off before there is friction.
"""

from __future__ import annotations

import dataclasses
import logging

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.coulomb.alternating_loop import AlternatingLoop, LaggedLoop, StalledError
from fenics_contact.solve.coulomb.at_points import solve_at_points, solver_at_points
from fenics_contact.solve.coulomb.monolithic import GrowsError, continuation, fit_scale, monolithic
from fenics_contact.solve.coulomb.without_friction import glued_where_it_slides
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

_LOOPS: dict[str, type[AlternatingLoop]] = {"campos": AlternatingLoop, "lagged": LaggedLoop}
# Change of the pressure, over its peak, from which Newton's method is to take over from the loop
# that `auto` runs.
_NEAR = 0.1

_POINTS = "points"
_WORDS = {
    "campos": "the paper's alternation of friction and contact, accelerated",
    "lagged": "contact and friction with the bound of the last pass, accelerated",
    "monolithic": "Newton's method on contact and friction together",
    "continuation": "Newton's method on contact and friction, the coefficient brought up or down "
    "in steps",
    _POINTS: "contact and friction solved at the points, and confirmed on the bodies",
}

_OF_BODIES = tuple(way for way in _WORDS if way != _POINTS)

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
    if newton.nested is not None:
        return newton.solve_nested(newton.nested)
    if newton.exact is not None:
        return newton.solve_exactly(newton.exact)
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
        self.at_points: ExactSolver | None = None
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
                self._restart()
                self._go(way, of_growth=strategy == "auto" and number == 0)
                fit_scale(self.newton)
                return dataclasses.replace(
                    self.newton.solution(self.passes, _WORDS[way]),
                    contraction=self.contraction,
                    attempts=tuple(attempts),
                )
            except (StalledError, NotConvergedError) as error:
                attempts.append(f"{_WORDS[way]}: {error}")
                if strategy == "auto" and number == 0 and not self.newton.closes_by_turns:
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
        order = sorted(_OF_BODIES, key=lambda way: way != first)
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
        self.at_points = solver_at_points(self.newton)
        at_once = [_POINTS] if self.at_points is not None else []
        if not grows:
            return at_once + self._order(first)[1:]
        self.near = self.problem.scene.solver.outer_tolerance
        return at_once + self._order("lagged")

    def _restart(self) -> None:
        """Whatever a way that failed has left behind."""
        for contact in self.problem.coulomb:
            contact.normal_term.follow_law()
            contact.friction_term.use_share(1.0)
        self.newton.restore(self.start)

    def _go(self, way: str, of_growth: bool) -> None:
        if way == _POINTS:
            assert self.at_points is not None
            solve_at_points(self.newton, self.at_points)
            return
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


# Of the force asked for, from which something pushes back.
_BEARS = 1e-3
# Imbalance over the forces where it is only asked whether something does.
_ROUGHLY = 0.1
# Solves with held scalars; each at least doubles the steps of those that are still loose.
_MOST = 30
# Of what releases a scalar between fixed ends, to see how the others follow.
_TRIED = 0.1
# Of the largest force on a scalar so far, below which it has none.
_NONE = 1e-9


def take_up_slack(newton: Newton, last: Solution | None) -> None:
    """Take up the slack of scalars that had no force in the last load step; collective.

    One that is asked for no force, and has none, stays where it is.

    Args:
        newton: At the beginning of a load step.
        last: Of the load step before, if there was one.
    """
    problem, system = newton.problem, newton.system
    scalars = problem.body_scalars
    before = [0.0] * len(scalars) if last is None else [state.force for state in last.scalars]
    largest = max([system.earlier_forces, *(abs(one.force) for one in scalars)], default=0.0)
    for one in scalars:
        one.keep(None)
    free = [n for n, one in enumerate(scalars) if one.has_slack and not one.is_locked]
    had_none = {number for number in free if abs(before[number]) <= _NONE * largest}
    idle = {number for number in free if scalars[number].force == 0}
    if newton.exact is not None:  # it needs no start where something bears
        had_none = idle = had_none & idle
    present = problem.of_body_scalars(system.scalar_values(system.state))
    for number in had_none | idle:
        scalars[number].keep(float(present[number]))
    start = newton.save()
    for chosen, way in ((sorted(had_none - idle), _take_up), (sorted(idle - had_none), _release)):
        if not chosen:
            continue
        try:
            way(newton, chosen)
        except NotConvergedError as error:
            logger.debug("  taking up the slack: %s", error)
            newton.restore(start)
            for number in chosen:
                scalars[number].keep(None)
    for number in had_none - idle:
        scalars[number].keep(None)


def release_held(newton: Newton, found: Solution) -> bool:
    """Have the equation of a scalar solved that was held for no force, and has one.

    Returns:
        Whether there is one.
    """
    pairs = zip(newton.problem.body_scalars, found.scalars, strict=True)
    kept = [pair for pair in pairs if pair[0].held is not None and not pair[0].is_locked]
    if not kept:  # nothing to ask the body for
        return False
    limit = max(found.imbalance_limit, found.bulk_round_off)
    again = False
    for scalar, state in kept:
        if abs(state.force - scalar.force) > limit:
            scalar.keep(None)
            again = True
    return again


def _take_up(newton: Newton, numbers: list[int]) -> None:
    """Increase scalars until something pushes back; collective."""
    chosen = [newton.problem.body_scalars[number] for number in numbers]
    asked = np.array([one.force for one in chosen])
    steps = asked / [one.forces_on_body.stiffness for one in chosen]
    with glued_where_it_slides(newton.problem) as is_glued:
        for _ in range(_MOST):
            bears = _forces_after(newton, numbers, steps, is_glued) / asked >= _BEARS
            if bears.all():
                return
            steps = np.where(bears, 0.0, 2 * steps)


def _release(newton: Newton, numbers: list[int]) -> None:
    """Reduce scalars until no force is left, by secants; collective.

    Those of one joint unload each other: too long a step of one bolt would leave gaps where the
    parts are to touch.

    Raises:
        NotConvergedError: It does not come to that.
    """
    chosen = [newton.problem.body_scalars[number] for number in numbers]
    steps = np.zeros(len(chosen))
    forces = _forces_after(newton, numbers, steps)
    largest = np.abs(forces).max()
    stiffness = np.diag([one.forces_on_body.stiffness for one in chosen])
    if len(chosen) > 1 and largest > 0:
        forces, stiffness = _stiffnesses(newton, numbers, forces, np.diag(stiffness))
    for _ in range(_MOST):
        if np.abs(forces).max() <= newton.problem.scene.solver.tolerance * largest:
            return
        steps = np.linalg.solve(stiffness, -forces)
        before, forces = forces, _forces_after(newton, numbers, steps)
        if not steps.any():
            continue
        missed = forces - before - stiffness @ steps  # C. G. Broyden, 1965
        better = stiffness + np.outer(missed, steps) / (steps @ steps)
        if np.linalg.eigvalsh(better + better.T).min() > 0:
            stiffness = better
    raise NotConvergedError("a preload is not released")


def _stiffnesses(
    newton: Newton, numbers: list[int], forces: Array, own: Array
) -> tuple[Array, Array]:
    """Forces after a small release of each scalar in turn, and their slopes; collective.

    Args:
        newton: With these scalars held.
        numbers: Numbers of the scalars.
        forces: That they have.
        own: Stiffness of each between fixed ends (force/length).
    """
    columns = []
    for place in range(len(numbers)):
        steps = np.zeros(len(numbers))
        steps[place] = -_TRIED * (forces[place] or np.abs(forces).max()) / own[place]
        before, forces = forces, _forces_after(newton, numbers, steps)
        columns.append((forces - before) / steps[place])
    found = np.array(columns).T
    is_stable = np.linalg.eigvalsh(found + found.T).min() > 0
    return forces, found if is_stable else np.diag(own)


def _forces_after(
    newton: Newton, numbers: list[int], steps: Array, is_glued: bool = False
) -> Array:
    """Forces on held scalars after steps of their values, roughly under glue; collective."""
    for number, step in zip(numbers, steps, strict=True):
        scalar = newton.problem.body_scalars[number]
        scalar.keep((scalar.held or 0.0) + float(step))
    newton.system.follow_supports()
    newton.run(tolerance=_ROUGHLY if is_glued else None, is_held=is_glued)
    return newton.system.scalar_forces[numbers]
