"""The state of the points of a contact, and what is kept of its last load step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words

OPEN, STICK, SLIP = "OPEN", "STICK", "SLIP"


@dataclass(frozen=True, eq=False)
class ContactState:
    """State of the contact points of this rank, one row a point.

    Attributes:
        gap: Along the normal, > 0 open, infinite where no obstacle stands (length).
        contact_pressure: On the body, ≥ 0; < 0 in tension where bonded (stress).
        friction_traction: Tangential traction on the body, (points, components) (stress).
        slip: Tangential displacement relative to the obstacle, (points, components) (length).
        status: OPEN, STICK or SLIP.
        penalty_energy: Of penalty or foundation (energy/area).
        own: What the laws of the contact keep of their own and results have, by name.
    """

    gap: Array
    contact_pressure: Array
    friction_traction: Array
    slip: Array
    status: Words
    penalty_energy: Array
    own: Mapping[str, Array] = field(default_factory=dict)


_KINDS = (OPEN, STICK, SLIP)


class LastStep:
    """The last load step that was accepted, at the contact points.

    Attributes:
        state: What happened there at its end; the body at rest before the first step.
        gap: Then, of what stands opposite, before the body deforms; before the first step an
            overlap is none yet (length).
        dissipated: Work of friction in the load steps that are done (force × length).
        left_open: Work of pressures, where a gap was measured anew between steps (likewise).
        dissipated_before: The same at the begin of each cycle of loads that began (likewise).
        acts_all_along: Whether friction at the end of a step acts in all of it, as in motion.
    """

    def __init__(self, at_rest: ContactState, gap: Array) -> None:
        self.state = at_rest
        self.gap = gap
        self.dissipated, self.left_open = 0.0, 0.0
        self.dissipated_before: tuple[float, ...] = ()
        self.acts_all_along = False
        # What laws keep of their own, they remember themselves.
        self._names = [field.name for field in fields(at_rest) if field.name != "own"]

    def changed(self, state: ContactState) -> Flags:
        """At which points the status changed in the step, if only in between, as in slip back."""
        turned = np.einsum("ij,ij->i", self.state.friction_traction, state.friction_traction) < 0
        return np.asarray((state.status != self.state.status) | (turned & (state.status == SLIP)))

    def _takes_end(self, state: ContactState) -> Flags:
        """At which points friction at the end of the step is that of the step."""
        return self.changed(state) | self.acts_all_along

    def dissipation(self, state: ContactState, slip: Array) -> Array:
        """Work of friction in a step (energy/area).

        By the trapezoidal rule; by the traction at the end where the status changed: a point
        that begins to slip does so under the friction that it ends with.

        Args:
            state: At the end of the step.
            slip: In the step, without what goes back, (points, components) (length).
        """
        ends = self._takes_end(state)[:, None]
        traction = state.friction_traction
        mean = np.where(ends, traction, 0.5 * (self.state.friction_traction + traction))
        return np.asarray(0.0 - np.einsum("ij,ij->i", mean, slip))

    def mean_pressure(self, state: ContactState) -> Array:
        """Pressure of a step, (points,) (stress): the mean, or the last as in ``dissipation``."""
        mean = 0.5 * (self.state.contact_pressure + state.contact_pressure)
        return np.where(self.changed(state), state.contact_pressure, mean)

    def open_friction(self, state: ContactState, slip: Array) -> Array:
        """How far ``dissipation`` is from the trapezoidal rule everywhere (energy/area)."""
        if self.acts_all_along:
            return np.zeros(len(slip))
        beyond = 0.5 * (state.friction_traction - self.state.friction_traction)
        return np.where(self.changed(state), np.abs(np.einsum("ij,ij->i", beyond, slip)), 0.0)

    def open_pressing(self, state: ContactState) -> Array:
        """Error of the trapezoidal rule for the work of pressures in a step (energy/area).

        It takes pressures to grow with the depth from where a point was, be there a gap at first,
        and in a straight line, whatever the law; the energy that is stored tells what they did.
        """
        depths = []
        for known in (self.state, state):
            # What overlaps as meshed does not press yet.
            least = np.where(known.contact_pressure > 0, -known.gap, np.minimum(-known.gap, 0.0))
            depths.append(np.where(np.isfinite(known.gap), least, 0.0))
        mean = 0.5 * (self.state.contact_pressure + state.contact_pressure)
        stored = state.penalty_energy - self.state.penalty_energy
        return np.asarray(np.abs(mean * (depths[1] - depths[0]) - stored))

    def advance(self, state: ContactState, gap: Array, work: float) -> None:
        """A step is accepted.

        Args:
            state: At its end.
            gap: Of what stands opposite, before the body deforms (length).
            work: Of friction in it (force × length).
        """
        self.state, self.gap = state, gap
        self.dissipated += work

    def leave_open(self, work: float) -> None:
        """Add work of pressures that a gap found again between load steps leaves open (energy)."""
        self.left_open += work

    def take_ends(self) -> None:
        """Take friction at the end of a step to act in all of it, from now on."""
        self.acts_all_along = True

    def begin_cycle(self) -> None:
        """A cycle of loads begins with the next step."""
        self.dissipated_before = (*self.dissipated_before, self.dissipated)

    def count_from(self, slip: Array) -> None:
        """Take the slip of the last step as measured after the contact search was repeated.

        Else a point that faced nothing would have slipped by all that its body has moved.

        Args:
            slip: Since the start, (points, components) (length).
        """
        self.state = replace(self.state, slip=slip)

    def carry(self, turn: Callable[[Array], Array]) -> None:
        """Take vectors along with the surface, which has turned since.

        Args:
            turn: Gives such vectors along the surface as it is now, (points, components).
        """
        state = self.state
        slip, traction = turn(state.slip), turn(state.friction_traction)
        self.state = replace(state, slip=slip, friction_traction=traction)

    def open_after_pairing(self, gap: Array) -> Array:
        """Work that a repeated contact search leaves open after a step, (points,) (energy/area).

        Args:
            gap: Of the body as the step left it, in the new measure (length).
        """
        both = np.isfinite(gap) & np.isfinite(self.state.gap)
        jump = np.where(both, gap, 0.0) - np.where(both, self.state.gap, 0.0)
        return np.asarray(self.state.contact_pressure * np.abs(jump))

    def at_points(self) -> dict[str, Array]:
        """Numbers at the points, (points,) or (points, components), to be given to ``restore``."""
        last = {name: getattr(self.state, name) for name in self._names}
        code = np.argmax([last["status"] == kind for kind in _KINDS], axis=0)
        return last | {"status": code.astype(np.float64), "obstacle_gap": self.gap}

    def restore(
        self,
        at_points: Mapping[str, Array],
        dissipated: float,
        left_open: float,
        dissipated_before: Sequence[float],
    ) -> None:
        """Go on from where another run left.

        Args:
            at_points: As ``at_points`` gave them, others among them.
            dissipated: As the attribute (energy).
            left_open: Likewise.
            dissipated_before: Likewise.
        """
        status = np.array(_KINDS)[at_points["status"].astype(np.int64)]
        last = {name: at_points[name] for name in self._names} | {"status": status}
        self.state = type(self.state)(**last)
        self.gap = at_points["obstacle_gap"]
        self.dissipated, self.left_open = dissipated, left_open
        self.dissipated_before = tuple(dissipated_before)
