"""Benchmarks: their formulas against integrals, and that a wrong number does not pass."""

import json
import math

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import quad
from scipy.sparse import csr_matrix

from fenics_contact import main, verification
from fenics_contact.analytic import contact as formulas
from fenics_contact.analytic.half_space import cerruti
from fenics_contact.analytic.two_bodies import AiryField, Tube
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import gather_rows
from fenics_contact.verification import Case, Finding
from fenics_contact.verification.command import verify
from tests.messages import says

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


def test_partial_slip_carries_the_shear_and_no_more_than_friction():
    contact = formulas.line_contact(MODULUS, RADIUS, formulas.line_force(MODULUS, RADIUS, 2.0))

    def traction(x, stick=1.2):
        return formulas.partial_slip(contact, 0.3, stick, np.array([x]))[0]

    shear = quad(traction, -2, 2, points=[-1.2, 1.2])[0]
    assert shear == pytest.approx(0.3 * contact.force * (1 - 0.6**2), rel=1e-8)
    assert traction(1.5) == pytest.approx(0.3 * contact.peak * math.sqrt(1 - 0.75**2))
    assert traction(0.0) == pytest.approx(0.3 * contact.peak * 0.4)


def test_partial_slip_moves_a_sphere_as_its_traction_does():
    """Mindlin's traction by Cerruti's displacements, integrated around the middle."""
    nu, shear_modulus, coefficient, stick = 0.3, 1000 / 2.6, 0.4, 0.7
    contact = formulas.paraboloid(MODULUS, RADIUS, 1.0)
    a, c = contact.radius, stick * contact.radius

    def traction(r):
        inner = stick * math.sqrt(max(1 - (r / c) ** 2, 0.0))
        return coefficient * contact.peak * (math.sqrt(1 - (r / a) ** 2) - inner)

    angles = (np.arange(8) + 0.5) * np.pi / 4
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    along, inward = np.eye(3)[0], -np.eye(3)[2]
    around = cerruti(ring, along, inward, 1000, nu) @ along
    mean = 2 * np.pi * around.mean()  # of r · displacement over the angle
    moved = mean * quad(traction, 0, a, points=[c])[0]
    shear = quad(lambda r: 2 * math.pi * r * traction(r), 0, a, points=[c])[0]
    share = shear / (coefficient * contact.force)
    assert share == pytest.approx(1 - stick**3)
    found = formulas.partial_slip_shift(contact, coefficient, share, shear_modulus, nu)
    assert found == pytest.approx(moved, rel=1e-8)
    slope = formulas.partial_slip_shift(contact, coefficient, 1e-6, shear_modulus, nu)
    stuck = 1e-6 * coefficient * contact.force * (2 - nu) / (8 * shear_modulus * a)
    assert slope == pytest.approx(stuck, rel=1e-5)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9, 1.0])
def test_cycle_of_shear_loses_what_its_loop_encloses(share):
    """∮ Q dδ of Mindlin's δ(Q), and its way back by Masing's rule: doubled, from the turn."""
    nu, shear_modulus, coefficient = 0.3, 1000 / 2.6, 0.4
    contact = formulas.paraboloid(MODULUS, RADIUS, 1.0)
    properties = shear_modulus, nu
    strongest = coefficient * contact.force

    def moved(share):
        return formulas.partial_slip_shift(contact, coefficient, share, *properties)

    def width(part):  # of the loop at Q = part μP, between the way there and the way back
        back = moved(share) - 2 * moved((share - part) / 2)
        there = -moved(share) + 2 * moved((share + part) / 2)
        return back - there

    area = strongest * quad(width, -share, share)[0]
    lost = formulas.partial_slip_loss(contact, coefficient, share, *properties)
    assert lost == pytest.approx(area, rel=1e-8)


def test_pressing_loses_what_little_friction_takes_on_the_way():
    """μ p on the slip rate, with u_r = −(1 − 2ν)(1 + ν)/E ∫ p s ds / r of any pressure inside r."""
    nu, modulus = 0.3, 1000.0

    def pressure(r, a):
        return 2 * MODULUS / (np.pi * RADIUS) * math.sqrt(max(a**2 - r**2, 0.0))

    def moved(r, a):
        inside = quad(lambda s: pressure(s, a) * s, 0, min(r, a))[0]
        return -(1 - 2 * nu) * (1 + nu) / modulus * inside / r

    def power(r, a, step=1e-5):
        rate = (moved(r, a + step) - moved(r, a - step)) / (2 * step)
        return 2 * math.pi * r * pressure(r, a) * abs(rate)

    # Self-similar: the power at a contact radius a grows like a⁴, work to a like a⁵.
    loss = 2 * quad(power, 1e-6, 1, args=(1,), epsrel=1e-6)[0] / 5
    work = 8 / 15 * MODULUS / RADIUS**2
    assert formulas.pressing_loss(1.0, nu) == pytest.approx(loss / work, rel=1e-4)


