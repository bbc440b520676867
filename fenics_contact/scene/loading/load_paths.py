"""Load paths as runs use them: a factor at a pseudo-time, the cycles of all, and load steps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.common.errors import InputError
from fenics_contact.scene.core_scene import CoreScene, LoadCycles
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.values import LoadPath, Path

# Of the last, below which two knots are one.
_SAME = 1e-12
# Of factors and pseudo-times that are the same.
_CLOSE = 1e-9
_MOST = 1_000_000  # load steps
# Places of a cycle at which functions are asked whether they move.
_PROBED = 33


@dataclass(frozen=True)
class KeyedPath:
    """A table or a function, and where the scene has it.

    Attributes:
        path: Of the scene.
        key: Where, for messages.
        acts: Whether it is of anything but 0.
    """

    path: LoadPath
    key: str
    acts: bool = True

    def __call__(self, time: float) -> float:
        """Share of the value at a pseudo-time; the same on every rank.

        Raises:
            InputError: A function fails, or gives no finite number.
        """
        try:
            factor = float(self.path(time))
        except Exception as caught:  # whatever a user's function raises
            said = " ".join(str(caught).split())
            raise InputError(
                f"{self.key}: its function fails at time {time:g}: {type(caught).__name__}: {said}"
            ) from None
        if not math.isfinite(factor):
            raise InputError(f"{self.key}: its function gives {factor} at time {time:g}")
        return factor


def keyed_paths(scene: CoreScene) -> Iterator[KeyedPath]:
    """All load paths of a scene, and where it has them."""
    for number, support in enumerate(scene.support):
        yield KeyedPath(support.path, f"support[{number}].path", support.moves)
    for number, load in enumerate(scene.load):
        yield KeyedPath(load.path, f"load[{number}].path")
    for number, preload in enumerate(scene.preload):
        yield KeyedPath(preload.path, f"preload[{number}].path")
    for number, coupling in enumerate(scene.coupling):
        acts = any(coupling.given.values()) or any(coupling.acting.values())
        yield KeyedPath(coupling.path, f"coupling[{number}].path", acts)
    for number, temperature in enumerate(scene.temperature):
        yield KeyedPath(temperature.path, f"temperature[{number}].path")
    for number, heat in enumerate(scene.heat):
        yield KeyedPath(heat.path, f"heat[{number}].path")
    for number, contact in enumerate(scene.contact):
        key = f"contact[{number}]"
        yield KeyedPath(contact.pressure_path, f"{key}.pressure_path")
        if contact.interference:
            yield KeyedPath(contact.interference_path, f"{key}.interference_path")
        obstacle = contact.obstacle
        if obstacle is not None:
            driven = bool(obstacle.force or obstacle.indentation)
            yield KeyedPath(obstacle.path, f"{key}.obstacle.path", driven)
            moves = bool(obstacle.displacement and any(obstacle.displacement))
            yield KeyedPath(obstacle.displacement_path, f"{key}.obstacle.displacement_path", moves)
            turns = bool(obstacle.angle or obstacle.moment)
            yield KeyedPath(obstacle.rotation_path, f"{key}.obstacle.rotation_path", turns)


def _tables(scene: CoreScene) -> list[Path]:
    """All load paths of a scene that are no functions."""
    return [one.path for one in keyed_paths(scene) if isinstance(one.path, Path)]


def cycles_of(scene: CoreScene) -> LoadCycles | None:
    """Return the cycles of the loads: ``[cycles]``, or those of the paths' key ``cycles``.

    None where there are none, or tables have several periods, and where bodies move.
    """
    if scene.cycles is not None or scene.motion is not None:
        return scene.cycles
    several = [path.repetition for path in _tables(scene) if path.cycles > 1]
    if not several or len({one.period for one in several}) > 1:
        return None
    number = max(one.number for one in several)
    return Cycles(end=several[0].period, number=number, until="end")


def knots(scene: CoreScene) -> list[float]:
    """Pseudo-times at which a table may change its slope, or a bolt is locked, increasing."""
    return _distinct([*_knots_as_written(scene), *_knots_of_cycles(scene)])


def _knots_as_written(scene: CoreScene) -> set[float]:
    locked = {p.locked_from for p in scene.preload if p.locked_from is not None}
    return {knot for path in _tables(scene) for knot in path.knots} | locked


def _knots_of_cycles(scene: CoreScene) -> list[float]:
    """Return the knots inside ``[cycles]``, repeated in every cycle."""
    cycles = scene.cycles
    if cycles is None:
        return []
    begin, end = cycles.begin, cycles.end
    inside = [knot - begin for knot in _knots_as_written(scene) if begin < knot < end]
    starts = cycles.repetition.starts
    return [*starts, *cycles.repetition.ends, *(s + t for s in starts for t in inside)]


def _distinct(times: list[float]) -> list[float]:
    """Increasing, none twice."""
    every = sorted(set(times))
    close = _SAME * max(every, default=0.0)
    return [b for a, b in zip([-math.inf, *every], every, strict=False) if b - a > close]


def load_steps_of(scene: CoreScene) -> Steps:
    """Load steps to the end of the last cycle: of ``[steps]`` and ``[cycles]``, or ``[motion]``."""
    steps, cycles = scene.steps, scene.cycles
    if scene.motion is not None:
        return scene.motion.steps
    if cycles is None:
        return steps
    own = registry.takes_steps_of(scene)
    if own is not None:
        return cast(Steps, own.part("table").load_steps(scene))
    last = cycles.repetition.ends[-1]
    if steps.automatic:
        size = steps.end / steps.number
        if cycles.increments is not None:
            size = min(size, cycles.repetition.period / cycles.increments)
        number = min(max(math.ceil(last / size * (1 - _SAME)), 1), 100_000)
        return replace(steps, number=number, end=last)
    before = [t for t in steps.all_times if t < cycles.begin * (1 - _CLOSE)]
    before += [cycles.begin] if cycles.begin > 0 else []
    inside = _times_in_cycle(scene, cycles)
    times = [begin + time for begin in cycles.repetition.starts for time in inside]
    return Steps(times=(*before, *times))


def load_steps_in_cycle(scene: CoreScene) -> int | None:
    """How many load steps a cycle of a scene has; None of automatic ones."""
    if scene.cycles is None or scene.steps.automatic:
        return None
    return len(_times_in_cycle(scene, scene.cycles))


def _times_in_cycle(scene: CoreScene, cycles: LoadCycles) -> list[float]:
    """Ends of the load steps of a cycle, counted from its begin."""
    period = cycles.repetition.period
    if cycles.increments is None:
        since = [time - cycles.begin for time in scene.steps.all_times]
        return [*(t for t in since if _CLOSE * period < t < (1 - _CLOSE) * period), period]
    turns = [knot - cycles.begin for knot in _knots_as_written(scene)]
    turns = _distinct([0.0, *(t for t in turns if 0 < t < period), period])
    times: list[float] = []
    for start, end in pairwise(turns):
        number = max(round(cycles.increments * (end - start) / period), 1)
        times += np.linspace(start, end, number + 1)[1:].tolist()
    return times


def require_back(scene: CoreScene, begin: float, end: float) -> None:
    """Refuse a cycle at whose end a path is not where it was at its begin.

    Args:
        scene: Of the cycle.
        begin: Its pseudo-time.
        end: Likewise.

    Raises:
        ValueError: In words.
    """
    for one in keyed_paths(scene):
        if one.acts:
            _require_back(one, begin, end)


def _require_back(path: KeyedPath, begin: float, end: float) -> float:
    """The factor at the begin, which is that at the end."""
    first, last = path(begin), path(end)
    if abs(last - first) > _CLOSE * max(abs(first), abs(last)):
        raise ValueError(
            f"cycles: {path.key} gives {first:g} at begin, {begin:g}, and {last:g} at end, "
            f"{end:g}; it must come back, or every cycle would begin with a jump"
        )
    return first


def require_cycles(scene: CoreScene) -> None:
    """Refuse cycles in which loads jump, in which nothing changes, or that are given twice.

    Raises:
        ValueError: In words.
    """
    cycles = scene.cycles
    if cycles is None:
        return
    begin, end, moves = cycles.begin, cycles.end, False
    for one in keyed_paths(scene):
        if isinstance(one.path, Path) and one.path.cycles > 1:
            raise ValueError(f"cycles: {one.key} has cycles, too; say them in one place")
        if not one.acts:
            continue
        first = _require_back(one, begin, end)
        between = np.linspace(begin, end, _PROBED).tolist()
        if isinstance(one.path, Path):
            between += [knot for knot in one.path.knots if begin < knot < end]
        moves |= any(one(time) != first for time in between)
    if not moves:
        raise ValueError(f"cycles: no path changes between begin, {begin:g}, and end, {end:g}")
    for number, preload in enumerate(scene.preload):
        if preload.locked_from is not None and preload.locked_from > begin * (1 + _CLOSE):
            raise ValueError(
                f"cycles: preload[{number}].locked_from = {preload.locked_from:g} must be at "
                f"begin, {begin:g}, or before"
            )
    for number, contact in enumerate(scene.contact):
        if contact.law == "static" and contact.is_rough:
            raise ValueError(
                f"cycles: contact[{number}].law = 'static' goes back the way it came; use "
                "'incremental'"
            )
    if not scene.steps.automatic and len(_times_in_cycle(scene, cycles)) < 2:
        raise ValueError(
            "cycles: a cycle needs two load steps at least; say how many as increments"
        )
    if registry.takes_steps_of(scene) is None:
        _require_each_can_be_taken(scene, cycles)


def _require_each_can_be_taken(scene: CoreScene, cycles: LoadCycles) -> None:
    """Refuse cycles that are computed one after the other, and are too many or never close."""
    if cycles.number * (cycles.increments or 1) > _MOST:
        raise ValueError(f"cycles: number × increments must be at most {_MOST} load steps")
    worn = next((number for number, one in enumerate(scene.contact) if one.wear), None)
    if worn is not None and cycles.until == "closed":  # closed loops still wear
        raise ValueError(
            f"cycles.until = 'closed': contact[{worn}] has a wear, which goes on when the loop is "
            "closed; set until = 'end', or say how far cycles may be passed over: jumps = {}"
        )


def moduli_change(scene: CoreScene) -> bool:
    """Whether moduli follow temperatures that are found, or that change between load steps.

    Args:
        scene: What is to be run.
    """
    if not scene.moduli_follow_temperature:
        return False
    steps = load_steps_of(scene)
    times = [*steps.all_times]
    if steps.automatic:  # which may be cut
        times = [0.0, *times, *(knot for knot in knots(scene) if knot < steps.last)]
    return bool(scene.heat) or any(
        len({path(scene.path_time(time)) for time in times}) > 1
        if isinstance(path, Path)
        else len(times) > 1
        for path in (one.path for one in scene.temperature)
    )


def times_to_judge(scene: CoreScene, first_only: bool) -> list[float]:
    """Ends of load steps between which loads are combinations of those at them, increasing.

    Of steps between two entries of the tables the first and the last; all entries where steps
    are automatic, as none passes over one. Loads that come again, as in cycles, are judged once.

    Args:
        scene: What is to be run.
        first_only: Leave out what comes after the first step.
    """
    steps = load_steps_of(scene)
    ends = list(steps.all_times)
    if len(ends) == 1 and not steps.automatic:
        return ends
    turns = [knot for knot in knots(scene) if 0 < knot < steps.last]
    if steps.automatic:
        times = [] if first_only else [*turns, steps.last]
    elif first_only:
        times = ends[:1]
    else:
        places = np.searchsorted(ends, turns, side="left")
        near = {0, len(ends) - 1, *places.tolist(), *(places - 1).clip(0).tolist()}
        near |= {min(place + 1, len(ends) - 1) for place in places.tolist()}
        times = [ends[place] for place in sorted(near)]
    tables, seen = _tables(scene), set()
    kept = []
    for time in times:
        state = tuple(round(path(scene.path_time(time)), 12) for path in tables)
        if state not in seen:
            seen.add(state)
            kept.append(time)
    return kept
