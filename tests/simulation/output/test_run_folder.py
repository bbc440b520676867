"""Files of load steps, written as they are accepted, and the curves drawn from them."""

import csv
import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Path, Run, Scene, Steps, Support
from fenics_contact.common.parallel import on_root
from fenics_contact.report import report
from fenics_contact.report.contacts.film import FEWEST_STEPS
from fenics_contact.report.load_steps import draw_history
from fenics_contact.results.load_history import History
from fenics_contact.simulation.output import run_folder as files
from tests.report.test_gallery import draw_coarsely, pixels
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
STEPS = 12
TO_AND_FRO = Path(time=(0.25, 0.5, 0.75, 1), factor=(0, 1, -1, 1))


def cycled(steps=STEPS, kinematics="plane strain"):
    """A block under a flat rough obstacle that is pressed on, then moved to and fro."""
    flat = kinematics != "3D"
    motion = (0.02, 0) if flat else (0.02, 0.01, 0)
    obstacle = Obstacle(
        indentation=0.02,
        path=Path(time=(0, 0.25), factor=(0, 1)),
        displacement=motion,
        displacement_path=TO_AND_FRO,
    )
    bottom, top = ("y0", "y1") if flat else ("z0", "z1")
    held = dict.fromkeys("xy" if flat else "xyz", 0)
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support(bottom, held),),
        contact=(Contact(top, obstacle=obstacle, friction_coefficient=0.3, law="incremental"),),
        steps=Steps(steps),
    )


def block(comm=COMM, cells=(8, 4)):
    return box_body(cells, (2, 1, 1), comm=comm)