@pytest.mark.parametrize(("modulus", "poisson"), [(1000.0, 0.2), (300.0, 0.4)])
def test_airy_field_is_in_equilibrium_and_lies_flat_on_the_interface(modulus, poisson):
    """Stresses from its displacements, by differences, at points around the interface."""
    field = AiryField(1.0, 0.6, math.pi, 1.0, modulus, poisson)
    shear = modulus / 2 / (1 + poisson)
    volume = 2 * shear * poisson / (1 - 2 * poisson)
    step = 1e-3

    def gradient(function, points):
        moved = step * np.eye(3)[:2, :, None]
        return [(function(points + by) - function(points - by)) / (2 * step) for by in moved]

    def stress(points):
        (xx, xy), (yx, yy) = (gradient(f, points) for f in (field.along, field.across))
        dilation = volume * (xx + yy)
        return 2 * shear * xx + dilation, 2 * shear * yy + dilation, shear * (xy + yx)

    points = np.array([[0.1, 0.4, 0.8], [-0.3, 0.2, 0.0], [0.0, 0.0, 0.0]])
    xx_x, _ = gradient(lambda x: stress(x)[0], points)
    xy_x, xy_y = gradient(lambda x: stress(x)[2], points)
    _, yy_y = gradient(lambda x: stress(x)[1], points)
    assert np.abs(xx_x + xy_y).max() < 1e-4 * np.abs(xx_x).max()
    assert np.abs(xy_x + yy_y).max() < 1e-4 * np.abs(xx_x).max()
    points[1] = 0.0
    assert field.across(points) == pytest.approx(0, abs=1e-15)
    assert -stress(points)[1] == pytest.approx(field.pressure(points[0]), rel=1e-4)
    assert stress(points)[2] == pytest.approx(0, abs=1e-4)


def test_rows_of_a_quick_case_are_those_of_the_interface(folder, capsys):
    path = folder / "found.json"
    assert main(["verify", "springs", "--quick", "--json", str(path)]) == 0
    (row,) = json.loads(path.read_text(encoding="utf-8"))
    assert set(row) >= KEYS
    assert row["reference"] == pytest.approx(100 * math.pi * 8)
    assert row["passed"] is True
    assert row["estimated_error"] is None
    (mesh,) = row["meshes"]
    assert mesh.startswith("axisymmetric: ") and "unknowns" in mesh
    assert "springs" in COMM.bcast(capsys.readouterr().out)


def test_slab_finds_the_last_sticking_points():
    (case,) = (case for case in verification.CASES if case.name == "slab")
    findings = list(case.run(True))
    assert [finding.passed for finding in findings] == [True] * 8


def test_pressing_and_taking_back():
    (case,) = (case for case in verification.CASES if case.name == "pressing")
    findings = list(case.run(True))
    assert [finding.passed for finding in findings] == [True] * 3


def test_lame_by_the_equation_of_equilibrium():
    """Displacements A r + B/r with no pressure on one side of a wall and 1 on the other."""
    inner, outer, modulus, ratio = 2.0, 3.0, 7.0, 0.3
    lame, shear = modulus * ratio / (1 + ratio) / (1 - 2 * ratio), modulus / (2 + 2 * ratio)
    rows = np.array([[2 * (lame + shear), -2 * shear / r**2] for r in (inner, outer)])
    tube = Tube(inner, outer, modulus, ratio)
    for at, side, pushed in ((inner, "inside", (-1, 0)), (outer, "outside", (0, -1))):
        a, b = np.linalg.solve(rows, pushed)
        assert tube.compliance(at, side, is_long=True) == pytest.approx(abs(a * at + b / at))
    soft = 2 * lame * shear / (lame + 2 * shear)  # in place of λ, where ends are free
    rows[:, 0] = 2 * (soft + shear)
    a, b = np.linalg.solve(rows, (-1, 0))
    assert tube.compliance(inner, "inside", is_long=False) == pytest.approx(a * inner + b / inner)


@pytest.mark.parametrize("name", ["press_fit", pytest.param("joint", marks=pytest.mark.errors)])
def test_fits_and_joints(name):
    (case,) = (case for case in verification.CASES if case.name == name)
    findings = list(case.run(True))
    assert len(findings) > 10
    assert [finding for finding in findings if not finding.passed] == []


@pytest.mark.parametrize(
    "name",
    [
        "patch",
        "airy",
        "pair_solvers",
        "pair_reaction",
        "pair_rigid",
        "incline",
        "resting",
        "torque",
        pytest.param("cells", marks=pytest.mark.errors),
        pytest.param("temperature", marks=pytest.mark.errors),
        "temperature_joint",
        "heat",
        "exact",
    ],
)
def test_two_bodies(name):
    (case,) = (case for case in verification.CASES if case.name == name)
    findings = list(case.run(True))
    assert [finding for finding in findings if not finding.passed] == []


