"""A law of one file that declares arrays of its own: files, load steps and pictures have them."""

import csv
import dataclasses
import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Run, Scene, Support
from fenics_contact.common.parallel import on_root
from fenics_contact.contact.laws import friction
from fenics_contact.contact.laws.friction.slip_laws import Incremental, Static
from fenics_contact.results.contact_points import (
    CSV_HEADER,
    ContactTable,
    PointArray,
    of_one_contact,
    of_several_contacts,
)
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.solve.load_steps.accepted_step import recall, remember
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.output.test_run_folder import block, cycled, series
from tests.simulation.restart.test_state_file import resumed, stopped_after

COMM = MPI.COMM_WORLD
STEPS = 8


class Polished(Incremental):
    """Coulomb's friction that also counts how far each point has slid, and where to."""

    state = (
        *Incremental.state,
        PointArray("slid_way", "length"),
        PointArray("drift", "length", is_vector=True),
    )

    def __init__(self, site, normal, rule):
        super().__init__(site, normal, rule)
        self.slid_way = np.zeros(len(site.trace.weights))
        self.drift = np.zeros_like(site.trace.normals)

    def at_step_end(self, state):
        step = self.effective_slip(state.slip)
        return {
            "slid_way": self.slid_way + np.linalg.norm(step, axis=1),
            "drift": self.drift + step,
        }


@pytest.fixture
def polished(monkeypatch):
    """It takes the place of the incremental law."""
    monkeypatch.setattr(friction, "LAWS", (Polished, Static))


def slid_by_its_slip(prepared):
    """Solves, and adds up how far the slip of the points went from step to step."""
    contact, ways = prepared.problem.contacts[0], [0.0]
    last = [np.zeros_like(contact.trace.normals)]

    def accepted():
        slip = prepared.solution.states[0].slip
        ways.append(ways[-1] + np.linalg.norm(slip - last[-1], axis=1))
        last.append(slip)

    return accepted, ways


def test_they_are_what_the_way_through_the_load_steps_made_them(polished):
    prepared = Run(cycled(STEPS), COMM, block())
    accepted, ways = slid_by_its_slip(prepared)
    result = prepared.solve(accepted=accepted)
    assert result.passed, result.verdict
    contact, state = prepared.problem.contacts[0], prepared.solution.states[0]
    np.testing.assert_allclose(state.own["slid_way"], ways[-1], atol=1e-12)
    np.testing.assert_allclose(state.own["drift"], state.slip, atol=1e-12)
    way = result.points.own["slid_way"]
    longer = way / np.linalg.norm(result.points.slip, axis=1)
    assert longer.min() > 1 - 1e-9
    assert longer.max() > 2  # to and fro
    assert result.points.own["drift"].shape == (len(way), 3)
    mine = contact.trace.integral(state.own["slid_way"])
    assert mine == pytest.approx(np.sum(result.points.weights * way), rel=1e-12)


def test_a_step_that_is_rejected_leaves_no_trace(polished):
    prepared = Run(cycled(STEPS), COMM, block())
    prepared.solve()
    contact, state = prepared.problem.contacts[0], prepared.solution.states[0]
    kept, before = remember(contact), contact.friction.slid_way.copy()
    contact.accept()
    np.testing.assert_array_equal(contact.friction.slid_way, state.own["slid_way"])
    assert np.abs(contact.friction.slid_way - before).max(initial=0.0) > 0
    recall(contact, kept)
    np.testing.assert_array_equal(contact.friction.slid_way, before)
    np.testing.assert_array_equal(contact.state().own["slid_way"], state.own["slid_way"])


def test_a_run_that_is_resumed_has_them_as_a_whole_run(polished, folder):
    whole = Run(cycled(STEPS), COMM, block()).solve()
    if COMM.rank == 0:
        stopped_after(cycled(STEPS), block(MPI.COMM_SELF), folder, 5)
    COMM.barrier()
    found = resumed(cycled(STEPS), block(), folder)
    for name, values in whole.points.own.items():
        np.testing.assert_allclose(found.points.own[name], values, atol=1e-7 * np.abs(values).max())


def test_files_have_them(polished, folder):
    """Behind the columns that every run has, and in the fields of every load step."""
    pytest.importorskip("pyvista")
    prepared = Run(cycled(STEPS), COMM, block())
    result = files.solve_and_write(prepared, folder)

    def read():
        with (folder / "contact.csv").open(newline="") as file:
            head = next(csv.reader(file))
        assert head == [*CSV_HEADER, "slid_way", "drift_x", "drift_y", "drift_z"]
        table = ContactTable.read(folder / "contact.csv")
        way, own = table.numbers["slid_way"], result.points.own
        np.testing.assert_allclose(way, own["slid_way"], rtol=1e-7, atol=1e-12)
        np.testing.assert_allclose(
            table.vectors("drift_x", "drift_y", "drift_z"), own["drift"], rtol=1e-7, atol=1e-12
        )
        said = json.loads((folder / "result.json").read_text(encoding="utf-8"))["contacts"][0]
        assert [(array["name"], array["unit"]) for array in said["arrays"]] == [
            ("slid_way", "length"),
            ("drift", "length"),
        ]
        times, body = series(folder)
        largest = [body(time)["slid_way"].max() for time in times]
        assert len(times) == STEPS
        assert np.all(np.diff(largest) >= 0)
        assert largest[-1] == pytest.approx(way.max(), rel=1e-7)
        last = body(times[-1])
        assert last["drift"].shape[1] == 3
        assert not last["slid_way"][last["status"] < 0].any()

    on_root(COMM, read)


def test_a_contact_whose_law_has_none_has_no_number_there(polished, folder):
    """Two pads, of which one is polished."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x1", traction=(60, 0)),),
        contact=(
            Contact("left", pressure=20, friction_coefficient=0.2, law="static"),
            Contact("right", pressure=30, friction_coefficient=0.4, law="incremental"),
        ),
    )
    patches = {"left": ("y1", lambda x: x[0] < 1), "right": ("y1", lambda x: x[0] > 1)}
    prepared = Run(scene, COMM, box_body((16, 4), (2, 0.5), patches=patches))
    result = files.solve_and_write(prepared, folder)
    right = result.points.contact == 1
    assert np.isfinite(result.points.own["slid_way"][right]).all()
    assert result.points.own["slid_way"][right].max() > 0
    assert np.isnan(result.points.own["drift"][~right]).all()
    assert ["arrays" in contact for contact in result.contacts] == [False, True]

    def read():
        way = ContactTable.read(folder / "contact.csv").numbers["slid_way"]
        np.testing.assert_array_equal(np.isnan(way), ~right)

    on_root(COMM, read)


def test_laws_without_any_change_no_file():
    contact = Run(cycled(STEPS), COMM, block()).problem.contacts[0]
    assert contact.own_arrays == ()
    assert contact.state().own == {}


@pytest.mark.parametrize("name", ["gap", "status", "traction", "displacement", "slid"])
def test_a_name_that_is_taken_is_refused(name):
    other = PointArray("slid", "length")
    with refused("array_name_is_taken", ValueError, array=name):
        of_one_contact((other,), (PointArray(name, "length"),))


def test_laws_of_two_contacts_declare_an_array_alike():
    array = PointArray("slid", "length")
    assert of_several_contacts([array, array]) == (array,)
    with refused("array_declared_differently", ValueError):
        of_several_contacts([array, dataclasses.replace(array, is_vector=True)])
