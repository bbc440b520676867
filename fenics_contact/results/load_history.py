"""Results of the load steps of a run as curves, and losses in cycles of loads."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import cast

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    INDENTATION,
    KINETIC_ENERGY,
    NORMAL_FORCE,
    OBSTACLE_DISPLACEMENT,
    REACTION,
    STICK_AREA,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import ErrorRow
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.records.steps import CycleRecord, CyclesRecord, LoopRecord, StepRecord
from fenics_contact.scene.core_scene import LoadCycles
from fenics_contact.scene.quantity_names import LossOfCycle
from fenics_contact.scene.units.dimensions import UnitNames

_AXES = "xyz"
# What varies by less than this share of the largest stands still: a pressed obstacle that is moved
# sideways sinks in by next to nothing.
_STILL = 1e-3
# Called with number and record of every load step that was accepted.
Announce = Callable[[int, StepRecord], None]


@dataclass(frozen=True)
class Drive:
    """Something that is moved and what it takes, step by step.

    Attributes:
        title: What is moved, in words.
        moved: Words and symbol of how far.
        force: Words and symbol of what acts on the body there.
        x: How far (length).
        y: The force.
    """

    title: str
    moved: str
    force: str
    x: Array
    y: Array


@dataclass(frozen=True)
class History:
    """The load steps that have an answer.

    Attributes:
        steps: Their records.
        time: Pseudo-times.
    """

    steps: list[StepRecord]
    time: Array

    @classmethod
    def of(cls, result: Outcome) -> History:
        """Return the history of a run."""
        steps = [step for step in result.steps if step.quantities]
        return cls(steps, np.array([step.load_factor for step in steps]))

    @property
    def clock(self) -> str:
        """Name of its times: ``time`` where bodies move, else ``pseudo-time``."""
        return clock_of(self.steps)

    def quantity(self, name: str) -> Array:
        """A quantity of the whole model, (steps,) or (steps, components); no number if unknown."""
        return np.array([step.quantities[name] for step in self.steps], dtype=np.float64)

    def of_contact(self, number: int, name: str) -> Array | None:
        """A quantity of a contact, likewise; None where it is not known of every step."""
        found = [step.contacts[number].quantities.get(name) for step in self.steps]
        return None if any(value is None for value in found) else np.array(found)

    def drives(self, contacts: list[ContactRecord], far: tuple[str, ...] = ()) -> list[Drive]:
        """Obstacles and supports that are moved, and loads that vary.

        Args:
            contacts: Of the run.
            far: Names of supports that are none: they move as a half-space does.
        """
        return [*self._obstacles(contacts), *self._supports(far), *self._loads()]

    def _obstacles(self, contacts: list[ContactRecord]) -> Iterator[Drive]:
        for number, contact in enumerate(contacts):
            where = f"the obstacle at '{contact.name}'"
            depth = self.of_contact(number, INDENTATION)
            normal = self.of_contact(number, NORMAL_FORCE)
            if depth is not None and normal is not None and _varies(depth):
                yield Drive(where, r"indentation, $\delta$", "normal force, $P$", depth, normal)
            moved = self.of_contact(number, OBSTACLE_DISPLACEMENT)
            friction = self.of_contact(number, FRICTION_FORCE)
            if moved is not None and friction is not None and contact.carries_shear:
                yield from _along(where, moved, friction, "friction force", "Q")

    def _supports(self, far: tuple[str, ...]) -> Iterator[Drive]:
        for number, support in enumerate(self.steps[0].supports):
            if support.on in far:
                continue
            rows = [step.supports[number] for step in self.steps]
            held = [value is not None for value in support.displacement]
            means = np.array([row.displacement for row in rows], dtype=np.float64)
            moved = np.where(held, means, 0.0)
            reaction = np.array([row.reaction for row in rows], dtype=np.float64) * held
            where = f"the support '{support.name}'"
            yield from _along(where, moved, reaction, REACTION, "R")

    def _loads(self) -> Iterator[Drive]:
        for number, load in enumerate(self.steps[0].loads):
            rows = [step.loads[number] for step in self.steps]
            moved = np.array([row.displacement for row in rows])
            force = np.array([row.force for row in rows])
            if _varies(moved) and _varies(force):
                kind, on = load.name.split(" on ", 1)
                where = f"the {kind} on '{on}'"
                yield Drive(where, "displacement along it, $u$", "force, $F$", moved, force)


def _along(where: str, moved: Array, force: Array, word: str, symbol: str) -> Iterator[Drive]:
    """A drive along the axis, or the direction, in which something moves; none where it does not.

    Args:
        where: What is moved.
        moved: How far, (steps, components) (length).
        force: On the body, likewise.
        word: For the force.
        symbol: For the force.
    """
    if not _varies(moved):
        return
    farthest = moved[np.argmax(np.linalg.norm(moved - moved[0], axis=1))] - moved[0]
    direction = farthest / np.linalg.norm(farthest)
    axis = int(np.argmax(np.abs(direction)))
    name, along = _AXES[axis], ""
    if abs(direction[axis]) > 1 - 1e-6:
        direction = np.eye(len(direction))[axis]
    else:
        name, along = "s", f" along ({', '.join(f'{x:.2g}' for x in direction)})"
    yield Drive(
        where,
        f"displacement{along}, $u_{name}$",
        f"{word}, ${symbol}_{name}$",
        moved @ direction,
        force @ direction,
    )


def _varies(values: Array) -> bool:
    return bool(np.ptp(values, axis=0).max() > _STILL * np.abs(values).max())


def clock_of(steps: Sequence[StepRecord]) -> str:
    """Return the name of the steps' times: ``time`` where bodies move, else ``pseudo-time``."""
    moves = any(KINETIC_ENERGY in step.quantities for step in steps)
    return "time" if moves else "pseudo-time"


