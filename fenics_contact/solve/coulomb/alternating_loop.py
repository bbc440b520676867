"""The loop on the contact pressure: Section 4.1 of the paper, case (ii), its Steps 1 to 4.

Anderson's acceleration of a fixed-point iteration on arrays spread over the ranks. D. G. Anderson,
J. ACM 12 (1965) 547-560; H. F. Walker and P. Ni, SIAM J. Numer. Anal. 49 (2011) 1715-1735.

Friction is bounded by μ p, and the pressure p is not known. The paper alternates:

1. contact without friction;
2. the pressures p at the points, (4.4);
3. friction under p: the bound g = μ p, springs g/ε where points stick and tractions g where they
   slip, (4.5) to (4.7);
4. contact under the tractions of Step 3; then from Step 2 on until successive answers agree.

Ours are Anderson's acceleration of p, the hysteresis of what sticks, and a last solve for contact
and friction at once, so that the answer does not depend on when the loop ends.
"""

from __future__ import annotations

import logging

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.noise import all_round_off
from fenics_contact.solve.coulomb.monolithic import solve_coupled
from fenics_contact.solve.coulomb.without_friction import contact_without_friction, follow_pressure
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.newton_failure import Chatter

_MEMORY = 5
# Steps whose residuals depend on each other to this are not used together.
_CUT = 1e-10


class Anderson:
    """Next iterates x from pairs (x, G(x)), arrays of non-negative numbers.

    G has kinks, where points begin to slip: pairs from beyond one mislead. So all earlier
    ones are forgotten whenever the residual grows.

    Args:
        comm: Communicator; ``next`` is collective.
        counted: Which entries of each array this rank counts.
    """

    def __init__(self, comm: MPI.Comm, counted: list[Flags]) -> None:
        self._comm = comm
        self._counted = np.concatenate(counted)
        self._pairs: list[tuple[Array, Array]] = []
        self._size = np.inf

    def next(self, arrays: list[Array], images: list[Array]) -> list[Array]:
        """The combination of the last images whose residual is least."""
        x, image = np.concatenate(arrays), np.concatenate(images)
        mine = (image - x)[self._counted]
        size = float(total(self._comm, mine @ mine))
        kept = self._pairs[-_MEMORY:] if size <= self._size else []
        self._pairs, self._size = [*kept, (image, image - x)], size
        differences = [
            (self._pairs[-1][0] - old, self._pairs[-1][1] - residual)
            for old, residual in self._pairs[:-1]
        ]
        found = image
        if differences:
            residuals = np.array([r for _, r in differences])
            counted = residuals[:, self._counted]
            gram = total(self._comm, counted @ counted.T)
            right = total(self._comm, counted @ mine)
            shares = np.linalg.lstsq(gram, right, rcond=_CUT)[0]
            found = image - shares @ np.array([d for d, _ in differences])
        found = np.maximum(found, 0.0)
        return np.split(found, np.cumsum([len(array) for array in arrays])[:-1])


# The loop is left where it has not come nearer in this many passes.
_PATIENCE = 8
# Changes from which the contraction is still taken, over the peak: smaller ones are round-off.
_ROUND_OFF = 1e-11
# Pairs of passes that the contraction is the largest of.
_LATEST = 3