def rows_of(folder):
    with (folder / "steps.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def series(folder):
    """Pseudo-times of ``fields.pvd``, and a function that reads the body at one of them."""
    import pyvista

    reader = pyvista.get_reader(str(folder / "fields.pvd"))

    def body(time):
        reader.set_active_time_value(time)
        return reader.read().combine()

    return reader.time_values, body


def test_every_step_is_on_disk_when_it_is_accepted(folder):
    prepared = Run(cycled(), COMM, block())
    written, found = files.StepFiles(prepared, folder), []

    def accepted():
        written.add()
        on_root(COMM, lambda: found.append(len(rows_of(folder))))

    result = prepared.solve(accepted=accepted)
    rows = on_root(COMM, lambda: rows_of(folder))
    if COMM.rank == 0:
        assert found == list(range(1, STEPS + 1))
    for number, (row, step) in enumerate(zip(rows, result.steps, strict=True), start=1):
        assert int(row["step"]) == number
        assert float(row["time"]) == step["load_factor"]
        assert int(row["newton_iterations"]) == step["newton_iterations"]
        quantities = step["quantities"]
        assert float(row["friction_force_x"]) == quantities["friction_force"][0]
        for name, value in quantities.items():
            assert isinstance(value, list) or float(row[name]) == value, name


def test_fields_are_a_time_series(folder):
    pytest.importorskip("pyvista")
    prepared, found = Run(cycled(), COMM, block()), {}
    written = files.StepFiles(prepared, folder)

    def accepted():
        written.add()
        displacement = prepared.forces.solution.displacement
        size = COMM.allreduce(np.abs(displacement).max(initial=0), op=MPI.MAX)
        found[prepared.steps[-1]["load_factor"]] = size

    assert prepared.solve(accepted=accepted).passed

    def read():
        times, body = series(folder)
        assert times == list(found)
        # whatever ranks wrote which of the cells: all facets of the upper side, once
        flags = np.asarray(body(times[-1]).cell_data["facets of y1"])
        assert len(flags) == 8 * 4 and np.unpackbits(flags).sum() == 8
        assert (np.asarray(body(times[-1]).cell_data["body"]) == 0).all()
        for time, size in found.items():
            assert np.abs(body(time)["displacement"]).max() == size

    on_root(COMM, read)


@pytest.mark.serial
def test_a_run_that_is_killed_leaves_what_it_had(tmp_path):
    pytest.importorskip("pyvista")
    prepared = Run(cycled(), MPI.COMM_SELF, block(MPI.COMM_SELF))
    written = files.StepFiles(prepared, tmp_path)

    def accepted():
        written.add()
        if len(prepared.steps) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        prepared.solve(accepted=accepted)
    assert len(rows_of(tmp_path)) == 3
    times, body = series(tmp_path)
    assert times == [step["load_factor"] for step in prepared.steps]
    assert np.ptp(body(times[-1])["stress"]) > 0
    assert not (tmp_path / "result.json").exists()
    # and the next run in the folder begins anew
    files.StepFiles(prepared, tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.serial
def test_a_run_without_an_answer_leaves_its_steps(tmp_path):
    """A block between rough pads, pulled on the way harder than these can hold it.

    By a function, so that this is not seen beforehand.
    """
    pulled = Load("x1", traction=(3, 0), path=Path(time=(0, 0.5, 1), factor=(0, 1, 0.1)).__call__)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(pulled,),
        contact=(Contact("y1", pressure=20, friction_coefficient=0.05, law="incremental"),),
        steps=Steps(8),
    )
    result = files.solve_and_write(Run(scene, MPI.COMM_SELF, block(MPI.COMM_SELF)), tmp_path)
    assert not result.converged
    assert len(rows_of(tmp_path)) == len(result.steps) - 1 == 2


@pytest.mark.parametrize(("steps", "most", "count"), [(12, 200, 12), (1, 200, 1), (1001, 200, 200)])
def test_fields_are_spread_evenly_over_many_steps(steps, most, count):
    every = Steps(steps)
    times = every.all_times
    pairs = zip((0.0, *times), times, strict=False)
    chosen = np.array([b for a, b in pairs if files.is_kept(every, b, a, most)])
    assert len(chosen) == count and chosen[-1] == times[-1]
    assert np.ptp(np.diff(chosen, prepend=0)) <= 1.01 / steps


def test_several_contacts_have_columns_of_their_own(folder):
    scene = cycled(2)
    pad = Contact("x1", pressure=1, name="pad")
    scene = dataclasses.replace(scene, contact=(*scene.contact, pad))
    result = files.solve_and_write(Run(scene, COMM, block()), folder)
    row = on_root(COMM, lambda: rows_of(folder))[-1]
    for contact in result.contacts:
        name = f"{contact['name']}.normal_force"
        assert float(row[name]) == contact["quantities"]["normal_force"]


def test_rows_are_those_of_any_number_of_ranks(folder):
    files.solve_and_write(Run(cycled(3), COMM, block()), folder / "together")
    rows = on_root(COMM, lambda: rows_of(folder / "together"))
    alone = Run(cycled(3), MPI.COMM_SELF, block(MPI.COMM_SELF)).solve()
    for row, step in zip(rows, alone.steps, strict=True):
        for name in ("normal_force", "external_work", "friction_work", "strain_energy"):
            expected = pytest.approx(step["quantities"][name], rel=1e-8, abs=1e-8)
            assert float(row[name]) == expected


def share_drawn(picture):
    """The share of a picture that is not white."""
    return np.mean(pixels(picture).min(axis=-1) < 0.9)


HISTORY = {f"history_{name}.png" for name in ("energy", "forces", "areas", "loops")}


@pytest.mark.serial
def test_curves_over_the_steps(tmp_path, monkeypatch):
    pytest.importorskip("pyvista")
    draw_coarsely(monkeypatch)
    prepared = Run(cycled(FEWEST_STEPS - 1), MPI.COMM_SELF, block(MPI.COMM_SELF, (4, 2)))
    assert files.solve_and_write(prepared, tmp_path).passed
    names = {picture.path.name for picture in report.write_report(tmp_path)}
    assert names >= HISTORY
    assert all(share_drawn(tmp_path / name) > 0.02 for name in HISTORY)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert all(name in page for name in HISTORY)


@pytest.mark.serial
def test_curves_over_the_steps_in_space(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    draw_coarsely(monkeypatch)
    prepared = Run(cycled(kinematics="3D"), MPI.COMM_SELF, block(MPI.COMM_SELF, (2, 2, 1)))
    result = prepared.solve()
    assert {picture.path.name for picture in draw_history(tmp_path, result)} == HISTORY
    assert all(share_drawn(tmp_path / name) > 0.02 for name in HISTORY)


def test_loops_hold_the_work_that_was_done():
    """∮ P dδ + ∮ Q du by the trapezoidal rule is the external work, whatever moves."""
    scene = cycled()
    by_obstacle = Run(scene, COMM, block()).solve()
    turned = dataclasses.replace(scene.contact[0], obstacle=None)
    supports = (
        Support("y0", {"y": 0.02}, path=Path(time=(0, 0.25), factor=(0, 1))),
        Support("y0", {"x": -0.02}, path=TO_AND_FRO),
    )
    by_support = Run(
        dataclasses.replace(scene, contact=(turned,), support=supports), COMM, block()
    ).solve()
    for result, symbols in ((by_obstacle, "PQ"), (by_support, "RR")):
        drives = History.of(result).drives(result.contacts)
        assert [drive.force.split("$")[1][0] for drive in drives] == list(symbols)
        done = sum(
            float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))
            for x, y in ((np.append(0, drive.x), np.append(0, drive.y)) for drive in drives)
        )
        assert done == pytest.approx(result.quantities["external_work"], rel=1e-9)
    work = [r.quantities["external_work"] for r in (by_obstacle, by_support)]
    assert work[0] == pytest.approx(work[1], rel=1e-6)
