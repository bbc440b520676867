"""Answers in finite strains: against closed forms, a separate prototype, other steps and meshes."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Obstacle,
    ObstacleRotation,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.analytic.finite_strains import lubricated_block
from fenics_contact.scene.laws import energies
from fenics_contact.solve.finite import nested_solver
from fenics_contact.verification.finite.rubber import CONSTANTS
from tests.scenes import box_body
from tests.solve.finite.rubber import NO_ERRORS, RUBBER, dragged, long_block, pressed, square


@pytest.mark.parametrize("law", energies.names())
def test_a_block_between_smooth_plates_has_the_closed_form(law):
    prepared = Run(pressed(0.2, law=law), body=square())
    found = prepared.solve()
    assert found.passed, found.verdict
    expected = lubricated_block(law, 0.8, 1.0, 0.3, CONSTANTS.get(law))
    assert abs(found.quantities["normal_force"] - expected) < 1e-8 * expected
    assert abs(found.quantities["min_stretch"] - 0.8) < 1e-9
    assert found.model.bulk_factorisations <= 4
    assert found.model.strains == "finite"


def test_the_closed_forms_are_those_of_the_literature_in_small_strains():
    """And at λ = .7 those that were computed apart from the program."""
    known = {"neo-Hookean": 0.458423923, "Hencky": 0.559929, "St Venant-Kirchhoff": 0.196154}
    for law, expected in known.items():
        assert abs(lubricated_block(law, 0.7, 1.0, 0.3) - expected) < 1e-6
    for law in energies.names():
        small = lubricated_block(law, 1 - 1e-6, 1.0, 0.3, CONSTANTS.get(law))
        assert abs(small - 1e-6 / (1 - 0.3**2)) < 1e-11


def test_small_loads_have_the_linear_answer_to_first_order():
    """Differences over the strain tend to a number."""

    def differences(depth):
        finite = run(pressed(depth, 0.3), body=square())
        scene = dataclasses.replace(
            pressed(depth, 0.3),
            strains="small",
            material=dataclasses.replace(pressed(depth).material[0], law=None),
            solver=SolverSettings(strategy="exact", errors="none"),
        )
        linear = run(scene, body=square())
        forces = [one.quantities["normal_force"] for one in (finite, linear)]
        return (forces[0] / forces[1] - 1) / depth

    first, second = differences(2e-3), differences(1e-3)
    assert 0.3 < abs(second) < 3
    assert abs(first / second - 1) < 0.02


def test_newtons_method_converges_quadratically_without_the_chord(monkeypatch):
    monkeypatch.setattr(nested_solver, "_CHORD", 0.0)
    found = run(dragged([1.0]), body=long_block())
    left = np.array(found.steps[-1].residual_history[1:4])
    assert left[-1] > 1e-11  # above round-off
    assert np.all(left[1:] < 0.2 * left[:-1] ** 1.8)


def test_a_cylinder_pressed_and_dragged_is_that_of_a_prototype():
    """Of a program apart from this one, with penalties of 1e-5 and other friction."""
    found = run(dragged([1.0, 1.5, 2.0]), body=long_block())
    assert found.passed, found.verdict
    pressed_in, _, end = (step.quantities["contact_force"] for step in found.steps)
    assert abs(pressed_in[1] + 0.416159) < 2e-5
    assert np.allclose(end, [0.123484, -0.411790], rtol=0, atol=2e-5)
    assert found.model.bulk_factorisations <= 5 + 2 * 6


def test_a_long_way_in_one_step_ends_as_in_several():
    """Friction at the end slips everywhere, so that the way does not matter."""
    ends = [
        run(dragged(times), body=long_block()).quantities["contact_force"]
        for times in ([1.0, 2.0], [1.0, 1.25, 1.5, 1.75, 2.0])
    ]
    assert np.allclose(*ends, rtol=1e-9)


def test_a_cylinder_that_spins_in_place_rubs_with_all_of_its_pressure():
    """Three quarters of a turn: the moment is μ R ∫ p, and half of the way the work of it."""
    scene = dragged([1.0, 1.5, 2.0], friction=0.2)
    spun = dataclasses.replace(
        scene.contact[0].obstacle,
        displacement=None,
        rotation=ObstacleRotation(angle=1.5 * np.pi, at=(2.5, 4.0)),
        rotation_path=Path(time=(1, 2), factor=(0, 1)),
        position=(2.5, 3.0),
    )
    contact = dataclasses.replace(scene.contact[0], obstacle=spun)
    found = run(dataclasses.replace(scene, contact=(contact,)), body=long_block())
    assert found.passed, found.verdict
    points = found.points
    arms = points.own["current"][:, :2] - [2.5, 3.5]
    forces = points.weights[:, None] * points.friction_traction[:, :2]
    moment = np.sum(arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0])
    assert abs(moment - 0.2 * found.quantities["pressure_integral"]) < 1e-8
    middle, end = (step.quantities for step in found.steps[1:])
    work = end["external_work"] - middle["external_work"]
    assert abs(work - 0.75 * np.pi * moment) < 1e-6


def test_sides_fold_onto_the_floor():
    """A rough block squeezed by 40 % in four steps, whose side touches, too; or in two."""
    found = run(pressed(0.4, 0.3, 4, on="foot"), body=square(8))
    assert found.passed, found.verdict
    assert found.model.bulk_factorisations <= 20
    points = found.points
    folded = (points.coordinates[:, 1] > 1e-9) & (points.contact_pressure > 0)
    assert folded.sum() >= 1
    assert np.abs(points.own["current"][folded, 1]).max() < 1e-9
    met = np.isfinite(points.gap)  # all but the corner that is held
    assert met.sum() == len(met) - 1
    assert np.allclose(points.own["current"][met, 1], points.gap[met], atol=1e-9)
    at_once = run(pressed(0.4, 0.3, 2, on="foot"), body=square(8))
    force = found.quantities["normal_force"]
    assert abs(at_once.quantities["normal_force"] - force) < 1e-3 * force


def test_the_work_of_large_steps_is_open_to_second_order():
    """The trapezoidal rule takes forces for straight lines; without friction nothing is lost."""
    defects = []
    for steps in (2, 4, 8):
        found = run(pressed(0.3, steps=steps), body=square(2))
        defects.append(abs(found.quantities["energy_defect"]))
    orders = np.log2(np.array(defects[:-1]) / defects[1:])
    assert np.all(np.abs(orders - 2) < 0.15)


def test_a_listed_step_is_halved_where_it_does_not_converge(monkeypatch):
    monkeypatch.setattr(nested_solver, "_MOST", 5)
    found = run(pressed(0.3, 0.3, on="foot"), body=square())
    times = [step.load_factor for step in found.steps]
    assert found.converged
    assert times[-1] == 1.0
    assert len(times) > 1


@pytest.mark.errors
def test_errors_are_said_to_be_unknown():
    found = run(pressed(0.1, solver=SolverSettings()), body=square(2))
    assert found.errors["normal_force"]["mesh"] is None
    assert "finite strains" in found.error_notes[0]
    assert run(pressed(0.1, solver=NO_ERRORS), body=square(2)).errors == {}


def test_gaps_that_the_loops_leave_are_none():
    """What they leave of the gap of a closed point is not said to be open."""
    prepared = Run(pressed(0.2, 0.3), body=square())
    prepared.solve()
    (contact,) = prepared.problem.contacts
    found = prepared.solution.displacement
    contact.measure(found + np.array([0, 1e-11]))
    assert not np.any(contact.state().gap[contact.found.closed])
    contact.measure(found + np.array([0, 1e-8]))
    assert np.all(contact.state().gap[contact.found.closed] > 0)


def test_an_obstacle_between_two_points_is_noticed():
    """Nothing pushes back, where it is small and no point is in it."""
    small = Obstacle("cylinder", radius=0.1, position=(0.5625, 1), normal=(0, -1), indentation=0.02)
    scene = Scene(
        kinematics="plane strain",
        strains="finite",
        material=RUBBER,
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=small),),
        solver=NO_ERRORS,
    )
    coarse = run(scene, body=square())
    check = coarse.checks["unseen_contact"]
    assert check.value == pytest.approx(1) and check.place[0] == pytest.approx(0.5625)
    assert coarse.exit_code == 4
    assert run(scene, body=square(32)).checks["unseen_contact"].passed


def test_an_arch_that_is_pressed_through_is_said_to_have_been_unstable():
    """It would evade to a side on the way; at the end, turned over, it is stable again."""
    body = box_body((30, 2), (6, 0.12))
    places = body.mesh.geometry.x
    places[:, 1] += 0.6 * np.sin(np.pi * places[:, 0] / 6)
    roller = Obstacle("cylinder", radius=0.5, position=(3, 0.72), normal=(0, -1), indentation=1.2)
    scene = Scene(
        kinematics="plane strain",
        strains="finite",
        material=RUBBER,
        support=tuple(Support(side, {"x": 0, "y": 0}) for side in ("x0", "x1")),
        contact=(Contact("y1", obstacle=roller),),
        steps=Steps(times=(0.1, 0.3, 0.5, 0.9, 1.0)),
        solver=NO_ERRORS,
    )
    found = run(scene, body=body)
    assert found.checks["stable_equilibrium"].passed
    steps = {step.load_factor: step for step in found.steps}
    unstable = [time for time, step in steps.items() if step.unstable_motions]
    assert unstable[:2] == [0.3, 0.5] and unstable[-1] < 0.9
    assert "From time 0.3 to" in found.verdict and "was not stable" in found.verdict
    first, middle, last = (-steps[at].quantities["contact_force"][1] for at in (0.1, 0.5, 1.0))
    assert middle < first < last  # it falls on the way