class OuterMonitor:
    """Follows the map from pressures to pressures; all calls are collective.

    Attributes:
        change: Of the pressures in the last pass, over their peak.

    Args:
        chatter: What the contact points do.
        comm: Communicator.
    """

    def __init__(self, chatter: Chatter, comm: MPI.Comm) -> None:
        self._chatter, self._comm = chatter, comm
        self.change = np.inf
        self._best, self._since = np.inf, 0
        self._last: tuple[Array, Array] | None = None
        self._ratios: list[float] = []
        chatter.clear()

    @property
    def contraction(self) -> float | None:
        """Estimate of the map's Lipschitz constant, by secants; None before two passes.

        ‖G(p) − G(p')‖ over ‖p − p'‖, in the largest norm, of successive passes: it does not
        depend on how p is accelerated. The loop by itself needs a value below 1.
        """
        return max(self._ratios[-_LATEST:]) if self._ratios else None

    @property
    def is_stalled(self) -> bool:
        """Whether the pressures have come no nearer for some passes."""
        return self._since >= _PATIENCE

    def see(self, before: list[Array], after: list[Array]) -> float:
        """Take a pass from pressures at the contacts to new ones (stress).

        Returns:
            The change over the peak.
        """
        self._chatter.note()
        x, image = np.concatenate(before), np.concatenate(after)
        peak = largest(self._comm, image)
        self.change = largest(self._comm, np.abs(image - x)) / peak if peak > 0 else 0.0
        if self._last is not None:
            moved = largest(self._comm, np.abs(x - self._last[0]))
            answered = largest(self._comm, np.abs(image - self._last[1]))
            if moved > _ROUND_OFF * peak:
                self._ratios.append(answered / moved)
        self._last = x, image
        if self.change < 0.9 * self._best:
            self._best, self._since = self.change, 0
        else:
            self._since += 1
        return self.change

    def words(self) -> str:
        """How the loop went, for who reads that it failed."""
        words = f"no progress in {_PATIENCE} passes: " if self.is_stalled else ""
        words += f"the pressures still change by {self.change:.1e} of their peak"
        if self.contraction is not None:
            words += f", and a pass multiplies differences by {self.contraction:.2g}"
        return words + self._chatter.words("passes")


logger = logging.getLogger(__name__)


class StalledError(Exception):
    """The loop on the pressure does not come nearer."""


