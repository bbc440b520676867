"""Wear over many cycles, most of them passed over: against formulas, and against all of them."""

import csv
import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    CycleJump,
    Cycles,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    Wear,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import on_root
from tests.contact.wear.test_archard import MU, ROUGH, worn
from tests.messages import refused
from tests.scenes import box_body
from tests.solve.load_steps.histories import dragged

COMM = MPI.COMM_WORLD
SPRING, DEPTH, WAY = 500.0, 0.01, 4.0
TO_AND_FRO = Path(time=(1, 2, 4, 5), factor=(0, 1, -1, 0))


def on_springs(k, **contact):
    """A stiff block on springs; a plane pressed in by a depth rubs to and fro on it, 4 a cycle."""
    plane = Obstacle(
        gap=lambda x: 0 * x[0] - DEPTH,
        direction=(0, 1),
        displacement=(1.0, 0),
        displacement_path=TO_AND_FRO,
    )
    return Scene(
        kinematics="plane strain",
        material=Material(1e9, 0.0),
        support=(Support("y1", {"x": 0, "y": 0}),),
        contact=(
            Contact("y0", obstacle=plane, foundation_stiffness=SPRING, wear=Wear(k), **contact),
        ),
        steps=Steps(number=5, end=5),
        solver=SolverSettings(errors="none"),
    )


def study_of(scene, cells=(2, 1), sizes=(2, 1)):
    return Study(scene, COMM, box_body(cells, sizes))


def last_of(study, cycles, jumps=None):
    return list(study.wear_cycles(1.0, cycles, jumps))[-1]


