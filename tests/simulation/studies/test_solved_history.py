"""Derivatives and errors of load steps are differences of runs: of other values, other meshes."""

import numpy as np
import pytest

from fenics_contact import Steps, Study
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.preload.joints import joint
from tests.scenes import box_body
from tests.simulation.sensitivities.test_derivatives import E
from tests.simulation.studies.cases import CASES, DEPTH, MU
from tests.solve.load_steps.histories import block, dragged

OF = ["normal_force", "friction_force_x"]
SCENE = with_changes(
    dragged(Steps(times=(0.5, 0.75, 1.0)), tolerance=1e-13, errors="none"),
    {"contact.0.penalty_parameter": 1e-6, "contact.0.regularisation_parameter": 1e-6},
)


def values(study, changes=None):
    """Of all load steps, (steps, quantities)."""
    steps = study.history([], [], changes).steps
    rows = [step.quantities for step in steps]
    return np.array([[row["normal_force"], row["friction_force"][0]] for row in rows])


def test_slopes_of_every_step_are_central_differences():
    study = Study(SCENE, body=block())
    found = study.history(OF, [MU, E, DEPTH]).slopes
    for key, number in ((MU, 0.3), (E, 1000.0), (DEPTH, 0.02)):
        step = 3e-4 * number
        ends = [values(study, {key: number + sign * step}) for sign in (1, -1)]
        expected = (ends[0] - ends[1]) / (2 * step)
        assert found[key] == pytest.approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max())


def test_those_of_the_last_step_alone_are_the_same():
    study = Study(SCENE, body=block())
    whole, last = (study.history(OF, [MU], is_whole=one).slopes[MU] for one in (True, False))
    assert last.shape == (1, 2) and np.allclose(whole[-1:], last, rtol=1e-9)


@pytest.mark.parametrize("name", ["penalty", "regularisation"])
def test_errors_of_a_parameter_are_what_half_of_it_changes_twice(name):
    study = Study(SCENE, body=block())
    (found,) = study.history(OF, [], is_judged=True).errors[name]
    key = f"contact.0.{name}_parameter"
    change = values(study, {key: 0.5e-6}) - values(study)
    assert found == pytest.approx(2 * change, rel=0.05, abs=0.02 * np.abs(found).max())


def test_errors_of_the_mesh_are_what_a_finer_one_changes():
    """Local problems see a degree more: some tenths of the error, and its sign."""
    found = Study(SCENE, body=block()).history(OF, [], is_judged=True).errors["mesh"][0]
    fine = values(Study(SCENE, body=box_body((32, 24), (1, 1))))
    change = fine - values(Study(SCENE, body=block()))
    share = found[:, 0] / change[:, 0]
    assert (share > 0.3).all() and (share < 2).all()


def test_errors_of_what_is_tightened_are_those_of_its_length():
    """A bolt whose force is given shortens by more on a finer mesh, which is softer."""
    scene, _, _ = CASES["bolt"]
    bulging = {f"material.{number}.poissons_ratio": 0.3 for number in range(4)}
    scene = with_changes(scene, {**bulging, "preload.0.locked_from": None, "steps": Steps()})
    history = Study(scene, body=joint()).history(["bolt.elongation"], [], is_judged=True)
    fine = Study(scene, body=joint(finer=4)).history([], [])
    before, after = (one.steps[-1].preloads["bolt"].elongation for one in (history, fine))
    share = history.errors["mesh"][0][0, 0] / (after - before)
    assert 0.3 < share < 3


def test_nearly_incompressible_bodies_have_no_error_of_the_mesh():
    scene, make, _ = CASES["nearly incompressible"]
    found = Study(scene, body=make()).history(["normal_force"], [MU], is_judged=True)
    assert set(found.errors) == {"penalty", "regularisation"} and found.checks
