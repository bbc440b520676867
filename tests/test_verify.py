"""Benchmarks: their formulas against integrals, and that a wrong number does not pass."""

import json
import math

import pytest
from mpi4py import MPI
from scipy.integrate import quad

from fenics_contact import main, verification
from fenics_contact.errors import NotConvergedError
from fenics_contact.verification import Case, Finding, formulas
from fenics_contact.verification.command import verify

COMM = MPI.COMM_WORLD
KEYS = {
    "name",
    "quantity",
    "value",
    "reference",
    "source",
    "error",
    "tolerance",
    "estimated_error",
    "seconds",
    "passed",
}
MODULUS, RADIUS = 1000 / 0.91, 8.0


def test_paraboloid_is_what_its_pressure_integrates_to():
    contact = formulas.paraboloid(MODULUS, RADIUS, 1.0)
    assert contact.force == pytest.approx(4144.2, rel=1e-4)  # as the paper's example 3 has it
    assert contact.peak == pytest.approx(247.34, rel=1e-4)

    def pressure(r):
        return contact.peak * math.sqrt(1 - (r / contact.radius) ** 2)

    force = quad(lambda r: 2 * math.pi * r * pressure(r), 0, contact.radius)[0]
    assert force == pytest.approx(contact.force, rel=1e-8)
    # Boussinesq on the axis, 2 ∫ p dr / E*, gives the indentation.
    assert 2 * quad(pressure, 0, contact.radius)[0] / MODULUS == pytest.approx(1.0, rel=1e-8)


def test_sphere_tends_to_the_paraboloid_and_is_none():
    for indentation in (1e-2, 1e-4):
        force, radius = formulas.sphere(MODULUS, RADIUS, indentation)
        hertz = formulas.paraboloid(MODULUS, RADIUS, indentation)
        assert force == pytest.approx(hertz.force, rel=indentation / RADIUS)
        assert radius == pytest.approx(hertz.radius, rel=indentation / RADIUS)
    assert formulas.sphere(MODULUS, RADIUS, 1.0) == pytest.approx((4092.34, 2.7694), rel=1e-5)


def test_sphere_agrees_with_sneddons_integral():
    """d = ∫₀^a f'(x) a/√(a² − x²) dx and F = 2 E* ∫₀^a f'(x) x²/√(a² − x²) dx, f the profile."""
    force, a = formulas.sphere(MODULUS, RADIUS, 1.0)

    def slope(angle):
        x = a * math.sin(angle)
        return x / math.sqrt(RADIUS**2 - x**2)

    depth = quad(lambda t: a * slope(t), 0, math.pi / 2)[0]
    total = 2 * MODULUS * quad(lambda t: slope(t) * (a * math.sin(t)) ** 2, 0, math.pi / 2)[0]
    assert depth == pytest.approx(1.0, rel=1e-9)
    assert total == pytest.approx(force, rel=1e-9)


def test_line_contact_bends_the_surface_to_the_parabola():
    """Under p₀ √(1 − (x/a)²) the slope is −(2/π E*) ∫ p/(x − s) ds = −x/R (Johnson, (2.25a))."""
    force = formulas.line_force(MODULUS, RADIUS, 2.0)
    contact = formulas.line_contact(MODULUS, RADIUS, force)
    assert contact.radius == pytest.approx(2.0)

    def pressure(x):
        return contact.peak * math.sqrt(1 - (x / 2) ** 2)

    assert quad(pressure, -2, 2)[0] == pytest.approx(force, rel=1e-8)
    for x in (0.3, 1.1):
        integral = -quad(pressure, -2, 2, weight="cauchy", wvar=x)[0]
        assert 2 / (math.pi * MODULUS) * integral == pytest.approx(x / RADIUS, rel=1e-6)


