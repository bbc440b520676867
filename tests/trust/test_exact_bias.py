"""What penalty and smoothing change, measured by an exact solve after the run."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import Contact, Material, Obstacle, Scene, Steps, Support, run
from fenics_contact.contact.laws import site
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors


def punched(**contact: object) -> Scene:
    """A rough obstacle comes in and moves along, on half of a block's side."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y0",
                friction_coefficient=0.4,
                obstacle=Obstacle(indentation=0.01, displacement=(0.002, 0)),
                **contact,
            ),
        ),
    )


def on_box(scene: Scene):
    return run(scene, body=box_body((6, 4), (1, 1)))


def test_the_bias_is_the_difference_of_two_runs() -> None:
    smooth, exact = (on_box(with_solver(punched(), strategy=s)) for s in ("auto", "exact"))
    assert smooth.passed
    assert smooth.checks["regularisation"].value < 1e-3
    assert not exact.bias
    assert "regularisation" not in exact.checks
    for name in ("normal_force", "max_contact_pressure", "strain_energy", "stick_area"):
        difference = exact.quantities[name] - smooth.quantities[name]
        assert smooth.bias[name] == pytest.approx(difference, abs=1e-9 * smooth.quantities[name])
        own = smooth.contacts[0].bias.get(name, difference)
        assert own == pytest.approx(smooth.bias[name], abs=1e-9 * smooth.quantities[name])
    assert smooth.bias["normal_force"] > 0  # a penalty gives way
    assert isinstance(smooth.bias["contact_force"], list)


def test_error_bars_of_penalty_and_smoothing_are_as_large_as_the_bias() -> None:
    """Two ways to the same: another answer with a 32nd of ε₁, or of ε, and an exact solver."""
    found = on_box(punched())
    for name in ("normal_force", "max_contact_pressure", "strain_energy"):
        bars = sum(found.errors[name][source] for source in ("penalty", "regularisation"))
        assert abs(found.bias[name]) <= bars <= 1.3 * abs(found.bias[name])


def test_automatic_parameters_that_change_much_fail_a_check(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(site, "_PENALTY_SHARE", 100 * site._PENALTY_SHARE)
    found = on_box(punched())
    assert not found.checks["regularisation"].passed
    given = on_box(punched(penalty_parameter=1e-5))
    assert "regularisation" not in given.checks
    assert given.bias["normal_force"] > 0


def test_the_answer_is_there_as_it_was_after_the_exact_solve() -> None:
    """The state that is resumed, and the fields that are written, are those of the run."""
    contact = dataclasses.replace(punched().contact[0], law="incremental")
    scene = dataclasses.replace(punched(), contact=(contact,), steps=Steps(number=2))
    measured, plain = (on_box(with_solver(scene, exact_check=asked)) for asked in (True, False))
    assert measured.bias
    assert not plain.bias
    assert measured.quantities == plain.quantities
    for name in ("contact_pressure", "friction_traction", "slip"):
        assert np.array_equal(getattr(measured.points, name), getattr(plain.points, name))
