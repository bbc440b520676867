"""ε of each load step follows its pressures, and contacts that only touch press on nothing."""

import dataclasses
import pathlib

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.solve.coulomb import monolithic
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body
from tests.solve.load_steps.histories import require_same

COMM = MPI.COMM_WORLD
# At first they only touch; then they are pressed.
PRESSED_LATE = Path(time=(0, 0.5, 1), factor=(0, 0, 1))
SHEARED = Path(time=(0, 1), factor=(0, 1))
STIFFNESS, WIDTH = 1000.0, 1.0


def turned(body, angle):
    """The body turned about the origin."""
    x = body.mesh.geometry.x
    along, up = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0] = np.cos(angle) * along - np.sin(angle) * up
    x[:, 1] = np.sin(angle) * along + np.cos(angle) * up
    return body


def axes(angle):
    """Along the turned top of a block, and out of it."""
    return np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])


def under_a_plane(angle, law, steps, path, shift=0.002, shifted=SHEARED, soft="auto", **solver):
    """A turned block on its bottom under a plane that touches its top as drawn."""
    along, up = axes(angle)
    plane = Obstacle(
        "plane",
        normal=tuple(-up),
        position=tuple(up),
        indentation=0.01,
        path=path,
        displacement=tuple(shift * along),
        displacement_path=shifted,
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y1", obstacle=plane, friction_coefficient=0.3, law=law, penalty_parameter=soft
            ),
        ),
        steps=steps,
        solver=SolverSettings(**solver),
    )
    return run(scene, COMM, turned(box_body((8, 6), (WIDTH, 1)), angle))


def one_on_another(angle, law, steps, path, pull, pulled, **solver):
    """A turned block on a wider one, moved down by its top and pulled by its side."""
    along, up = axes(angle)
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", dict(zip("xy", -0.01 * up, strict=True)), path=path),
        ),
        load=(Load("upper.x0", traction=tuple(pull * along), path=pulled),),
        contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=0.3, law=law),),
        steps=steps,
        solver=SolverSettings(**solver),
    )
    parts = Box("lower", (0, -1), (2, 0), (8, 4)), Box("upper", (0.5, 0), (1.5, 1), (5, 4))
    return run(scene, COMM, turned(boxes(parts), angle))


def used(result, step=-1):
    return result.steps[step]["contacts"][0].get("regularisation_parameter")


def strongest(result, step=-1):
    return result.steps[step]["quantities"]["max_contact_pressure"]


@pytest.mark.parametrize("law", ["static", "incremental"])
def test_turned_blocks_that_only_touch_at_first_press_on_nothing(law):
    """The plane is moved along from the start: by rounding, it would press here and there."""
    straight, tilted = (
        under_a_plane(a, law, Steps(automatic=True, number=4), PRESSED_LATE) for a in (0, 0.5)
    )
    for result in (straight, tilted):
        assert result.passed, result.verdict
        for step in result.steps[:2]:
            assert step["newton_iterations"] == 0
            found = step["quantities"]
            for key in ("normal_force", "strain_energy", "contact_area"):
                assert found[key] == 0, key
    for key in ("normal_force", "strain_energy", "friction_work", "max_contact_pressure"):
        assert tilted.quantities[key] == pytest.approx(straight.quantities[key], rel=1e-7), key


def test_nothing_but_touching_is_an_answer():
    """A single step without any load, between turned blocks: the answer is 0."""
    nothing = Path((0, 1), (0, 0))
    result = one_on_another(0.3, "static", Steps(), nothing, 1.0, nothing)
    assert result.passed, result.verdict
    assert result.steps[0]["newton_iterations"] == 0
    assert (result.points.contact_pressure == 0).all()
    assert result.quantities["strain_energy"] == 0


