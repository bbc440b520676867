"""Derivatives of answers without penalty and smoothing, beside runs and small parameters."""

import dataclasses

import pytest

from fenics_contact import DerivativeRequest, Obstacle, Study, run
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.scenes import box_body
from tests.simulation.sensitivities.scenes import TABLE
from tests.simulation.sensitivities.table import errors, value_of
from tests.simulation.studies.cases import DEPTH
from tests.solve.at_points.test_exact_scenes import bar, errors_off

PENALTY, SMOOTHING = "penalty_parameter", "regularisation_parameter"


def exact_study(name: str, strategy: str = "exact", **parameters: float | str) -> Study:
    """Of a scene of the table, with these parameters of all contacts."""
    scene, keys = TABLE[name].scene, ("penalty_parameter", "regularisation_parameter")
    changes = {
        f"contact.{number}.{key}": parameters.get(key, "auto")
        for number in range(len(scene.contact))
        for key in keys
    }
    settings = {"errors": "none", "tolerance": 1e-13, "strategy": strategy}
    solver = dataclasses.replace(scene.solver, **settings)
    scene = dataclasses.replace(with_changes(scene, changes), solver=solver)
    return Study(scene, body=TABLE[name].make())


@pytest.mark.parametrize(
    "name",
    [
        "half-space",
        "in space, in load steps",
        "two bodies, in load steps",
        "a plate, in load steps",
        "a bolt that is locked",
        "friction along axes",
        "nearly incompressible",
        "a pressure that comes and goes",
        "an obstacle that turns, in load steps",
    ],
)
def test_they_are_central_differences_of_exact_runs(name: str) -> None:
    of = [one for one in TABLE[name].of if one != "penalty_energy"]
    by = [key for key in TABLE[name].by if not key.endswith((PENALTY, SMOOTHING))]
    found = errors(exact_study(name), of, by)
    assert {pair: error for pair, error in found.items() if not error <= 1} == {}


def test_slip_that_goes_back_beside_exact_contact() -> None:
    elastic = "contact.0.friction_law.elastic_slip"
    study = exact_study("micro-slip, in load steps")
    found = errors(study, ["friction_force_x", "normal_force"], [DEPTH, elastic])
    assert max(found.values()) <= 1


@pytest.mark.parametrize(
    ("key", "size"), [("penalty_parameter", 1e-6), ("regularisation_parameter", 1e-7)]
)
def test_those_by_a_parameter_of_0_are_what_small_ones_change(key: str, size: float) -> None:
    """Quantities with ε₁ or ε are those without, and the derivative times it, to first order."""
    of, none = ["friction_force_x", "indentation"], {PENALTY: 0, SMOOTHING: 0}

    def study(value: float) -> Study:
        return exact_study("in space", "auto", **{**none, key: value})

    slopes, before = study(0).derivatives(of, [f"contact.0.{key}"]), study(0).solve()
    for one in of:
        left = []
        for value in (size, size / 10):
            moved = value_of(study(value).solve(), one) - value_of(before, one)
            left.append(abs(moved / value / slopes[one][f"contact.0.{key}"] - 1))
        assert left[0] < 1e-2
        assert left[1] == pytest.approx(left[0] / 10, rel=0.1)


@pytest.mark.parametrize(("depth", "one_sided"), [(0.0, True), (1e-3, False)])
def test_those_of_points_that_just_touch_are_one_sided(depth: float, one_sided: bool) -> None:
    """A bar on a floor without a force between them: pushed down it has one, lifted none."""
    scene = errors_off(bar(obstacle=Obstacle(indentation=depth)))
    asked = DerivativeRequest(of=("normal_force",), by=(DEPTH,))
    result = run(dataclasses.replace(scene, derivatives=asked), body=box_body((2, 2), (1, 0.5)))
    found = result.derivatives["normal_force"][DEPTH]
    assert found.one_sided == one_sided
    if not one_sided:  # E over the length, 1000/.5
        assert found.discrete == pytest.approx(2000.0, rel=1e-9)
