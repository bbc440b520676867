"""Inputs of CalculiX's tests, and that their numbers tell a wrong answer."""

import pytest

from fenics_contact.scene.body import Material
from fenics_contact.verification.calculix import beams, rings

CASES = (*beams.CALCULIX_BEAM_CASES, *rings.CALCULIX_RING_CASES)


def inputs(findings):
    """Names of the inputs that findings are of."""
    return {finding.quantity.split(":")[0].split(",")[0] for finding in findings}


@pytest.mark.parametrize(("case", "number"), list(zip(CASES, (16, 6), strict=True)))
def test_stated_results_are_met(case, number):
    findings = list(case.run(True))
    assert len(inputs(findings)) == number
    assert [finding for finding in findings if not finding.passed] == []


@pytest.mark.parametrize(
    ("module", "part"),
    [
        (beams, "_rigid"),
        (beams, "_twisted"),
        (beams, "_sprung"),
        (rings, "_rotating"),
        (rings, "_long"),
    ],
)
def test_body_that_is_too_soft_is_told(monkeypatch, module, part):
    """By a fiftieth: every input has a number that fails."""
    monkeypatch.setattr(module, "STEEL", Material(206e3, 0.3, density=7.8e-9))
    findings = list(getattr(module, part)(True))
    failed = [finding for finding in findings if not finding.passed]
    assert inputs(failed) == inputs(findings)
