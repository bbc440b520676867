"""What `check` says of cycles and of wear, before anything is solved."""

import dataclasses

import pytest

from fenics_contact import CycleJump, Cycles, Steps, Wear
from fenics_contact.cli.summary import cycle_plan
from tests.analyses.wear_cycles.test_cycles_of_run import scene
from tests.simulation.cycles.test_cycles import BAR
from tests.solve.load_steps.histories import shoved


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"number": 10_000},
            "Cycles: 10,000 of 8 load steps each, the first from time 1 to 5",
        ),
        ({}, "by as many jumps as errors below 5 % take, each of which computes two cycles"),
        ({"jumps": CycleJump(fixed=4)}, "by 4 jumps of 4 cycles"),
        ({"jumps": None, "until": "end"}, "Cycles: 14 of 8 load steps each, 112 load steps, the"),
    ],
)
def test_how_many_load_steps_cycles_take(changes, said):
    cycles, wear = cycle_plan(scene(**changes), None)
    assert said in cycles
    assert wear == "Wear at 'y1', at each point that slips: Archard's law, k 0.002"


def test_loops_that_close_and_automatic_steps():
    (said,) = cycle_plan(BAR, None)
    assert said.startswith("Cycles: 50 of 8 load steps each, 400 load steps, the first")
    assert said.endswith("; none after the loop is closed")
    steps, cycles = Steps(automatic=True, end=5), Cycles(end=5, begin=1)
    automatic = dataclasses.replace(BAR, steps=steps, cycles=cycles)
    assert "20 of automatic load steps, the first" in next(cycle_plan(automatic, None))


def test_who_loses_how_much():
    pair = shoved(Steps(2))
    wear = Wear(lambda x: 0 * x[0], threshold=2.5, share=0.3)
    pair = dataclasses.replace(pair, contact=(dataclasses.replace(pair.contact[0], wear=wear),))
    (said,) = cycle_plan(pair, None)
    assert "k that varies, above a pressure of 2.5; " in said
    assert said.endswith(f"'{pair.contact[0].on}' loses 30 % of the depth")