def test_springs_follow_the_exponential_at_second_order():
    """p = p₀ exp(−k K v t): to 1e-4 with 50 jumps, and four times nearer with twice as many."""
    cycles, found = 10_001, {}
    k = 1 / (SPRING * WAY * cycles)
    study = study_of(on_springs(k))
    for jumps in (5, 10, 50):
        last = last_of(study, cycles, CycleJump(fixed=cycles // jumps))
        assert last.number == cycles
        off = last.points.contact_pressure - SPRING * DEPTH * np.exp(-1)
        found[jumps] = np.abs(off).max() / (SPRING * DEPTH * np.exp(-1))
        assert last.errors["max_wear_depth"] > np.abs(off).max() / SPRING
    assert found[50] < 1e-4
    assert found[5] / found[10] == pytest.approx(4, rel=0.2)


def test_where_all_slips_the_volume_is_that_of_the_work():
    scene = on_springs(1e-6, **ROUGH)
    every = list(study_of(scene).wear_cycles(1.0, 500))
    assert len(every) < 50
    assert [cycle.number for cycle in every] == sorted({cycle.number for cycle in every})
    assert sum(1 + cycle.passed_over for cycle in every) == 500 == every[-1].number
    assert every[-1].pressure_change > 0
    for cycle in every:
        assert cycle.worn_volume == pytest.approx(1e-6 / MU * cycle.friction_work, rel=1e-10)
        points = cycle.points
        assert cycle.max_wear_depth == pytest.approx(points.own["worn_depth"].max(), rel=1e-12)
        assert cycle.worn_volume == pytest.approx(
            np.sum(points.weights * points.own["worn_depth"]), rel=1e-12
        )
        # In a cycle the springs have what the depth leaves, but for that cycle's own wear.
        left = SPRING * (DEPTH - points.own["worn_depth"])
        np.testing.assert_allclose(points.contact_pressure, left, rtol=5e-3)


def fretting(increments=8):
    """A parabola pressed onto a block, then moved to and fro so that the middle sticks."""
    scene = worn(dragged(Steps(1)), 2e-3)
    contact = scene.contact[0]
    obstacle = dataclasses.replace(
        contact.obstacle,
        displacement=(0.005, 0),
        path=Path(time=(0, 1), factor=(0, 1)),
        displacement_path=TO_AND_FRO,
    )
    times = (0.5, 1.0, *(1 + 4 * (1 + np.arange(increments)) / increments).tolist())
    return dataclasses.replace(
        scene,
        contact=(dataclasses.replace(contact, obstacle=obstacle),),
        steps=Steps(times=times),
    )


def test_cycles_that_are_passed_over_are_worn_as_if_they_were_not():
    """Partial slip: within the estimated error of what all cycles give; the middle stays."""
    study = study_of(fretting(), (24, 5), (1, 1))
    whole = last_of(study, 14, CycleJump(fixed=1))
    every = list(study.wear_cycles(1.0, 14, CycleJump(error=0.05)))
    last = every[-1]
    assert len(every) < 10
    for name in ("max_wear_depth", "worn_volume"):
        found, expected = getattr(last, name), getattr(whole, name)
        assert abs(found - expected) < last.errors[name] < 0.05 * expected
    stuck = last.points.status == "STICK"
    assert stuck.any()
    assert last.points.own["worn_depth"][stuck].min() < 1e-3 * last.max_wear_depth
    # Where the middle carries more, the rest carries less.
    first = every[0].points.contact_pressure
    assert last.points.contact_pressure.max() > first.max()


def test_cycles_of_one_are_those_of_a_run():
    """Three cycles as load steps of one run, whose path repeats them."""
    k = 1e-4
    scene = on_springs(k, **ROUGH)
    path = Path(time=(1, 2, 4, 6, 8, 10, 12, 13), factor=(0, 1, -1, 1, -1, 1, -1, 0))
    contact = scene.contact[0]
    obstacle = dataclasses.replace(contact.obstacle, displacement_path=path)
    whole = dataclasses.replace(
        scene,
        contact=(dataclasses.replace(contact, obstacle=obstacle),),
        steps=Steps(number=13, end=13),
    )
    expected = Run(whole, COMM, box_body((2, 1), (2, 1))).solve()
    found = last_of(study_of(scene), 3, CycleJump(fixed=1))
    # Each cycle begins with the gap that all before left; in the run, steps lag behind by one.
    assert found.worn_volume == pytest.approx(expected.quantities["worn_volume"], rel=0.05)
    assert found.friction_work == pytest.approx(expected.quantities["friction_work"], rel=0.05)


def test_cycles_of_the_scene_are_taken():
    scene = on_springs(1e-5, law="incremental")
    said = Cycles(begin=1, end=5, number=6, increments=4, until="end")
    scene = dataclasses.replace(scene, cycles=said, steps=Steps(times=(1.0, 5.0)))
    found = list(study_of(scene).wear_cycles(jumps=CycleJump(fixed=2)))
    expected = list(study_of(on_springs(1e-5)).wear_cycles(1.0, 6, CycleJump(fixed=2)))
    assert [cycle.number for cycle in found] == [1, 3, 5, 6]
    for one, other in zip(found, expected, strict=True):
        assert one.worn_volume == pytest.approx(other.worn_volume, rel=1e-9)
    with refused("wear_with_a_closed_loop", SceneError):
        dataclasses.replace(scene, cycles=dataclasses.replace(said, until="closed"))


def test_what_the_way_to_the_first_cycle_wears_is_worn_once():
    """Where wear is too little to change the pressure it is k F times the way, jumps or not."""
    scene = on_springs(1e-9, **ROUGH)
    contact = scene.contact[0]
    there = Path(time=(0.5, 1, 2, 4, 5), factor=(-10, 0, 1, -1, 0))
    plane = dataclasses.replace(contact.obstacle, displacement_path=there)
    scene = dataclasses.replace(
        scene,
        contact=(dataclasses.replace(contact, obstacle=plane),),
        steps=Steps(times=(0.25, 0.5, 1, 2, 4, 5)),
    )
    jumps = (CycleJump(fixed=count) for count in (1, 10))
    each, far = (list(study_of(scene).wear_cycles(1.0, 11, jump))[-1] for jump in jumps)
    in_cycles = 11 * 1e-9 * SPRING * DEPTH * 2 * WAY
    assert each.worn_volume > 1.1 * in_cycles
    assert far.worn_volume == pytest.approx(each.worn_volume, rel=1e-6)
    assert far.friction_work == pytest.approx(each.friction_work, rel=1e-6)


def test_tables_of_the_cycles(folder):
    """They have the cycles that were computed before the last was asked for."""
    cycles, done = study_of(on_springs(1e-5, **ROUGH)).wear_cycles(1.0, 50, folder=folder), []
    for cycle in cycles:
        done.append(cycle)
        if len(done) == 4:
            break
    cycles.close()

    def read():
        with (folder / "wear.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert [int(row["cycle"]) for row in rows] == [cycle.number for cycle in done]
        for row, cycle in zip(rows, done, strict=True):
            assert float(row["worn_volume"]) == pytest.approx(cycle.worn_volume, rel=1e-12)
            assert float(row["depth_over_width"]) == pytest.approx(cycle.max_wear_depth, rel=1e-9)
            assert float(row["stick_area"]) == cycle.contacts[0]["stick_area"]
        with (folder / "wear_profiles.csv").open(newline="") as file:
            rows = [row for row in csv.DictReader(file) if int(row["cycle"]) == done[-1].number]
        points = done[-1].points
        found = [float(row["worn_depth"]) for row in rows]
        np.testing.assert_allclose(found, points.own["worn_depth"], rtol=1e-12)
        assert [row["status"] for row in rows] == points.status.tolist()

    on_root(COMM, read)


def test_what_is_no_cycle_is_refused():
    scene = on_springs(1e-6)
    with refused("cycle_begins_within_a_step"):
        list(study_of(scene).wear_cycles(0.5, 3))
    smooth = dataclasses.replace(scene, contact=(dataclasses.replace(scene.contact[0], wear=None),))
    with refused("cycles_without_wear"):
        list(study_of(smooth).wear_cycles(1.0, 3))
    with refused("neither_begin_nor_cycles"):
        list(study_of(scene).wear_cycles())
    with refused("no_cycles"):
        list(study_of(scene).wear_cycles(1.0, 0))
    with refused("cycles_of_displacement_do_not_come_back"):
        list(study_of(dataclasses.replace(scene, steps=Steps(times=(1, 2, 4)))).wear_cycles(1.0, 3))
    said = Cycles(begin=1, end=5, until="end", increments=4)
    with refused("cycle_begins_at_zero"):
        list(study_of(dataclasses.replace(scene, cycles=said)).wear_cycles(begin=0.0))
    with refused("cycle_jump_error_is_negative"):
        CycleJump(error=-1)
