"""Losses of cycles that wear, most of which are passed over, from the records of load steps."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.quantities.names import FRICTION_WORK
from fenics_contact.results.records.cycles import CycleRecord, CyclesRecord
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.loading.cycles import Cycles


def cycles_record(steps: Sequence[StepRecord], cycles: Cycles) -> CyclesRecord:
    """``cycles`` of ``result.json``, where only the last load step of each cycle is known.

    Args:
        steps: Those load steps.
        cycles: Of the scene.
    """
    each = []
    for number, step in enumerate(steps, start=1):
        end = step.cycle
        assert end is not None and end.worn is not None
        each.append(
            CycleRecord(
                **end,
                steps=[number, number],
                loss=float(sum(end.worn.losses.values())),
                work=None,
                contacts=end.worn.losses,
                errors={"total": None},
            )
        )
    works = [step.quantities[FRICTION_WORK] for step in (steps[0], steps[-1])]
    return CyclesRecord(
        kind="",
        closed_in=None,
        number=cycles.number,
        computed=len(each),
        loss=works[1] - works[0] + each[0].loss,
        each=each,
        errors={"total": None},
    )