@pytest.mark.parametrize("law", ["none", "static"])
@pytest.mark.parametrize(("angle", "moved"), [(0.0, (0, 0.01)), (0.3, (0, 0.01)), (0, (-0.01, 0))])
def test_moved_along_what_it_touches_or_away(law, angle, moved):
    """Held at its top alone, a block goes along as a whole; its contact carries nothing."""
    along, up = axes(angle)
    shift = moved[0] * along + moved[1] * up
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("y1", dict(zip("xy", shift, strict=True))),),
        contact=(Contact("x1", law=law, friction_coefficient=0.0 if law == "none" else 0.3),),
    )
    result = run(scene, COMM, turned(box_body((6, 6), (WIDTH, 1)), angle))
    assert result.passed, result.verdict
    assert result.steps[0]["newton_iterations"] <= 10
    for key in ("normal_force", "max_contact_pressure", "strain_energy"):
        assert abs(result.quantities[key]) <= 1e-8 * STIFFNESS * 0.01, key
    bars = [error.total for error in result.errors.values() if error.total is not None]
    assert max(bars, default=0.0) <= 2 * WIDTH


def test_round_off_that_drowns_what_is_real_is_refused():
    """As before, where a motion strains a body: springs are too stiff to be told from it."""
    plane = Obstacle("plane", normal=(0, -1), position=(0, 1), indentation=0.01)
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=plane, penalty_parameter=1e-20),),
    )
    assert not run(scene, COMM, box_body((6, 6), (WIDTH, 1))).passed


@pytest.mark.parametrize("law", ["static", "incremental"])
@pytest.mark.parametrize("first", [1e-6, 1e-9])
def test_a_tiny_first_step_sets_no_scale(law, first):
    """As without it: the ε of the end is that of the last step's own pressures."""
    steps = Steps(times=(0.25, 0.5, 1))
    shifted = Path((0, 0.5, 1), (0, 0, 1))
    found, plain = (
        under_a_plane(0.0, law, steps, Path((0, 0.25, 0.5, 1), (0, f, 0.5, 1)), shifted=shifted)
        for f in (first, 0.25)
    )
    assert found.passed, found.verdict
    assert found.quantities["normal_force"] == pytest.approx(
        plain.quantities["normal_force"], rel=1e-5
    )
    assert max(step["newton_iterations"] for step in found.steps) <= 40
    shares = [used(result) / strongest(result) for result in (found, plain)]
    assert shares[0] == pytest.approx(shares[1], rel=0.5)


@pytest.mark.parametrize("pair", [False, True])
@pytest.mark.parametrize("law", ["static", "incremental"])
def test_unloaded_to_little_and_sheared(law, pair):
    """Sheared by a tenth of what friction holds, with all but a share of 1e-4 taken off.

    Under so little, ε of the peak would let what sticks creep by as much as the body gives way.
    """
    left = 1e-4
    pressed = Path((0, 0.5, 0.75, 1), (0, 1, left, left))
    later = Path((0, 0.75, 1), (0, 0, 1))
    if pair:
        result = one_on_another(0.0, law, Steps(8), pressed, 0.1 * left, later)
    else:
        result = under_a_plane(0.0, law, Steps(8), pressed, 2e-4 * left, later)
    assert result.passed, result.verdict
    peak = max(range(8), key=lambda number: strongest(result, number))
    expected = strongest(result) / strongest(result, peak)
    assert expected < 1e-3
    assert used(result) / used(result, peak) == pytest.approx(expected, rel=0.7)


def test_a_smaller_scale_is_found_from_the_answer(monkeypatch):
    """Contact without friction may be too far away to be found where friction alone holds a block.

    It is pressed by a hundredth in the second load step, which begins with the scale of the first.
    """
    calls = []

    def not_found(newton):
        calls.append(newton)
        raise NotConvergedError("contact without friction is too far away", ())

    monkeypatch.setattr(monolithic, "_find_scale", not_found)
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("lower.y0", {"x": 0, "y": 0}),),
        load=(Load("upper.y1", traction=(0.1, -1), path=Path((0, 0.5, 1), (0, 1, 0.01))),),
        contact=(
            Contact("upper.y0", against="lower.y1", friction_coefficient=0.3, law="incremental"),
        ),
        steps=Steps(2),
        solver=SolverSettings(strategy="monolithic"),
    )
    parts = Box("lower", (0, -1), (2, 0), (8, 4)), Box("upper", (0.5, 0), (1.5, 1), (5, 4))
    result = run(scene, COMM, boxes(parts))
    assert calls
    assert result.passed, result.verdict
    shares = [used(result, number) / strongest(result, number) for number in range(2)]
    assert strongest(result) < 0.1 * strongest(result, 0)
    assert shares[1] == pytest.approx(shares[0], rel=0.7)
    reaction = result.quantities["reaction"]
    assert reaction == pytest.approx([-0.001, 0.01], abs=1e-9)


