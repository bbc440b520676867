"""Archard's wear over load steps: worn volumes and pressures against formulas, and going back."""

import csv
import dataclasses
import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Material,
    Obstacle,
    Path,
    Profile,
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
from fenics_contact.results.contact_points import CSV_HEADER
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.solve.load_steps.accepted_step import recall, remember
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.solve.load_steps.histories import block, dragged, require_same, shoved, two_blocks

COMM = MPI.COMM_WORLD
K, MU = 2e-4, 0.3
SPRING, DEPTH, WAY = 500.0, 0.01, 8.0
ROUGH = {"law": "incremental", "friction_coefficient": MU}
# Pressed in the first tenth of the path, then dragged.
PRESS = Path(time=(0, 0.1), factor=(0, 1))
DRAG = Path(time=(0.1, 1.1), factor=(0, 1))


def on_springs(steps, wear, slope=0.0, stiffness=1e9, **contact):
    """A block on springs against a plane that is pressed in, then dragged along at a fixed depth.

    Args:
        steps: While it is dragged.
        wear: Of the contact.
        slope: Of the obstacle.
        stiffness: Of the block.
        contact: Other keys of the contact.
    """
    plane = Obstacle(
        gap=lambda x: slope * x[0] - DEPTH,
        direction=(0, 1),
        displacement=(WAY, 0),
        displacement_path=DRAG,
    )
    more = {"interference": 0.0} | contact
    return Scene(
        kinematics="plane strain",
        material=Material(stiffness, 0.0),
        support=(Support("y1", {"x": 0, "y": 0}),),
        contact=(Contact("y0", obstacle=plane, foundation_stiffness=SPRING, wear=wear, **more),),
        steps=Steps(times=(0.1, *(0.1 + (1 + np.arange(steps)) / steps).tolist())),
        solver=SolverSettings(errors="none"),
    )


def solved(scene, cells=(4, 2)):
    prepared = Run(scene, COMM, box_body(cells, (2, 1)))
    result = prepared.solve()
    assert result.passed, result.verdict
    return prepared, result


@pytest.mark.parametrize("slope", [0.0, 0.003])
def test_where_all_slips_the_volume_is_that_of_the_work(slope):
    """V = (k/μ) W, on a body that gives way under pressures that differ from point to point."""
    _, result = solved(on_springs(6, Wear(K), slope, 2e3, **ROUGH))
    found = result.quantities
    assert (result.points.status == "SLIP").all()
    assert found["worn_volume"] == pytest.approx(K / MU * found["friction_work"], rel=1e-10)
    depth = result.points.own["worn_depth"]
    assert np.sum(result.points.weights * depth) == pytest.approx(found["worn_volume"], rel=1e-12)
    assert depth.max() == found["max_wear_depth"]
    assert depth.max() > 0.1 * DEPTH
    # All is slip from the second step on: what the springs lose to wear, the work has.
    defects = [step.quantities["energy_defect"] for step in result.steps]
    assert np.ptp(defects[1:]) < 1e-9 * found["external_work"]


@pytest.mark.parametrize(("contact", "threshold"), [({}, 0.0), (ROUGH, 0.0), ({}, 2.0)])
def test_springs_lose_their_pressure_exponentially(contact, threshold):
    """p = p₀ exp(−k K v t), above a threshold likewise, at the first order of the load steps."""
    p, errors = SPRING * DEPTH, []
    for steps in (16, 32):
        _, result = solved(on_springs(steps, Wear(K, threshold), **contact))
        expected = threshold + (p - threshold) * np.exp(-K * SPRING * WAY * (1 - 1 / steps))
        found = result.points.contact_pressure
        assert np.ptp(found) < 1e-6 * p
        errors.append(found[0] - expected)
    assert abs(errors[1]) < 0.02 * p
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.15)


