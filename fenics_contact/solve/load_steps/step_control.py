"""Control of load steps: the next pseudo-time is the scene's, or follows from the last ones."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.scene import Scene, Steps

# Of a step, below which two pseudo-times are the same.
_SAME = 1e-9
# A step of at most so many Newton steps went easily.
_EASY = 20
_GROWTH = 1.5
# A change of area of which a part of the step has more than this share is a jump: no step makes
# it small.
_JUMP = 0.75
# A listed step is cut into no more parts than this.
_MOST_PARTS = 64


class FixedPace:
    """The steps that the scene lists."""

    def __init__(self, steps: Steps) -> None:
        self._times = steps.all_times

    def next(self, time: float) -> float | None:
        """The pseudo-time after one that is reached; None at the end."""
        place = bisect_right(self._times, time * (1 + _SAME))
        return self._times[place] if place < len(self._times) else None

    def cut(self) -> bool:
        """Whether the step that was tried can be made smaller: never."""
        return False

    def exceeds(self, change: float) -> bool:
        """Whether the step that was tried is to be cut for a change of area: never."""
        return False

    def went(self, newton_iterations: int, change: float) -> None:
        """The step that was tried is accepted."""

    @property
    def state(self) -> list[float]:
        """Numbers that ``resume`` needs: none."""
        return []

    def resume(self, state: Sequence[float]) -> None:
        """Go on as before."""


class HalvedPace(FixedPace):
    """The steps that the scene lists, halved where they do not converge.

    Args:
        steps: Of the scene.
    """

    def __init__(self, steps: Steps) -> None:
        super().__init__(steps)
        self._time = 0.0
        self._parts = 1  # of the present listed step
        self._tried = self._begin = 0.0

    def next(self, time: float) -> float | None:
        """The pseudo-time after one that is reached; None at the end."""
        end = super().next(time)
        if end is None:
            return None
        if end != self._time:
            self._time, self._begin, self._parts = end, time, 1
        size = (end - self._begin) / self._parts
        self._tried = end if end - time <= size * (1 + _SAME) else time + size
        return self._tried

    def cut(self) -> bool:
        """Halve the step that was tried, down to a part of the listed one; whether it can be."""
        self._parts *= 2
        return self._parts <= _MOST_PARTS

    @property
    def state(self) -> list[float]:
        """Numbers that ``resume`` needs: where the listed step begins and ends, and its parts."""
        return [self._begin, self._time, float(self._parts)]

    def resume(self, state: Sequence[float]) -> None:
        """Go on as before."""
        if len(state) == 3:
            self._begin, self._time, self._parts = state[0], state[1], int(state[2])


class AutomaticPace:
    """Steps that are cut and grow, and end at every knot of the load paths.

    Attributes:
        size: Of the next step, unless a knot is nearer (pseudo-time).

    Args:
        steps: Of the scene.
        knots: Pseudo-times that no step may pass over, increasing.
    """

    def __init__(self, steps: Steps, knots: Sequence[float]) -> None:
        self.size = steps.first_size
        self._steps = steps
        self._targets = [*(knot for knot in knots if 0 < knot < steps.end), steps.end]
        self._tried = self._goal = 0.0
        self._refused = self._refused_until = 0.0
        self._before_cut = self.size

    def next(self, time: float) -> float | None:
        """The pseudo-time after one that is reached; None at the end."""
        close = _SAME * self._steps.smallest_size
        target = next((t for t in self._targets if t > time + close), None)
        if target is None:
            return None
        left = target - time
        if left <= self.size * (1 + _SAME):
            self._tried, self._goal = left, target
            return target
        # Two halves instead of a step and a crumb.
        self._tried = left / 2 if left < 2 * self.size * (1 - _SAME) else self.size
        self._goal = time + self._tried
        return self._goal

    def cut(self) -> bool:
        """Halve the step that was tried, down to the smallest; whether that was possible."""
        smallest = self._steps.smallest_size
        if self._tried <= smallest * (1 + _SAME):
            return False
        self.size = max(self._tried / 2, smallest)
        return True

    def exceeds(self, change: float) -> bool:
        """Whether the step that was tried is to be cut for a change of area.

        Args:
            change: Over the area in contact.
        """
        if change <= self._steps.area_change:
            return False
        if self._goal <= self._refused_until and change > _JUMP * self._refused:
            return False
        self._refused, self._refused_until = change, self._goal
        self._before_cut = self.size
        return True

    def went(self, newton_iterations: int, change: float) -> None:
        """The step that was tried is accepted.

        Args:
            newton_iterations: That it took.
            change: Of area, over the area in contact.
        """
        if change > self._steps.area_change:  # a jump: the cut was in vain
            self.size = self._before_cut
        elif newton_iterations <= _EASY and change <= self._steps.area_change / 2:
            self.size = min(_GROWTH * self.size, self._steps.largest_size)

    @property
    def state(self) -> list[float]:
        """Numbers that ``resume`` needs."""
        return [self.size, self._before_cut, self._refused, self._refused_until]

    def resume(self, state: Sequence[float]) -> None:
        """Go on as before, within the bounds of the present scene."""
        steps = self._steps
        if state:  # else its steps were listed
            sizes = [min(max(size, steps.smallest_size), steps.largest_size) for size in state[:2]]
            self.size, self._before_cut = sizes
            self._refused, self._refused_until = state[2:]


class PaceOfCycles:
    """Load steps that may end as soon as the cycles of loads change nothing any more.

    Args:
        pace: Which step comes next until then.
        cycles: Those of the scene.
    """

    def __init__(self, pace: Pace, cycles: Cycles) -> None:
        self._pace, self._cycles, self._is_ended = pace, cycles, False
        self.cut, self.exceeds, self.went = pace.cut, pace.exceeds, pace.went

    def closed(self) -> None:
        """The loop is closed: no step follows, where they end early."""
        self._is_ended = _ends_early(self._cycles)

    def next(self, time: float) -> float | None:
        """The pseudo-time after one that is reached; None at the end."""
        return None if self._is_ended else self._pace.next(time)

    @property
    def state(self) -> list[float]:
        """Numbers that ``resume`` needs; last the tolerance at the end, 0 while cycles go on."""
        return [*self._pace.state, self._cycles.tolerance if self._is_ended else 0.0]

    def resume(self, state: Sequence[float]) -> None:
        """Go on as before."""
        self._is_ended = _has_ended(self._cycles, state)
        self._pace.resume(state[:-1])


Pace = FixedPace | HalvedPace | AutomaticPace


def pace_of(scene: Scene, knots: Sequence[float]) -> Pace | PaceOfCycles:
    """The step control of a scene.

    Args:
        scene: Of the run.
        knots: Pseudo-times that no automatic step may pass over, increasing.
    """
    steps = scene.load_steps
    pace: Pace = FixedPace(steps)
    if steps.automatic:
        pace = AutomaticPace(steps, knots)
    elif scene.has_finite_strains:
        pace = HalvedPace(steps)
    return pace if scene.cycles is None else PaceOfCycles(pace, scene.cycles)


def has_ended(scene: Scene, state: Sequence[float]) -> bool:
    """Whether the pace of a run had ended before its last load step."""
    return scene.cycles is not None and _has_ended(scene.cycles, state)


def _has_ended(cycles: Cycles, state: Sequence[float]) -> bool:
    """Whether they ended early, and with no larger a tolerance than is asked for now."""
    if not _ends_early(cycles):
        return False
    return 0 < state[-1] <= cycles.tolerance


def _ends_early(cycles: Cycles) -> bool:
    return cycles.until == "closed"
