"""Cycles that wear in words, and their losses, from the records of load steps."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.quantities.names import CONTACT_AREA, FRICTION_WORK, MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.results.records.record import UnitsRecord
from fenics_contact.results.records.steps import CycleRecord, CyclesRecord, StepRecord
from fenics_contact.results.tables import AnalysisWords, Rows, headed
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.units.dimensions import UnitNames


class _WearWords(AnalysisWords):
    def cycle_plan(self, cycles: Cycles) -> str:
        assert cycles.jumps is not None
        fixed = cycles.jumps.fixed
        if fixed is not None:
            jumps = -(-(cycles.number - 1) // fixed)
            solves = f"{jumps:,} jumps of {fixed} cycles"
        else:
            solves = f"as many jumps as errors below {100 * cycles.jumps.error:g} % take"
        return f"most are passed over, by {solves}, each of which computes two cycles"

    def step_line(self, step: StepRecord, units: UnitNames | None) -> str:
        assert step.cycle is not None and step.cycle.worn is not None
        area, volume = ("" if units is None else f" {units.of(of)}" for of in ("area", "volume"))
        return (
            f"cycle {step.cycle.number}: {step.cycle.worn.passed_over} before it passed over, "
            f"worn volume {step.quantities[WORN_VOLUME]:.4g}{volume}, "
            f"contact area {step.quantities[CONTACT_AREA]:.4g}{area}"
        )

    def cycles(self, cycles: CyclesRecord) -> str:
        last = cycles.each[-1]
        assert last.worn is not None
        errors = last.worn.errors
        return (
            f" {last.number} cycles wear, of which {cycles.computed} were computed; passing over "
            f"the others may be off by {errors[WORN_VOLUME]:.2g} in the worn volume, and by "
            f"{errors[MAX_WEAR_DEPTH]:.2g} in the deepest wear."
        )

    def cycle_rows(self, cycles: CyclesRecord, units: UnitsRecord | None) -> Rows:
        rows = [
            [
                "cycle",
                "passed over before",
                headed("loss", "energy", units),
                "change of pressures",
                headed("never slips", "area", units),
                "depth over half width",
                headed("± of worn volume", "volume", units),
                headed("± of deepest wear", "length", units),
            ]
        ]
        for one in cycles.each:
            worn = one.worn
            assert worn is not None
            rows.append(
                [
                    str(one.number),
                    str(worn.passed_over),
                    f"{one.loss:.5g}",
                    f"{worn.pressure_change:.2g}",
                    f"{sum(worn.stick_areas.values()):.4g}",
                    f"{worn.depth_over_width:.2g}",
                    f"{worn.errors[WORN_VOLUME]:.2g}",
                    f"{worn.errors[MAX_WEAR_DEPTH]:.2g}",
                ]
            )
        return rows


WORDS = _WearWords()


def cycles_record(steps: Sequence[StepRecord], cycles: Cycles) -> CyclesRecord:
    """``cycles`` of ``result.json``, where only the last load step of each cycle is known."""
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