def test_the_coefficient_may_follow_the_place():
    wear = Wear(Profile(along="x", at=(0, 2), values=(0, K)))
    _, result = solved(on_springs(4, wear))
    points = result.points
    p0 = SPRING * DEPTH
    pressures, worn = np.full(len(points.gap), p0), np.zeros(len(points.gap))
    for _ in range(4):  # the law's own recursion, at every point by itself
        now = p0 - SPRING * worn
        worn += K * points.coordinates[:, 0] / 2 * 0.5 * (pressures + now) * WAY / 4
        pressures = now
    np.testing.assert_allclose(points.own["worn_depth"], worn, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(points.contact_pressure, pressures, rtol=1e-5)


def worn(scene, k=0.05, share=None):
    contact = dataclasses.replace(scene.contact[0], wear=Wear(k, share=share))
    return dataclasses.replace(scene, contact=(contact,))


def test_each_body_of_a_pair_has_its_part():
    """Whose part is how large changes nothing of the answer; both together are what is lost."""
    first, second = (
        Run(worn(shoved(Steps(4)), 1e-3, share), COMM, two_blocks()).solve()
        for share in (0.25, None)
    )
    found, points = first.quantities, first.points
    lost = float(np.sum(points.weights * points.own["worn_depth"]))
    assert lost > 0
    assert found["worn_volume_on"] == pytest.approx(lost / 4, rel=1e-10)
    assert found["worn_volume_against"] == pytest.approx(3 * lost / 4, rel=1e-10)
    deepest = points.own["worn_depth"].max()
    assert found["max_wear_depth_on"] == pytest.approx(deepest / 4, rel=1e-12)
    assert found["max_wear_depth_against"] == pytest.approx(3 * deepest / 4, rel=1e-12)
    assert found["worn_volume"] == pytest.approx(second.quantities["worn_volume"], rel=1e-10)
    assert "worn_volume_on" not in second.quantities
    assert first.contacts[0].quantities["worn_volume_on"] == found["worn_volume_on"]


def test_parts_of_what_is_no_pair_are_refused():
    with refused("wear_share_of_one_body", SceneError):
        worn(dragged(Steps(1)), share=0.5)
    with refused("wear_share_above_1", SceneError):
        Wear(K, share=1.5)


def test_points_that_stick_are_not_worn():
    """Partial slip of a parabola: points that never slip keep their surface, all others lose."""
    scene = worn(dragged(Steps(8)), 5e-3)
    prepared, slipped = Run(scene, COMM, box_body((32, 6), (1, 1))), [False]

    def accepted():
        (state,) = prepared.solution.states
        slipped.append(slipped[-1] | (state.status == "SLIP"))

    result = prepared.solve(accepted=accepted)
    assert result.passed, result.verdict
    (state,) = prepared.solution.states
    np.testing.assert_array_equal(state.own["worn_depth"] > 0, slipped[-1])
    depth, status = result.points.own["worn_depth"], result.points.status
    assert (depth[status == "STICK"] == 0).any()
    found = result.quantities
    volume = 5e-3 / MU * found["friction_work"]
    assert 0.9 * volume < found["worn_volume"] < volume


def test_two_bodies_wear_together():
    """A block that slides by a fifth of its width on another one, paired anew on the way."""
    body = two_blocks()
    prepared = Run(worn(shoved(Steps(8)), 1e-3), COMM, body)
    result = prepared.solve()
    assert result.passed, result.verdict
    smooth = Run(shoved(Steps(8)), COMM, body).solve()
    found = result.quantities
    assert found["normal_force"] > 0
    assert found["worn_volume"] == pytest.approx(1e-3 / MU * found["friction_work"], rel=1e-2)
    # What is worn is no overlap any more: at a fixed approach the force falls.
    assert found["normal_force"] < smooth.quantities["normal_force"]
    assert "worn_volume" not in smooth.quantities


def test_points_that_come_to_face_a_body_are_not_worn_by_the_way_there():
    """A block that comes in over an edge, without friction and with next to none."""
    lower, upper = Box("lower", (0, -1), (2, 0), (8, 3)), Box("upper", (-0.5, 0), (0.5, 1), (6, 2))
    scene = shoved(Steps(6), errors="none")
    shift = dataclasses.replace(scene.support[2], displacement={"x": 0.5})
    volumes = []
    for friction in ({}, {"friction_coefficient": 1e-6, "law": "incremental"}):
        contact = Contact("upper.y0", against="lower.y1", slave="on", wear=Wear(1e-6), **friction)
        changed = dataclasses.replace(
            scene, support=(*scene.support[:2], shift), contact=(contact,)
        )
        found = Run(changed, COMM, boxes((lower, upper), comm=COMM)).solve()
        volumes.append(found.quantities["worn_volume"])
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-3)


