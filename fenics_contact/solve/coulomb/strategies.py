"""Coulomb friction: the loop on the contact pressure (paper, Section 4.1) and its rescues.

Friction is bounded by the pressure, which is not known. A pass makes from pressures p new
ones: `campos` by the paper's Steps 3 and 4, friction under given pressure, then contact under
given friction; `lagged` with contact and friction at once, bounded by μ p. Anderson's method
accelerates the passes. `monolithic` is Newton's method on the whole, with its non-symmetric
tangent, from the adhesive start.
"""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import all_round_off, carries_more_than
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.coulomb.anderson import Anderson
from fenics_contact.solve.coulomb.convergence import OuterMonitor
from fenics_contact.solve.coulomb.friction_scale import fits, follow_pressure
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.newton.status_cycling import Chatter

logger = logging.getLogger(__name__)

Array = NDArray[np.float64]

# Change of the pressure, over its peak, from which Newton's method is to take over from the loop
# that `auto` runs.
_NEAR = 0.1
# Stiffness of glue along the surface, over E/h: nothing is to have slipped yet.
_GLUE = 1e4
# Of the pressures from which ε follows. Its bias is below .1 %, so an error of it in ε counts
# a thousandth.
_SCALE_TOLERANCE = 1e-6
# Of ε over that which the answer needs, beyond which a step is solved again: its bias stays below
# .1 %, also where steps add up.
_TOO_LARGE = 3.0
# Of the ε that is needed over that which was guessed, beyond which Newton's method is not to go on
# for long: below it takes hardly more steps.
_TOO_SMALL = 100.0
_RESCALINGS = 3
# Shares of the coefficient on the way to all of it: from below or, where only friction holds a
# body, from above, as less of it holds nothing.
_RISING = (0.25, 0.5, 0.75, 1.0)
_FALLING = (4.0, 2.0, 1.4, 1.2, 1.1, 1.05, 1.02, 1.01, 1.005, 1.002, 1.001, 1.0)

_WORDS = {
    "campos": "the paper's alternation of friction and contact, accelerated",
    "lagged": "contact and friction with the bound of the last pass, accelerated",
    "monolithic": "Newton's method on contact and friction together",
    "continuation": "Newton's method on contact and friction, the coefficient brought up or down "
    "in steps",
}


def solve_step(newton: Newton) -> Solution:
    """Solve for the present loads, from the present state; collective."""
    try:
        return _solve_step(newton)
    except NotConvergedError as error:
        if not newton.paired_anew:
            raise
        logger.info("%s; next: from the start, with what faces what now", error)
        newton.start()
        return _solve_step(newton)


def _solve_step(newton: Newton) -> Solution:
    problem = newton.problem
    if not problem.coulomb:
        _minimise(newton)
        return newton.solution()
    loop = _CoulombLoop(newton)
    return loop.solve(problem.scene.solver.strategy)


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
            contact.friction.stick_all()
        newton.run(search_energy=True)


class _StalledError(Exception):
    """The loop on the pressure does not come nearer."""


