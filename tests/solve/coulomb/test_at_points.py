"""Penalty and smoothing solved at the points: the answer of Newton's method on the body."""

import dataclasses

import pytest

from fenics_contact import NotConvergedError, Steps, run
from fenics_contact.solve.coulomb import at_points, strategies
from tests.scenes import with_solver
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

SCENES = (
    (dragged(Steps(number=2)), block),
    (dragged(Steps(number=2), driven={"force": 5.0}), block),
    (shoved(Steps(number=2)), two_blocks),
)
NAMES = ("obstacle", "force", "bodies that slide")


def fails(*_given: object, **_keys: object) -> None:
    raise NotConvergedError("made to fail")


@pytest.mark.parametrize(("scene", "body"), SCENES, ids=NAMES)
def test_it_finds_the_answer_of_newtons_method(scene, body, monkeypatch):
    """With the same ε₁ and ε, found from the same pressures but for what ε changes in these."""
    scene = with_solver(scene, errors="none")
    expected = run(scene, body=body())
    monkeypatch.setattr(strategies, "monolithic", fails)
    found = run(scene, body=body())
    assert found.passed
    assert found.model.strategy.endswith("confirmed on the bodies")
    for one, other in zip(expected.steps, found.steps, strict=True):
        for name in ("normal_force", "friction_work", "stick_area", "max_contact_pressure"):
            assert other.quantities[name] == pytest.approx(one.quantities[name], rel=2e-5), name


def test_newtons_method_on_the_body_only_confirms_it(monkeypatch):
    """At a given ε, from which nothing is left to be found: a step at most."""
    confirmed, coupled = [], at_points.solve_coupled

    def counted(newton):
        before = newton.steps
        coupled(newton)
        confirmed.append(newton.steps - before)

    scene = dragged(Steps(number=2))
    contact = dataclasses.replace(scene.contact[0], regularisation_parameter=1e-6)
    scene = dataclasses.replace(scene, contact=(contact,))
    monkeypatch.setattr(strategies, "monolithic", fails)
    monkeypatch.setattr(at_points, "solve_coupled", counted)
    assert run(with_solver(scene, errors="none"), body=block()).passed
    assert confirmed
    assert max(confirmed) <= 1


def test_other_ways_follow_where_it_finds_nothing(monkeypatch):
    monkeypatch.setattr(strategies, "monolithic", fails)
    monkeypatch.setattr(strategies, "solve_at_points", fails)
    result = run(with_solver(dragged(Steps(number=1)), errors="none"), body=block())
    assert result.passed
    assert "alternation" in result.model.strategy or "last pass" in result.model.strategy
