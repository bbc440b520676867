"""Losses in cycles of loads, from the records of load steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import cast

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import EXTERNAL_WORK, FRICTION_WORK
from fenics_contact.results.load_history import Drive, History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.cycles import (
    CycleRecord,
    CyclesRecord,
    LoopRecord,
)
from fenics_contact.results.records.record import ErrorRow
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.quantity_names import LossOfCycle

# Of pseudo-times that are the same.
_SAME = 1e-9


def cycles_record(
    steps: Sequence[StepRecord],
    contacts: list[ContactRecord],
    cycles: Cycles | None,
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
    own = registry.part_of_cycle(accepted[ends[0]].cycle, "losses")
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


def _before_cycles(times: Array, cycles: Cycles) -> int:
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