class _CoulombLoop:
    """Brings friction and pressure of all Coulomb contacts together."""

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.contacts = newton.problem.coulomb
        self.settings = newton.problem.scene.solver
        self.outer = 0
        self.contraction: float | None = None
        self.start = newton.save()

    def solve(self, strategy: str) -> Solution:
        """By one strategy, or by one after the other until one converges."""
        ways: dict[str, Callable[[], None]] = {
            "campos": lambda: self._loop(self._campos_pass),
            "lagged": lambda: self._loop(self._lagged_pass),
            "monolithic": self._monolithic,
            "continuation": self._continuation,
        }
        # The answer of the last load step is near enough for Newton's method; between two bodies
        # it took fewer steps than the loop in all that was measured.
        at_once = self.newton.continues or self.problem.between_bodies
        first = "monolithic" if at_once else self.newton.system.first_way
        chosen = [strategy]
        if strategy == "auto":
            chosen = sorted(ways, key=lambda way: way != first)
        self._near = _NEAR if strategy == "auto" else self.settings.outer_tolerance
        if strategy == "auto" and RigidMotions(self.problem).count > 0:
            chosen.remove("campos")
        attempts: list[str] = []
        for number, way in enumerate(chosen):
            try:
                self._start_anew()
                ways[way]()
                self._fit_scale()
                return dataclasses.replace(
                    self.newton.solution(self.outer, _WORDS[way]),
                    contraction=self.contraction,
                    attempts=tuple(attempts),
                )
            except (_StalledError, NotConvergedError) as error:
                attempts.append(f"{_WORDS[way]}: {error}")
                if number + 1 == len(chosen):
                    history = tuple(self.newton.history)
                    raise NotConvergedError(attempts[-1], history, tuple(attempts)) from None
                logger.info("%s: %s; next: %s", _WORDS[way], error, _WORDS[chosen[number + 1]])
        raise AssertionError("a strategy returns or raises")

    def _start_anew(self) -> None:
        """Whatever a way that failed has left behind."""
        for contact in self.contacts:
            contact.normal.release()
            contact.friction.set_share(1.0)
        self.newton.restore(self.start)

    def _loop(self, one_pass: Callable[[list[Array]], list[Array]]) -> None:
        """Passes from the first pressures until these change no more."""
        pressures = self._first_pressures()
        if self._peak(pressures) == 0 or self._touch_by_round_off:  # nothing rubs
            self._rub_nothing()
            return
        anderson = Anderson(self.problem.comm, [c.trace.owned for c in self.contacts])
        monitor = OuterMonitor(Chatter(self.contacts, self.problem.comm), self.problem.comm)
        near = max(self._near, self.settings.outer_tolerance)
        for _ in range(self.settings.max_outer_iterations):
            found = one_pass(pressures)
            self.outer += 1
            change = monitor.see(pressures, found)
            self.contraction = monitor.contraction
            logger.debug("  pass %d: pressures change by %.2e of the peak", self.outer, change)
            if change <= near:
                if self._finish(found, change):
                    return
                near = self.settings.outer_tolerance
            if monitor.is_stalled:
                raise _StalledError(monitor.words())
            pressures = anderson.next(pressures, found)
        raise _StalledError(
            f"the {self.settings.max_outer_iterations} passes allowed were used up: "
            f"{monitor.words()}"
        )

    def _rub_nothing(self) -> None:
        """What to do where nothing touches; what glue holds then is not held."""
        for contact in self.contacts:
            contact.friction.mode = "law"
            contact.friction.set_bound(np.zeros_like(contact.friction.bound))
        if self._is_glued:
            self.newton.run()
            if self._peak([contact.pressure() for contact in self.contacts]) > 0:
                raise _StalledError("bodies that glue held apart have come together")

    @property
    def _touch_by_round_off(self) -> bool:
        """Whether bodies carry nothing but round-off of a motion along contacts; collective."""
        return all_round_off(self.problem.contacts, self.newton.system.forces)

    def _peak(self, pressures: list[Array]) -> float:
        return max(largest(self.problem.comm, pressure) for pressure in pressures)

    def _first_pressures(self, tolerance: float | None = None) -> list[Array]:
        """The paper's Step 1, without friction; with glue along it where friction has to hold.

        Sets ε to what these pressures need.

        Args:
            tolerance: Of the solve, by default the scene's.
        """
        rigid = RigidMotions(self.problem)
        self._is_glued = rigid.slides_on_coulomb
        before = self.newton.save()
        try:
            self._solve_without_friction(tolerance)
        except NotConvergedError as error:
            if self._is_glued or rigid.count == 0:
                raise
            logger.info("%s; next: with glue, as friction may hold what contact does not", error)
            self.newton.restore(before)
            self._is_glued = True
            self._solve_without_friction(tolerance)
        self._scale()
        for contact in self.contacts:
            contact.friction.stick_all()
        self._sticks = [np.ones(len(c.trace.weights), dtype=bool) for c in self.contacts]
        self._directions = [np.zeros_like(c.trace.normals) for c in self.contacts]
        return [contact.pressure() for contact in self.contacts]

    def _solve_without_friction(self, tolerance: float | None) -> None:
        for contact in self.contacts:
            contact.friction.mode = "off"
            if self._is_glued:
                stiffness = _GLUE * contact.moduli.combined / contact.facet_size
                contact.friction.glue(stiffness, self._to_glue(contact))
        self.newton.run(tolerance=tolerance)

    def _to_glue(self, contact: ContactSurface) -> NDArray[np.bool_]:
        """Points that touch as a solve begins; all, where a support is yet to press any on."""
        pressure = contact.pressure()
        return np.asarray((pressure > 0) | (largest(self.problem.comm, pressure) <= 0))

    def _scale(self) -> None:
        """Set ε to what the present pressures need; collective."""
        for contact in self.contacts:
            follow_pressure(contact, self.newton.limit)

    def _fit_scale(self) -> None:
        """Set ε of contacts for which it is too large, and solve with it; collective.

        They carry much less than in the last step, or only came to touch on the way.
        """
        for _ in range(_RESCALINGS):
            limit = self.newton.limit
            late = [
                contact
                for contact in self.contacts
                if not fits(contact, _TOO_LARGE, np.inf) and carries_more_than(contact, limit)
            ]
            if not late:
                return
            for contact in late:
                follow_pressure(contact, limit)
            if RigidMotions(self.problem).slides_on_coulomb:
                # Nothing but friction takes the creep back, by one ε a step of Newton's method.
                self._first_pressures(_SCALE_TOLERANCE)
            self._solve_coupled()

    def _lagged_pass(self, pressures: list[Array]) -> list[Array]:
        for contact, pressure in zip(self.contacts, pressures, strict=True):
            contact.friction.mode = "law"
            contact.friction.set_bound(contact.friction.bound_of(pressure))
        before = self.newton.save()
        try:
            self.newton.run(search_energy=False)
        except NotConvergedError:  # rarely: full steps are the better ones with friction
            self.newton.restore(before)
            self.newton.run()
        return [contact.pressure() for contact in self.contacts]

    def _campos_pass(self, pressures: list[Array]) -> list[Array]:
        """Step 3 with the status of the last pass, then Step 4."""
        for i, (contact, pressure) in enumerate(zip(self.contacts, pressures, strict=True)):
            contact.normal.hold(pressure)
            bound = contact.friction.bound_of(pressure)
            contact.friction.set_status(self._sticks[i], self._directions[i], bound)
        self.newton.run(search_energy=False)
        for i, (contact, pressure) in enumerate(zip(self.contacts, pressures, strict=True)):
            bound = contact.friction.bound_of(pressure)
            contact.friction.hold(self._next_status(i, bound))
            contact.friction.mode = "held"
            contact.normal.release()
        self.newton.run()
        return [contact.pressure() for contact in self.contacts]

    def _next_status(self, number: int, bound: Array) -> Array:
        """The tractions of Step 3, and the status for the next one, with hysteresis.

        A point starts to slip beyond ε, and sticks again once it comes back below ε against
        the direction of its slip; it never reverses at once.
        """
        contact = self.contacts[number]
        kinematics, epsilon = contact.kinematics, contact.friction.regularisation_parameter
        slip = contact.friction.counted(kinematics.tangential(kinematics.jump_at_points()))
        size = np.linalg.norm(slip, axis=1)
        unit = slip / np.where(size > 0, size, 1.0)[:, None]
        sticks, directions = self._sticks[number], self._directions[number]
        share = np.where(sticks, np.minimum(size / epsilon, 1.0), 1.0)
        traction = -(bound * share)[:, None] * np.where(sticks[:, None], unit, directions)
        back = np.einsum("ij,ij->i", slip, directions) < epsilon
        self._sticks[number] = np.where(sticks, size <= epsilon, back)
        self._directions[number] = np.where(self._sticks[number][:, None], 0.0, unit)
        return traction

    def _monolithic(self) -> None:
        """Newton's method with the coupled tangent, from the adhesive start, full steps."""
        if all(contact.friction.is_scaled for contact in self.contacts):
            try:
                self._solve_coupled(self._is_out_of_scale)
                return
            except NotConvergedError as error:
                if not self._is_out_of_scale():
                    raise
                logger.info("%s; next: with the regularisation that this step needs", error)
                self.newton.restore(self.start)
        self._first_pressures(_SCALE_TOLERANCE)
        self.newton.restore(self.start)
        self._solve_coupled()

    def _is_out_of_scale(self) -> bool:
        """Whether some ε is much less than what the present pressures need; collective."""
        return not all([fits(contact, np.inf, _TOO_SMALL) for contact in self.contacts])

    def _solve_coupled(self, hopeless: Callable[[], bool] | None = None) -> None:
        for contact in self.contacts:
            contact.friction.stick_all()
            contact.friction.mode = "coupled"
        self.newton.run(search_energy=False, hopeless=hopeless)

    def _continuation(self) -> None:
        shares = _FALLING if RigidMotions(self.problem).slides_on_coulomb else _RISING
        for share in shares:
            for contact in self.contacts:
                contact.friction.set_share(share)
            if share == shares[0]:
                self._monolithic()
            else:
                self.newton.run(search_energy=False)

    def _finish(self, pressures: list[Array], change: float) -> bool:
        """A last solve in which friction and contact meet their laws exactly, the bound too.

        Returns:
            Whether this is the end; it may not be where the loop is still far.
        """
        before = self.newton.save()
        try:
            self._solve_coupled()
        except NotConvergedError:
            self.newton.restore(before)
            if change > self.settings.outer_tolerance:
                return False
            self._lagged_pass(pressures)  # the loop's own answer, to its tolerance
        return True