def newton_steps(number: int) -> str:
    """So many Newton steps, in words."""
    return f"{number} Newton step{'' if number == 1 else 's'}"


def step_line(number: int, step: StepRecord, units: UnitNames | None = None) -> str:
    """A load step in one line.

    Args:
        number: Counted from 1.
        step: Its record.
        units: Of the scene, if any.
    """
    own = registry.part_of_cycle(step.cycle, "words")
    if own is not None:
        return str(own.WORDS.step_line(step, units))
    area = "" if units is None else f" {units.of('area')}"
    found, passes = step.quantities, step.outer_iterations
    counted = f", {passes} pass{'es' if passes > 1 else ''}" if passes else ""
    return (
        f"step {number}: time {step.load_factor:.6g}, {newton_steps(step.newton_iterations)}"
        f"{counted}, contact area {found[CONTACT_AREA]:.4g}{area}, "
        f"sticking {found[STICK_AREA]:.4g}{area}"
    )


# Of pseudo-times that are the same.
_SAME = 1e-9


def cycles_record(
    steps: Sequence[StepRecord],
    contacts: list[ContactRecord],
    cycles: LoadCycles | None,
    far: tuple[str, ...] = (),
    errors: Mapping[LossOfCycle, ErrorRow] | None = None,
) -> CyclesRecord | None:
    """``cycles`` of ``result.json``; None where loads do not come again, or no cycle was done.

    Args:
        steps: Load steps that were accepted.
        contacts: Of the run.
        cycles: Those of the scene.
        far: Names of supports that are no drives: they move as a half-space does.
        errors: Estimated errors of the losses, where they were estimated.
    """
    accepted = [step for step in steps if step.quantities]
    ends = [number for number, step in enumerate(accepted) if step.cycle is not None]
    if cycles is None or not ends:
        return None
    history = History(accepted, np.array([step.load_factor for step in accepted]))
    drives = history.drives(contacts, far)
    own = registry.part_of_cycle(accepted[ends[0]].cycle, "words")
    if own is not None:
        return cast(CyclesRecord, own.cycles_record(accepted, cycles))
    begin = _before_cycles(history.time, cycles)
    begins = [begin, *ends[:-1]]
    spans = zip(begins, ends, strict=True)
    each = [_cycle(history, drives, *span, errors or {}) for span in spans]
    last = each[-1]
    # Of a run that was gone on with, earlier ones may have been closed with a larger tolerance.
    repeating = list(takewhile(lambda one: one.is_closed, reversed(each)))
    closed = repeating[-1].number if repeating else None
    repeats = 0 if closed is None else cycles.number - last.number
    return CyclesRecord(
        kind=last.kind,
        closed_in=closed,
        number=cycles.number,
        computed=len(each),
        loss=sum(one.loss for one in each) + repeats * last.loss,
        each=each,
        errors=_of_all([one.errors for one in each], repeats),
    )


def _of_all(rows: Sequence[ErrorRow], repeats: int) -> ErrorRow:
    """Errors of a sum.

    Args:
        rows: Of what is added.
        repeats: How often the last one comes again.
    """
    found: dict[str, float | None] = {}
    for source in rows[-1]:
        values = [row.get(source) for row in (*rows, *[rows[-1]] * repeats)]
        known = [value for value in values if value is not None]
        found[source] = sum(known) if len(known) == len(values) else None
    return found


def _before_cycles(times: Array, cycles: LoadCycles) -> int:
    """Number of the load step at which the first cycle begins; -1 where nothing comes before."""
    close = _SAME * cycles.repetition.period
    return int(np.searchsorted(times, cycles.begin + close)) - 1


def _cycle(
    history: History,
    drives: list[Drive],
    begin: int,
    end: int,
    errors: Mapping[LossOfCycle, ErrorRow],
) -> CycleRecord:
    """Return the record of a cycle.

    Args:
        history: Of the run.
        drives: What is moved in it.
        begin: Number of the load step before; -1 at the start.
        end: Of its last load step.
        errors: Of the losses of all cycles.
    """
    steps = history.steps
    last, before = steps[end], steps[begin] if begin >= 0 else None
    assert last.cycle is not None

    def since(name: str) -> float:
        return float(last.quantities[name] - (before.quantities[name] if before else 0.0))

    lost = {
        contact.name: contact.quantities[FRICTION_WORK]
        - (before.contacts[number].quantities[FRICTION_WORK] if before else 0.0)
        for number, contact in enumerate(last.contacts)
    }
    cycle, unknown = last.cycle.number, {"total": None}
    return CycleRecord(
        **last.cycle,
        steps=[begin + 2, end + 1],
        loss=since(FRICTION_WORK),
        work=since(EXTERNAL_WORK),
        contacts=lost,
        loops=[_loop(drive, begin, end) for drive in drives],
        errors=errors.get(LossOfCycle(cycle), unknown),
        contact_errors={
            name: errors.get(LossOfCycle(cycle, number), unknown)
            for number, name in enumerate(lost)
        },
    )


def _loop(drive: Drive, begin: int, end: int) -> LoopRecord:
    """Return the loop of a drive in a cycle; before the first load step all is 0."""
    moved, force = (
        np.concatenate([[0.0] if begin < 0 else [], values[max(begin, 0) : end + 1]])
        for values in (drive.x, drive.y)
    )
    work = float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(moved)))
    return LoopRecord(
        drive=drive.title, displacement=moved.tolist(), force=force.tolist(), work=work
    )
