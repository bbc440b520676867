"""Whether loads that come again and again still change anything: from the contacts' states alone.

The bulk is elastic and friction knows no rate, so tractions and slip at the end of a cycle, and
what laws keep at the points, say all that the next one depends on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.state import OPEN
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.steps import CycleEnd
from fenics_contact.scene.core_scene import LoadCycles
from fenics_contact.solve.systems.solution import Solution

# Of pseudo-times that are the same.
_SAME = 1e-9
# Of what counts as nothing: so much less is round-off, which leaves no pattern.
_ROUND_OFF = 1e-3
# Changes of states over these that are the round-off of a solve, whatever counts as nothing.
_OF_SOLVES = 1e-13


@dataclass(frozen=True, eq=False)
class _End:
    """The contacts at the end of a cycle, at the points of this rank.

    Attributes:
        tractions: Of each, (points, 1 + components), pressure first (stress).
        slips: Likewise, (points, components) (length).
        kept: What laws keep of their own, by contact and name.
        lost: Of friction at all since the start (energy).
    """

    tractions: list[Array]
    slips: list[Array]
    kept: dict[tuple[int, str], Array]
    lost: float


class CycleWatch:
    """Compares the ends of cycles, as load steps come to them.

    Args:
        problem: The model.
        cycles: Those of its scene.
    """

    def __init__(self, problem: Problem, cycles: LoadCycles) -> None:
        self._problem, self._cycles = problem, cycles
        self._ends = np.array(cycles.repetition.ends)
        self._before: _End | None = None
        self._losses: list[float] = []
        self._moved: dict[tuple[int, str], float] = {}  # largest change of what laws keep
        self._last: CycleEnd | None = None
        if cycles.begin == 0:
            self._before = self._at_rest()
        self._begin_cycle()

    def resume(self) -> None:
        """Take up the load steps of another run, whose cycles are not known."""
        self._before = None

    def step(self, time: float, found: Solution) -> CycleEnd | None:
        """Follow a load step that is accepted, before slip is counted from it; collective.

        Returns:
            What the cycle that ends with it has brought, if one does.
        """
        close = _SAME * self._cycles.repetition.period
        if time < self._cycles.begin - close:
            return None
        if abs(time - self._cycles.begin) <= close:
            self._before = self._end(found)
            return None
        self._follow(found)
        number = int(np.searchsorted(self._ends, time - close))
        if number == len(self._ends) or abs(self._ends[number] - time) > close:
            return None
        return self._compare(number + 1, self._end(found))

    def _begin_cycle(self) -> None:
        """Nothing of the next cycle is known yet."""
        count = len(self._problem.contacts)
        self._largest = np.zeros(count)  # forces without regard to signs
        self._swings = np.zeros(count)  # mean slip since its begin
        self._touched = [np.zeros(len(c.trace.weights)) for c in self._problem.contacts]
        self._creep, self._creep_work = 0.0, 0.0

    def _follow(self, found: Solution) -> None:
        """Update the largest values in the cycle; collective."""
        for number, (contact, state) in enumerate(
            zip(self._problem.contacts, found.states, strict=True)
        ):
            friction = np.linalg.norm(state.friction_traction, axis=1)
            held = float(contact.trace.integral(np.abs(state.contact_pressure) + friction))
            self._largest[number] = max(self._largest[number], held)
            self._touched[number] = np.maximum(self._touched[number], state.status != OPEN)
            if contact.friction.regularisation.is_numerical:
                epsilon = contact.regularisation_parameter
                self._creep += epsilon
                self._creep_work += epsilon * float(contact.trace.integral(friction))
            if self._before is not None:
                moved = state.slip - self._before.slips[number]
                self._swings[number] = max(self._swings[number], self._mean(number, moved))

    def _mean(self, number: int, moved: Array) -> float:
        """Mean length over the points of a contact that touched in the cycle; collective."""
        trace, touched = self._problem.contacts[number].trace, self._touched[number]
        area = float(trace.integral(touched))
        far = float(trace.integral(touched * np.linalg.norm(moved, axis=1)))
        return far / area if area > 0 else 0.0

    def _compare(self, number: int, end: _End) -> CycleEnd:
        """The end of a cycle with that of the one before; collective."""
        before, self._before = self._before, end
        if before is None:  # resumed within the cycle
            self._begin_cycle()
            return CycleEnd(number=number, change=None, advance=None, kind="")
        changed = [
            float(contact.trace.integral(np.abs(now - then).sum(axis=1)))
            for contact, now, then in zip(
                self._problem.contacts, end.tractions, before.tractions, strict=True
            )
        ]
        scale = float(self._largest.max(initial=0.0))
        change = max(changed, default=0.0) / scale if scale > 0 else 0.0
        advances = [
            self._mean(i, now - then)
            for i, (now, then) in enumerate(zip(end.slips, before.slips, strict=True))
        ]
        advance = max(advances, default=0.0)
        rests = self._rests(before, end)
        kind = self._kind(change, advance, end.lost - before.lost) if rests else ""
        self._losses.append(end.lost - before.lost)
        self._begin_cycle()
        self._last = CycleEnd(
            number=number, change=change, advance=advance, kind=kind, is_kept_changing=not rests
        )
        return self._last

    def _rests(self, before: _End, end: _End) -> bool:
        """Whether what laws keep changes no more, against what cycles have changed; collective.

        Wear that goes on, or friction that goes by all that has slipped, makes no closed loop.
        """
        rests = True
        for key, now in end.kept.items():
            trace = self._problem.contacts[key[0]].trace
            found = float(trace.integral(_sizes(now - before.kept.get(key, 0.0))))
            self._moved[key] = max(self._moved.get(key, 0.0), found)
            most = max(self._moved[key], _ROUND_OFF * float(trace.integral(_sizes(now))))
            rests &= found <= self._cycles.tolerance * most
        return rests

    def _kind(self, change: float, advance: float, loss: float) -> str:
        """The kind of response that the loop closes to; empty while it is not closed.

        Points that stick creep by up to ε in a load step, which is neither slip nor a loss.
        """
        last = self._last
        if last is None or last.change is None or last.advance is None:
            return ""
        share = self._cycles.tolerance
        little = share * max(*self._losses, loss, self._round_off) + self._creep_work
        slight = share * float(self._swings.max(initial=0.0)) + self._creep
        if change_to_come(change, last.change, share) > share:
            return ""
        if abs(loss - self._losses[-1]) > little:
            return ""
        if advance > slight:
            return "ratchetting" if abs(advance - last.advance) <= share * advance else ""
        return "shakedown" if loss <= little else "steady loop"

    @property
    def _round_off(self) -> float:
        """Loss of a cycle that counts as none: a share of forces times slip to and fro (energy)."""
        return _ROUND_OFF * float(self._largest @ self._swings)

    def _end(self, found: Solution) -> _End:
        """Tractions, slips and losses at the end of a cycle, from a solution; collective."""
        pairs = list(zip(self._problem.contacts, found.states, strict=True))
        return _End(
            [np.column_stack([s.contact_pressure, s.friction_traction]) for _, s in pairs],
            [state.slip.copy() for _, state in pairs],
            {(i, key): kept for i, (_, s) in enumerate(pairs) for key, kept in s.own.items()},
            sum(contact.work.of_friction(state) for contact, state in pairs),
        )

    def _at_rest(self) -> _End:
        """Before any load."""
        shapes = [contact.trace.normals.shape for contact in self._problem.contacts]
        tractions = [np.zeros((points, 1 + components)) for points, components in shapes]
        return _End(tractions, [np.zeros(shape) for shape in shapes], {}, 0.0)


def _sizes(values: Array) -> Array:
    """Sums of the components' sizes at each point, (points,); a rank may have none."""
    return np.asarray(np.abs(values).sum(axis=tuple(range(1, values.ndim))))


def change_to_come(change: float, before: float, share: float) -> float:
    """The change that is still to come, if each cycle leaves the same part of the last one's.

    Args:
        change: In the cycle, over what changes in it.
        before: In the cycle before.
        share: What counts as nothing.
    """
    if change <= max(_ROUND_OFF * share, _OF_SOLVES):
        return change
    return max(change, change * change / (before - change)) if change < before else np.inf