def test_a_step_that_is_rejected_leaves_no_trace():
    prepared, _ = solved(on_springs(4, Wear(K)))
    contact, state = prepared.problem.contacts[0], prepared.solution.states[0]
    kept, pressure = remember(contact), contact.pressure().copy()
    contact.accept()
    prepared.problem.set_time(2.0)
    np.testing.assert_array_equal(contact.wear.worn_depth, state.own["worn_depth"])
    assert np.all(contact.pressure() < pressure)
    recall(contact, kept)
    np.testing.assert_array_equal(contact.pressure(), pressure)
    np.testing.assert_array_equal(contact.state().own["worn_depth"], state.own["worn_depth"])


@pytest.mark.parametrize("name", ["obstacle", "two bodies"])
def test_a_run_that_is_resumed_has_it_as_a_whole_run(name, folder):
    """On other ranks, too."""
    scene, body = {
        "obstacle": (worn(dragged(Steps(6))), block),
        "two bodies": (worn(shoved(Steps(6)), 1e-3), two_blocks),
    }[name]
    whole = Run(scene, COMM, body()).solve()
    if COMM.rank == 0:
        stopped_after(scene, body(MPI.COMM_SELF), folder, 4)
    COMM.barrier()
    found = resumed(scene, body(), folder)
    require_same(found, whole, 1e-6)
    depth = whole.points.own["worn_depth"]
    np.testing.assert_allclose(found.points.own["worn_depth"], depth, atol=1e-6 * depth.max())


def test_files_have_it(folder):
    scene = dataclasses.replace(on_springs(2, Wear(K)), title="worn")
    result = files.solve_and_write(Run(scene, COMM, box_body((4, 2), (2, 1))), folder)

    def read():
        with (folder / "contact.csv").open(newline="") as file:
            assert next(csv.reader(file)) == [*CSV_HEADER, "worn_depth"]
        with (folder / "steps.csv").open(newline="") as file:
            volumes = [float(row["worn_volume"]) for row in csv.DictReader(file)]
        assert volumes[0] == pytest.approx(0, abs=1e-15)
        assert volumes[-1] == pytest.approx(result.quantities["worn_volume"], rel=1e-9)
        said = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        assert said["quantities"]["worn_volume"] == pytest.approx(volumes[-1])
        assert said["contacts"][0]["quantities"]["max_wear_depth"] > 0

    on_root(COMM, read)


@pytest.mark.errors
def test_errors_that_were_not_estimated_have_no_bar():
    scene = dataclasses.replace(on_springs(2, Wear(K)), solver=SolverSettings())
    _, result = solved(scene)
    assert any("where contacts wear" in note for note in result.error_notes)
    assert result.errors["normal_force"]["mesh"] is None
    assert result.errors["normal_force"]["total"] is None
    assert result.errors["normal_force"]["step"] > 0


@pytest.mark.parametrize(
    ("contact", "words"),
    [
        ({"foundation_stiffness": 1, "friction_coefficient": 0.1}, "wear_of_static_friction"),
        ({"pressure": 3.0}, "wear_of_prescribed_contact"),
        ({"contact": "bonded"}, "wear_of_bonded_contact"),
    ],
)
def test_contacts_that_cannot_wear_are_refused(contact, words):
    with refused(words, SceneError):
        Contact("y0", wear=Wear(K), **contact)


def test_a_negative_coefficient_is_refused():
    with refused("wear_coefficient_is_negative", SceneError):
        Wear(-1.0)
    scene = on_springs(1, Wear(Profile(along="x", at=(0, 2), values=(-K, K))))
    with refused("wear_coefficient_is_negative_somewhere"):
        Run(scene, COMM, box_body((4, 2), (2, 1)))


def test_derivatives_are_refused():
    study = Study(on_springs(2, Wear(K)), COMM, box_body((4, 2), (2, 1)))
    with refused("wear_has_no_derivative"):
        study.derivatives(["normal_force"], ["contact.0.foundation_stiffness"])


def test_scenes_in_files_have_it():
    scene = worn(dragged(Steps(2)), 1e-8)
    assert "coefficient = 1e-08" in scene_text(scene)


def test_wear_beyond_the_linear_theory_of_gaps_is_said():
    _, result = solved(on_springs(4, Wear(K), interference=0.3))
    deep = result.quantities["max_wear_depth"]
    row = result.steps[-1].linear_range["wear"]
    assert row["value"] == pytest.approx(deep / 1.0, rel=1e-9)  # the surface is 2 wide
    assert row["value"] > 0.1
    share = f"{100 * row['value']:.0f} %"
    assert f"wear as deep as {share} of half its width near 'y0'" in result.verdict
    _, shallow = solved(on_springs(4, Wear(K)))
    assert "linear theory" not in shallow.verdict
