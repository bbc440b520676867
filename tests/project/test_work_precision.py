"""The benchmark of error against time says what it measured, on small meshes."""

from __future__ import annotations

import dataclasses
import math
import sys

import pytest

from tests.conftest import COMM

# Its files find each other as where they are run: beside the program.
from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

from precision_cases import ACCURACIES, ADAPTIVE, CASES, METHODS, radius, value_and_bar
from work_precision import measured, plot, reached, select

NAMES = [case.name for case in CASES]
(SLAB,) = (case for case in CASES if case.name == "slab")
QUANTITIES = {
    "normal_force": 4000.0,
    "friction_force": [-200.0, 0.0],
    "contact_area": 25.0,
    "stick_area": 16.0,
}


def budget(**totals):
    """Errors of quantities, of the mesh but for a tenth by the load steps."""
    return {
        name: {"mesh": 0.9 * size, "step": 0.1 * size, "total": size}
        for name, size in totals.items()
    }


def test_cases_are_those_asked_for():
    assert NAMES == ["hertz", "friction", "incremental", "slab", "annulus"]
    for case in CASES:
        assert {"P1 uniform", "Q2 uniform", ADAPTIVE} <= set(case.levels) <= set(METHODS)
        for method in case.levels:
            whole, quick = case.series(method, False), case.series(method, True)
            assert len(whole) > len(quick) >= 2, (case.name, method)
            assert {s.discretisation.degree for s in whole} == {1 if "P1" in method else 2}
            assert {s.solver.errors for s in whole} == {"all"}
            assert {s.accuracy is None for s in whole} == {method != ADAPTIVE}
    assert list(ACCURACIES) == sorted(ACCURACIES, reverse=True)


def test_bars_of_radii_and_ratios_follow_from_those_of_areas():
    errors = budget(contact_area=0.5, stick_area=0.8, normal_force=8.0, friction_force=1.0)

    def found(quantity, without=()):
        return value_and_bar(quantity, QUANTITIES, errors, without)

    assert found("normal_force") == (4000.0, pytest.approx(0.002))
    assert found("normal_force", ("step",)) == (4000.0, pytest.approx(0.0018))
    assert found("friction_force") == (-200.0, pytest.approx(0.005))
    # Against the formulas at areas that are as far off as the bars say.
    value, bar = found("contact_radius")
    assert value == pytest.approx(radius(25.0))
    assert bar == pytest.approx(radius(25.5) / radius(25.0) - 1, rel=0.01)
    value, bar = found("stick_ratio")
    assert value == pytest.approx(0.8)
    assert bar == pytest.approx(math.sqrt(16.8 / 24.5) / 0.8 - 1, rel=0.02)
    errors["stick_area"]["mesh"] = None
    assert found("stick_ratio") == (pytest.approx(0.8), None)


def test_a_target_is_reached_where_the_error_stays_within_it():
    def rows(*errors):
        return [{"seconds": n, "dofs": 10 * n, "error": e} for n, e in enumerate(errors, 1)]

    assert reached(rows(0.1, 0.001, 0.1, 0.005, 0.001), 1e-2) == "4.00 s, 40"
    assert reached(rows(0.1, 0.1), 1e-2) == "-"


@pytest.mark.errors
def test_rows_have_true_and_estimated_errors(folder):
    rows = measured(SLAB, "Q2 uniform", SLAB.series("Q2 uniform", True)[0])
    # Here the first accuracy that asks for a second mesh.
    start = SLAB.series(ADAPTIVE, True)[0]
    scene = dataclasses.replace(start, accuracy=SLAB.asked(3e-3))
    rows += measured(SLAB, ADAPTIVE, scene)
    assert [row["quantity"] for row in rows] == 2 * list(SLAB.references)
    for row in rows:
        assert row["seconds"] > row["estimation_seconds"] > 0
        assert row["error"] == abs(row["value"] / row["reference"] - 1)
        assert 0 < row["error"] < 0.1 and 0 < row["estimated_error"] < 1, row
        if row["quantity"] == "strain_energy":
            assert row["error"] < row["estimated_error"] < 5 * row["error"]
    uniform, adaptive = (select(rows, method=m)[0] for m in ("Q2 uniform", ADAPTIVE))
    assert uniform["dofs"] == 102 and adaptive["dofs"] > 102
    if COMM.rank == 0:
        plot(dataclasses.replace(SLAB, levels={"Q2 uniform": (0, 0)}), rows, folder / "plot.png")
        assert (folder / "plot.png").stat().st_size > 1e4
