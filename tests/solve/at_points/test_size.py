"""Whether points are too many is known before any matrix between them is made."""

import pytest

from fenics_contact import Steps, run
from fenics_contact.solve.at_points import exact_step
from fenics_contact.solve.coulomb import at_points, strategies
from fenics_contact.trust import exact_bias
from tests.scenes import with_solver
from tests.solve.coulomb.test_at_points import fails
from tests.solve.load_steps.histories import block, dragged


@pytest.mark.errors
def test_of_too_many_points_no_operator_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    made, kind = [], exact_step.PointOperator
    monkeypatch.setattr(exact_step, "PointOperator", lambda *of: made.append(of) or kind(*of))
    for module in (exact_bias, at_points):
        monkeypatch.setattr(module, "_FEW", 16)
    monkeypatch.setattr(strategies, "monolithic", fails)
    scene = with_solver(dragged(Steps(number=1)), errors="auto")
    assert run(scene, body=block()).bias == {}
    assert made == []