class AlternatingLoop:
    """Friction under the last pressures, then contact under the friction found, until they agree.

    All calls are collective. Pressures are an array (stress) for each Coulomb contact, at the
    points of this rank.

    Attributes:
        passes: How often new pressures were found from the last ones.
        contraction: By how much a pass multiplies differences of pressures; None if not known.
    """

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.contacts = newton.problem.coulomb
        self.settings = newton.problem.scene.solver
        self.passes = 0
        self.contraction: float | None = None
        self._is_glued = False

    def run(self, near: float) -> None:
        """Steps 1 to 4, until the pressures change no more.

        Args:
            near: Change of the pressures, over their peak, from which contact and friction are
                solved at once; where that fails, the loop goes on to the scene's tolerance.

        Raises:
            StalledError: Where the pressures come no nearer.
            NotConvergedError: Where Newton's method fails.
        """
        self.step_1()
        pressures = self.step_2()
        if self._nothing_rubs(pressures):
            self._rub_nothing()
            pressures = self.step_2()
            if not self._is_glued or self._peak(pressures) == 0:
                return
            for contact in self.contacts:  # what glue held has come together
                follow_pressure(contact, self.newton.limit)
        anderson = Anderson(self.problem.comm, [c.trace.owned for c in self.contacts])
        monitor = OuterMonitor(Chatter(self.contacts, self.problem.comm), self.problem.comm)
        near = max(near, self.settings.outer_tolerance)
        for _ in range(self.settings.max_outer_iterations):
            found = self.one_pass(pressures)
            self.passes += 1
            change = monitor.see(pressures, found)
            self.contraction = monitor.contraction
            logger.debug("  pass %d: pressures change by %.2e of the peak", self.passes, change)
            if change <= near:
                if self._finish(found, change):
                    return
                near = self.settings.outer_tolerance
            if monitor.is_stalled:
                raise StalledError(monitor.words())
            pressures = anderson.next(pressures, found)
        raise StalledError(
            f"the {self.settings.max_outer_iterations} passes allowed were used up: "
            f"{monitor.words()}"
        )

    def one_pass(self, pressures: list[Array]) -> list[Array]:
        """From pressures to new ones: Steps 3, 4 and 2."""
        self.step_3(pressures)
        self.step_4()
        return self.step_2()

    def step_1(self) -> None:
        """Contact without friction; all points are to stick at first."""
        self._is_glued = contact_without_friction(self.newton)
        self._sticks = [np.ones(len(c.trace.weights), dtype=bool) for c in self.contacts]
        self._directions = [np.zeros_like(c.trace.normals) for c in self.contacts]

    def step_2(self) -> list[Array]:
        """The pressures at the points, (4.4)."""
        return [contact.pressure() for contact in self.contacts]

    def step_3(self, pressures: list[Array]) -> None:
        """Friction under given pressures, (4.5) to (4.7), linear; gives the tractions of Step 4."""
        bounds = [
            contact.friction.bound_of(pressure)
            for contact, pressure in zip(self.contacts, pressures, strict=True)
        ]
        for i, contact in enumerate(self.contacts):
            contact.normal_term.hold(pressures[i])
            contact.friction_term.set_status(self._sticks[i], self._directions[i], bounds[i])
        self.newton.run(search_energy=False)
        for i, contact in enumerate(self.contacts):
            contact.friction_term.hold(self._next_status(i, bounds[i]))

    def step_4(self) -> None:
        """Contact under the friction that Step 3 found."""
        for contact in self.contacts:
            contact.normal_term.follow_law()
        self.newton.run()

    def contact_and_friction(self, pressures: list[Array]) -> None:
        """Steps 3 and 4 at once: contact, and friction with the bound of given pressures."""
        for contact, pressure in zip(self.contacts, pressures, strict=True):
            contact.friction_term.follow_law()
            contact.friction.set_bound(contact.friction.bound_of(pressure))
        before = self.newton.save()
        try:
            self.newton.run(search_energy=False)
        except NotConvergedError:  # rarely: full steps are the better ones with friction
            self.newton.restore(before)
            self.newton.run()

    def _next_status(self, number: int, bound: Array) -> Array:
        """The tractions of Step 3, and the status for the next one, with hysteresis.

        A point starts to slip beyond ε, and sticks again once it comes back below ε against
        the direction of its slip; it never reverses at once.
        """
        contact = self.contacts[number]
        kinematics, epsilon = contact.kinematics, contact.regularisation_parameter
        slip = contact.friction.scaled_slip(kinematics.tangential(kinematics.jump_at_points()))
        size = np.linalg.norm(slip, axis=1)
        unit = slip / np.where(size > 0, size, 1.0)[:, None]
        sticks, directions = self._sticks[number], self._directions[number]
        share = np.where(sticks, np.minimum(size / epsilon, 1.0), 1.0)
        along = np.where(sticks[:, None], unit, directions)
        traction = contact.friction.traction_from_bound(bound * share, along)
        back = np.einsum("ij,ij->i", slip, directions) < epsilon
        self._sticks[number] = np.where(sticks, size <= epsilon, back)
        self._directions[number] = np.where(self._sticks[number][:, None], 0.0, unit)
        return traction

    def _finish(self, pressures: list[Array], change: float) -> bool:
        """A last solve in which friction and contact meet their laws exactly, the bound too.

        Returns:
            Whether this is the end; it may not be where the loop is still far.
        """
        before = self.newton.save()
        try:
            solve_coupled(self.newton, of_growth=change > self.settings.outer_tolerance)
        except NotConvergedError:
            self.newton.restore(before)
            if change > self.settings.outer_tolerance:
                return False
            self.contact_and_friction(pressures)  # the loop's own answer, to its tolerance
        return True

    def _nothing_rubs(self, pressures: list[Array]) -> bool:
        """Whether nothing touches, or carries but round-off of a motion along contacts."""
        if self._peak(pressures) == 0:
            return True
        return all_round_off(self.problem.contacts, self.newton.system.forces)

    def _rub_nothing(self) -> None:
        """Take friction for none where nothing touches; what glue holds then is not held."""
        for contact in self.contacts:
            contact.friction_term.follow_law()
            contact.friction.set_bound(np.zeros_like(contact.friction.bound))
        if self._is_glued:
            self.newton.run()

    def _peak(self, pressures: list[Array]) -> float:
        return max(largest(self.problem.comm, pressure) for pressure in pressures)


class LaggedLoop(AlternatingLoop):
    """Contact and friction at once, with the bound of the last pressures, until they agree."""

    def one_pass(self, pressures: list[Array]) -> list[Array]:
        """From pressures to new ones."""
        self.contact_and_friction(pressures)
        return self.step_2()
