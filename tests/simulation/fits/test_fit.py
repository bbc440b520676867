"""Fits find the truth of formulas and of loops; their intervals are those of the formulas."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fenics_contact import Contact, Measured, Obstacle, Path, Steps, Study, fit
from fenics_contact.simulation.fits.curves import branches
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.sensitivities.test_derivatives import (
    HEIGHT,
    PENALTY,
    WIDTH,
    E,
    uniform_block,
)
from tests.simulation.studies.cases import MU
from tests.solve.load_steps.histories import dragged

DOWN, STIFF = "support.0.displacement.y", "contact.0.penalty_parameter"
MOVED = np.array([1e-3, 2e-3, 3e-3, 4e-3])
YOUNG, SOFT = 1000.0, 1 - 0.3**2
COMPLIANCE = HEIGHT * SOFT / YOUNG + PENALTY
UNCERTAINTY = 0.02


def block_study(**changes):
    scene = with_changes(uniform_block(), {E: 700.0, **changes})
    return Study(scene, body=box_body((3, 2), (WIDTH, HEIGHT)))


def forces(uncertainty=UNCERTAINTY):
    """Of the uniform block at four heights of its lid, by the formula W δ / c."""
    known = None if uncertainty is None else np.full(4, uncertainty)
    return Measured((DOWN,), -MOVED[:, None], "normal_force", WIDTH * MOVED / COMPLIANCE, known)


def test_a_modulus_and_its_interval_are_those_of_the_formula():
    """dF/dE = W δ h (1 − ν²) / (c E)²; what ε₁ takes of the force, it adds to the modulus."""
    found = fit(block_study(), forces(), {E: (100, 5000)})
    young = found.record.parameters[E]
    slopes = WIDTH * MOVED * HEIGHT * SOFT / (COMPLIANCE * YOUNG) ** 2
    deviation = UNCERTAINTY / np.sqrt(np.sum(slopes**2))
    of_penalty = PENALTY / (HEIGHT * SOFT / YOUNG**2)
    assert young.value == pytest.approx(YOUNG, rel=1e-6)
    assert young.noise == pytest.approx(1.959964 * deviation, rel=1e-6)
    assert young.discretisation == pytest.approx(of_penalty, rel=1e-5)
    # All of the shift may be on one side: then 95 % of the noise is 1.645 deviations beyond it.
    assert young.high - young.value == pytest.approx(of_penalty + 1.644854 * deviation, rel=0.01)
    assert found.record.converged and found.record.evaluations <= 8
    # So soft a penalty lets the floor come in too far, which the run itself says.
    assert found.record.checks == ["penetration", "penetration_depth"]
    assert found.record.exit_code == 4 and "penetration" in found.record.verdict
    assert found.changes == {E: young.value}


def test_the_noise_is_told_from_the_residual_where_it_is_not_given():
    noise = np.array([1.0, -1.0, -1.0, 2.0]) * 0.005
    data = forces(None)
    data = Measured(data.over, data.at, data.quantity, data.values + noise)
    young = fit(block_study(), data, [E]).record.parameters[E]
    slopes = WIDTH * MOVED * HEIGHT * SOFT / (COMPLIANCE * YOUNG) ** 2
    along = slopes / np.linalg.norm(slopes)
    left = noise - along * (along @ noise)
    deviation = np.sqrt(left @ left / 3) / np.linalg.norm(slopes)
    of_three = 3.182446  # Student's t with three degrees of freedom, 97.5 %
    assert young.value - YOUNG == pytest.approx(along @ noise / np.linalg.norm(slopes), rel=0.05)
    assert young.noise == pytest.approx(of_three * deviation, rel=0.02)


def test_parameters_that_make_the_same_curve_are_not_told_apart():
    """Force and lid tell the compliance alone, h (1 − ν²)/E + ε₁."""
    found = fit(block_study(), forces(), {E: (100, 5000), STIFF: (1e-6, 1e-2)}).record
    assert [(one.low, one.high) for one in found.parameters.values()] == [(None, None)] * 2
    assert f"The data cannot tell {E} and {STIFF} apart" in found.notes[0]
    assert found.singular_values[1] < 1e-9 * found.singular_values[0]
    values = [one.value for one in found.parameters.values()]
    assert HEIGHT * SOFT / values[0] + values[1] == pytest.approx(COMPLIANCE, rel=1e-4)


def test_a_number_that_moves_nothing_is_refused():
    """What stands far beside the block never touches it."""
    unused = "contact.1.penalty_parameter"
    scene = with_changes(uniform_block(), {E: 700.0})
    beside = Contact("x1", obstacle=Obstacle("plane", position=(9, 0)), penalty_parameter=1e-4)
    scene = replace(scene, contact=(*scene.contact, beside))
    study = Study(scene, body=box_body((3, 2), (WIDTH, HEIGHT)))
    with refused("curve_does_not_depend_on_parameter"):
        fit(study, replace(forces(), quantity="y0.normal_force"), [E, unused])


def test_a_number_of_friction_is_refused_where_nothing_rubs():
    unused = "contact.0.regularisation_parameter"
    with refused("parameter_of_no_friction"):
        fit(block_study(**{unused: 1e-6}), forces(), [E, unused])


def test_a_bound_that_holds_a_parameter_is_said():
    found = fit(block_study(), forces(), {E: (100, 900)}).record
    assert found.parameters[E].at_bound and found.parameters[E].high == 900
    assert any(f"{E} is at its bound" in note for note in found.notes)
    assert any("further apart than the uncertainties say" in note for note in found.notes)


LOOP = with_changes(
    dragged(Steps(number=10), driven={"force": 8.0}, path=Path((0, 0.1, 1), (0, 1, 1))),
    {
        "contact.0.obstacle.displacement": (0.02, 0.0),
        "contact.0.obstacle.displacement_path": Path((0, 0.1, 0.5, 1), (0, 0, 1, -1)),
        MU: 0.3,
    },
)


@pytest.fixture(scope="module")
def loop():
    """Friction of a loop of gross slip: force along it, displacement below, times."""
    study = Study(LOOP, body=box_body((6, 4), (1, 1)))
    history = study.history(["friction_force_x"], [])
    force = np.array([step.quantities["friction_force"][0] for step in history.steps])
    work = np.array([step.quantities["strain_energy"] for step in history.steps])
    return np.array([step.load_factor for step in history.steps]), force, work


def test_friction_and_modulus_follow_from_a_loop(loop):
    times, force, _ = loop
    size = 0.01 * np.abs(force).max()
    noise = size * np.random.default_rng(5).normal(size=len(force))
    data = Measured(
        ("time",), times[1:, None], "friction_force_x", (force + noise)[1:], 0 * times[1:] + size
    )
    study = Study(with_changes(LOOP, {MU: 0.2, E: 1400.0}), body=box_body((6, 4), (1, 1)))
    found = fit(study, data, [f"{MU}=0.05:1", E]).record
    assert found.converged and found.evaluations <= 8
    for key, truth in ((MU, 0.3), (E, 1000.0)):
        one = found.parameters[key]
        assert one.low < truth < one.high
        assert one.high - one.low < 0.2 * one.value
        assert one.noise > 0 and one.discretisation > 0
    assert 0.2 < found.misfit < 3


def test_a_curve_over_another_quantity_is_found_on_its_branches(loop):
    """Strain energy over the force of a loop, half of the way between load steps."""
    _, force, work = loop
    over, values = [], []
    for first, last in branches(force):
        for place in range(first, last):
            over.append(0.5 * (force[place] + force[place + 1]))
            values.append(0.5 * (work[place] + work[place + 1]))
    data = Measured(
        ("friction_force_x",), np.array(over)[:, None], "strain_energy", np.array(values)
    )
    study = Study(with_changes(LOOP, {E: 1100.0}), body=box_body((6, 4), (1, 1)))
    found = fit(study, data, [E])
    assert found.record.parameters[E].value == pytest.approx(1000, rel=1e-3)
    assert found.record.residual < 1e-3 * max(values)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ([], "no_parameter_named"),
        ([E, E], "parameter_named_twice"),
        (["material.0.youngs_modulos"], "no_parameter_youngs_modulos"),
        ([f"{E}=5:1"], "parameter_low_exceeds_high"),
        ([f"{E}=800:900"], "parameter_begins_outside_bounds"),
        ([f"{E}=1,2"], "parameter_bounds_misspelt"),
        (["contact.0.regularisation_parameter"], "parameter_is_automatic"),
        (["contact.0.law"], "parameter_is_no_number"),
        (["solver.tolerance"], "parameter_has_no_derivative"),
        ([DOWN], "parameter_is_in_the_data"),
        ([E, STIFF, "material.0.poissons_ratio", "load.0.pressure"], "no_parameter_pressure"),
        ([E, STIFF, "material.0.poissons_ratio", "contact.0.interference"], "too_few_rows_of_data"),
    ],
)
def test_what_cannot_be_found_is_refused_in_a_sentence(parameters, said):
    with refused(said):
        fit(block_study(), forces(None), parameters)


@pytest.mark.parametrize(
    ("quantity", "time", "said"),
    [
        ("contact_area", 1.0, "data_has_no_derivatives"),
        ("normal_force", 2.0, "data_beyond_the_load_steps"),
    ],
)
def test_a_curve_that_the_run_has_not_is_refused(quantity, time, said):
    data = Measured(("time",), np.array([[time]]), quantity, np.ones(1), np.ones(1))
    with refused(said):
        fit(block_study(), data, [E])


def test_a_path_that_turns_otherwise_is_refused(loop):
    _, force, work = loop
    data = Measured(("friction_force_x",), np.array([[0.1], [0.2]]), "strain_energy", np.ones(2))
    with refused("data_turns_elsewhere"):
        fit(Study(LOOP, body=box_body((6, 4), (1, 1))), data, [E])
    assert math.isfinite(force.sum() + work.sum())
