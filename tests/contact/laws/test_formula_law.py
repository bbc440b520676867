"""A pressure by a formula: against closed forms, and against the law that says the same."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Obstacle, Study, run
from fenics_contact.common.errors import SceneError
from tests.contact.laws.test_normal_compliance import block, pressed
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
BALL = Obstacle("parabola", radius=0.5, force=3, position=(0.5, 1))


def law(pressure, **parameters):
    return {"kind": "formula", "pressure": pressure, "parameters": parameters}


@pytest.mark.parametrize(
    ("formula", "parameters", "depth_of", "energy_of"),
    [
        # an asperity model's exponential spring, p = p0 (exp(d/h) − 1)
        (
            "p0 * (exp(d / h) - 1)",
            {"p0": 2.0, "h": 1e-3},
            lambda p: 1e-3 * np.log(1 + p / 2),
            lambda d: 2 * (1e-3 * np.expm1(d / 1e-3) - d),
        ),
        # one that yields: stiff up to 5, a tenth as stiff beyond
        (
            "min(k * d, 5 + .1 * (k * d - 5))",
            {"k": 1e4},
            lambda p: 5e-4 + (p - 5) / 1e3,
            lambda d: 0.5 * 5 * 5e-4 + 5 * (d - 5e-4) + 0.5e3 * (d - 5e-4) ** 2,
        ),
        ("c * sqrt(d) * d", {"c": 4e4}, lambda p: (p / 4e4) ** (2 / 3), lambda d: 1.6e4 * d**2.5),
    ],
)
def test_a_uniform_pressure_sinks_in_as_the_formula_says(formula, parameters, depth_of, energy_of):
    result = run(block(normal_law=law(formula, **parameters)), COMM, box_body((4, 4)))
    depth = depth_of(10)
    assert result.passed, result.verdict
    assert result.points.contact_pressure == pytest.approx(10, rel=1e-8)
    assert -result.points.gap == pytest.approx(depth, rel=1e-8)
    # the energy is an integral by a rule, which a kink makes less exact
    tolerance = 1e-3 if "min" in formula else 1e-8
    assert result.quantities["penalty_energy"] == pytest.approx(energy_of(depth), rel=tolerance)
    assert {"contact_law", "complementarity", "tension"} <= set(result.checks)


def test_the_formula_of_normal_compliance_is_normal_compliance():
    """With friction, pressed by a ball: all quantities to round-off."""
    given = {"kind": "normal compliance", "coefficient": 4e3, "exponent": 1.5}
    keys = {"friction_coefficient": 0.3}
    one, other = (
        run(pressed(BALL, {"normal_law": table} | keys), COMM, box_body((12, 6)))
        for table in (given, law("c * d^m", c=4e3, m=1.5))
    )
    assert one.passed and other.passed
    for name, value in one.quantities.items():
        assert other.quantities[name] == pytest.approx(value, rel=1e-7, abs=1e-10), name


def test_a_study_changes_its_parameters_and_has_their_derivatives():
    scene = pressed(BALL, {"normal_law": law("c * d^m", c=4e3, m=1.5)})
    study, key = Study(scene, COMM, box_body((12, 6))), "contact.0.normal_law.parameters.c"
    low, high = (study.solve({key: c}) for c in (3999.0, 4001.0))
    name = "strain_energy"
    slope = (high.quantities[name] - low.quantities[name]) / 2
    assert study.derivatives([name], [key])[name][key] == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (law("c * d"), "formula_with_unknown_name"),
        (law("__import__('os').system('true')"), "formula_with_a_call"),
        (law("2 + d"), "formula_not_zero_at_contact"),
        (law("d", c=1.0), "parameter_not_in_formula"),
        (law("d^-1"), "formula_not_finite_at_contact"),
        (law("9^9^9^9 * d"), "formula_of_a_huge_power"),
        (law("sqrt(d, 1)"), "formula_with_two_arguments"),
        (law("d)"), "formula_is_none"),
        (law("-" * 200 + "d"), "formula_too_deep"),
        (law("d" * 2000), "formula_too_long"),
        ({"kind": "formulas"}, "no_normal_law_formulas"),
    ],
)
def test_what_is_no_formula_is_refused_in_a_sentence(table, words):
    with refused(words, SceneError):
        Contact("bottom", normal_law=table)