def test_annular_punch_tends_to_the_whole_and_to_a_thin_ring():
    whole = formulas.flat_punch_force(MODULUS, 1.0, 0.01)
    assert formulas.annular_punch_force(MODULUS, 1e-6, 1.0, 0.01) == pytest.approx(whole, rel=1e-6)
    coarse = formulas.annular_punch_force(MODULUS, 0.5, 1.0, 0.01, terms=10)
    fine = formulas.annular_punch_force(MODULUS, 0.5, 1.0, 0.01, terms=40)
    assert coarse == pytest.approx(fine, rel=1e-12)
    # A thin ring of width 2b: F = π² E* d r / ln(16 r/b), as the capacity of a thin torus,
    # whose section is the circle of half the strip's half-width.
    half = 1e-4
    thin = formulas.annular_punch_force(1.0, 1 - half, 1 + half, 1.0)
    assert thin == pytest.approx(math.pi**2 / math.log(16 / half), rel=1e-6)


def test_rows_of_a_quick_case_are_those_of_the_interface(folder, capsys):
    path = folder / "found.json"
    assert main(["verify", "springs", "--quick", "--json", str(path)]) == 0
    (row,) = json.loads(path.read_text(encoding="utf-8"))
    assert set(row) >= KEYS
    assert row["reference"] == pytest.approx(100 * math.pi * 8)
    assert row["passed"] is True
    assert row["estimated_error"] is None
    assert "springs" in COMM.bcast(capsys.readouterr().out)


def test_slab_finds_the_last_sticking_points():
    (case,) = (case for case in verification.CASES if case.name == "slab")
    findings = list(case.run(True))
    assert [finding.passed for finding in findings] == [True] * 8


@pytest.mark.parametrize("arguments", [["nonsense"], ["slab", "nonsense"]])
def test_unknown_name_is_one_sentence_and_exit_2(capsys, arguments):
    assert main(["verify", *arguments]) == 2
    said = COMM.bcast(capsys.readouterr().err)
    assert said.startswith("fenics-contact: verify: no case 'nonsense'; there are slab, ")
    assert said.count("\n") == 1


def test_file_in_no_folder_is_refused_before_any_work(folder, capsys):
    assert main(["verify", "--json", str(folder / "none" / "found.json")]) == 2
    said = capsys.readouterr()
    assert "a folder that can be written to" in COMM.bcast(said.err)
    assert said.out == ""


def made(*findings, error=None):
    def run(quick):
        yield from findings
        if error:
            raise error

    return Case("made", "made up", "nowhere", run)


@pytest.mark.parametrize(
    ("case", "code"),
    [
        (made(Finding("F", 1.001, 1.0, 1e-2)), 0),
        (made(Finding("F", 1.02, 1.0, 1e-2)), 4),
        (made(Finding("F", 104.0, 100.0, 0.05)), 0),
        (made(Finding("F", 104.0, 100.0, 0.05, absolute=True)), 4),
        (made(Finding("F", -1.0, 1.0, 1e-2)), 4),
        (made(Finding("F", math.nan, 1.0, 1e-2)), 4),
        (made(Finding("F", 1.0, 1.0, 1e-2), error=NotConvergedError("no answer")), 4),
    ],
)
def test_only_what_is_within_its_tolerance_passes(folder, capsys, case, code):
    path = folder / "found.json"
    assert verify((), json_file=path, cases=[case]) == code
    rows = json.loads(path.read_text(encoding="utf-8"))
    assert all(row["passed"] for row in rows) == (code == 0)
    said = COMM.bcast(capsys.readouterr().out)
    assert ("FAILED" in said) == (code == 4)
    assert ("no answer" in said) == (rows[-1]["note"] == "no answer")


def test_wrong_solution_fails(monkeypatch):
    """Springs a hundredth too stiff."""
    from fenics_contact.verification import point_cases

    (case,) = (case for case in verification.CASES if case.name == "springs")
    right = point_cases.solved

    def stiffer(scene):
        result = right(scene)
        result.quantities["normal_force"] *= 1.01
        return result

    monkeypatch.setattr(point_cases, "solved", stiffer)
    assert verify((), cases=[case]) == 4


def test_run_that_its_checks_refuse_is_a_finding_that_failed(capsys, monkeypatch):
    from fenics_contact import simulation

    solve = simulation.solve

    def wrong(*arguments):
        solution = solve(*arguments)
        for force in solution.friction_force:
            force *= 0.9
        return solution

    monkeypatch.setattr(simulation, "solve", wrong)
    assert main(["verify", "slab", "--quick"]) == 4
    assert "do not trust it" in COMM.bcast(capsys.readouterr().out)