def test_a_given_pressure_that_falls_takes_its_scale_along():
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("x0", {"x": 0}), Support("y0", {"y": 0})),
        load=(Load("x1", traction=(1e-4, 0), path=Path((0, 0.5, 1), (0, 0, 1))),),
        contact=(
            Contact(
                "y1",
                pressure=20,
                pressure_path=Path((0, 0.5), (1, 1e-4)),
                friction_coefficient=0.5,
                law="incremental",
            ),
        ),
        steps=Steps(4),
    )
    result = run(scene, COMM, box_body((8, 6)))
    assert result.passed, result.verdict
    pressures = [20 * share for share in (0.50005, 1e-4, 1e-4, 1e-4)]
    shares = [used(result, number) / pressure for number, pressure in enumerate(pressures)]
    assert shares == pytest.approx([shares[0]] * 4)


@pytest.mark.parametrize(
    ("law", "solver", "left"),
    [
        ("static", "condensed", 0.0),
        ("static", "full", 0.0),
        ("incremental", "full", 1e-12),
        ("incremental", "condensed", 1e-12),
    ],
)
def test_unloaded_to_nothing(law, solver, left):
    """Of a body that nothing loads any more no check asks what its round-off means."""
    path = Path((0, 0.5, 1), (0, 1, left))
    for result in (
        under_a_plane(0.3, law, Steps(4), path, shifted=path, solver=solver),
        one_on_another(0.3, law, Steps(4), path, 0.1, path, solver=solver),
    ):
        assert result.passed, result.verdict
        assert "penetration" not in result.checks and "pressure_recovery" not in result.checks
        peak = max(strongest(result, number) for number in range(4))
        assert strongest(result) <= 1e-6 * peak


def test_a_penalty_too_soft_is_seen_after_unloading_too():
    """What is left is little, but more than the solver's rest: checks have something to compare."""
    result = under_a_plane(0.0, "static", Steps(4), Path((0, 0.5, 1), (0, 1, 1e-4)), soft=1e-4)
    assert not result.checks["penetration"].passed
    assert not result.checks["penetration_depth"].passed


def test_the_scale_goes_on_where_a_run_was_stopped(tmp_path):
    """Unloaded after the restart: the ε of each step is as without it."""
    folder = pathlib.Path(on_root(COMM, lambda: str(tmp_path)))  # one for all ranks
    along, up = axes(0.0)
    plane = Obstacle(
        "plane", normal=tuple(-up), position=tuple(up), indentation=0.01,
        path=Path((0, 0.5, 1), (0, 1, 1e-3)), displacement=tuple(0.002 * along),
    )  # fmt: skip
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=plane, friction_coefficient=0.3, law="incremental"),),
        steps=Steps(8),
    )
    body = box_body((8, 6), (WIDTH, 1))
    whole = run(scene, COMM, body)
    first, done = Run(scene, COMM, body), []
    first.solve(
        StateFile(folder, first.problem),
        stopped=lambda: len(done) == 4,
        announce=lambda number, step: done.append(number),
    )
    again = Run(scene, COMM, body)
    found = again.solve(saved=StateFile(folder, again.problem).load())
    require_same(found, whole)
    for number in range(8):
        assert used(found, number) == pytest.approx(used(whole, number), rel=1e-9)
        ours, theirs = (r.steps[number]["newton_iterations"] for r in (found, whole))
        assert ours == theirs


def test_an_epsilon_that_is_given_stays():
    plain = under_a_plane(0.0, "static", Steps(2), SHEARED)
    scene_epsilon = 3e-7
    plane = Obstacle("plane", normal=(0, -1), position=(0, 1), indentation=0.01)
    contact = Contact("y1", obstacle=plane, friction_coefficient=0.3)
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(dataclasses.replace(contact, regularisation_parameter=scene_epsilon),),
        steps=Steps(4),
    )
    result = run(scene, COMM, box_body((8, 6), (WIDTH, 1)))
    assert [used(result, number) for number in range(4)] == [scene_epsilon] * 4
    assert used(plain, 0) != used(plain, 1)