def test_surface_taken_to_the_nearest_nodes_fails_the_patch_test(monkeypatch):
    """Forces are in balance, and yet no uniform pressure crosses meshes that do not match."""
    from fenics_contact.contact.mortar import pairing
    from fenics_contact.contact.mortar.projection import (
        MortarIntegrals,
        NodalProjection,
        Projection,
    )
    from fenics_contact.contact.mortar.spread_projection import SlaveRows

    class Nearest:
        def __init__(self, rows):
            self.whole = rows.gathered()
            self.slave, self.master = rows.slave, rows.master

        def apply(self, values):
            found = self.whole.apply(gather_rows(COMM, values))
            return found[self.slave.numbers[: self.slave.owned_nodes]]

        def transposed(self, forces):
            found = self.whole.transposed(gather_rows(COMM, forces))
            return found[self.master.numbers[: self.master.owned_nodes]]

        def destroy(self):
            """Nothing of PETSc's."""

    def nearest(part):
        found = part.apply(np.eye(part.shape[1]))
        nodes = np.zeros_like(found)
        nodes[np.arange(len(found)), found.argmax(axis=1)] = found.any(axis=1)
        integrals = MortarIntegrals(csr_matrix(np.eye(len(found))), csr_matrix(nodes), np.ones(0))
        every = np.ones(len(found), dtype=bool)
        return NodalProjection.between(integrals, ~every, every)

    straight = SlaveRows.gathered
    monkeypatch.setattr(
        SlaveRows, "gathered", lambda rows: Projection(map(nearest, straight(rows).components))
    )
    monkeypatch.setattr(pairing, "SpreadProjection", Nearest)
    (case,) = (case for case in verification.CASES if case.name == "patch")
    assert verify((), quick=True, cases=[case]) == 4


@pytest.mark.parametrize("arguments", [["nonsense"], ["slab", "nonsense"]])
def test_unknown_name_lists_all_in_lines_and_exit_2(capsys, arguments):
    assert main(["verify", *arguments]) == 2
    said = COMM.bcast(capsys.readouterr().err)
    assert said.startswith("fenics-contact: verify: no case 'nonsense'; there are\n  slab, ")
    listed = said.split("there are")[1].replace(",", "").split()
    assert listed == [case.name for case in verification.CASES]
    assert max(map(len, said.splitlines())) <= 110


def test_name_that_is_misspelt_has_a_hint(capsys):
    assert main(["verify", "slap"]) == 2
    says("no_case_slap", COMM.bcast(capsys.readouterr().err))


def test_file_in_no_folder_is_refused_before_any_work(folder, capsys):
    assert main(["verify", "--json", str(folder / "none" / "found.json")]) == 2
    said = capsys.readouterr()
    says("verified_into_no_folder", COMM.bcast(said.err))
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


def test_no_number_is_cut_in_a_file(capsys):
    name = "what is " + 10 * "long and longer "
    assert verify((), cases=[made(Finding(name, 1.2345678, 1.2345, 1e-2))]) == 0
    said = COMM.bcast(capsys.readouterr().out)
    assert f"{name.strip()} " in said and "…" not in said
    assert "1.234568" in said and "5.5e-05" in said


def test_wrong_solution_fails(monkeypatch):
    """Springs a hundredth too stiff."""
    from fenics_contact.verification.published import indenters as point_cases

    (case,) = (case for case in verification.CASES if case.name == "springs")
    right = point_cases.solved

    def stiffer(scene):
        result = right(scene)
        result.quantities["normal_force"] *= 1.01
        return result

    monkeypatch.setattr(point_cases, "solved", stiffer)
    assert verify((), cases=[case]) == 4


def test_run_that_its_checks_refuse_is_a_finding_that_failed(capsys, monkeypatch):
    from fenics_contact.solve.load_steps.load_steps import LoadSteps

    solve = LoadSteps.solve

    def spoiled(self, *listeners):
        solution = solve(self, *listeners)
        for force in solution.friction_force:
            force *= 0.9
        return solution

    monkeypatch.setattr(LoadSteps, "solve", spoiled)
    assert main(["verify", "slab", "--quick"]) == 4
    assert "do not trust it" in COMM.bcast(capsys.readouterr().out)


def test_bars_are_relative_where_errors_are():
    assert Finding("half", 2.0, 4.0, 0.6, bar=1.0).estimated_error == 0.25
    assert Finding("half", 2.0, 4.0, 3.0, absolute=True, bar=1.0).estimated_error == 1.0
    assert Finding("half", 2.0, 4.0, 0.6).estimated_error is None
