"""Stress at points: exact for linear fields, and in a beam that is bent."""

import dataclasses

import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Discretisation,
    Load,
    Material,
    Point,
    Profile,
    Scene,
    SolverSettings,
    Study,
    Support,
    Temperature,
    run,
)
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
E, NU = 1000.0, 0.3
QUIET = SolverSettings(errors="none")


def stretched(dimension, points):
    """A block pulled along x between smooth walls, as far as the plane strains let it."""
    walls = tuple(Support(f"{axis}0", {axis: 0}) for axis in "xyz"[:dimension])
    return Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(E, NU),
        discretisation=Discretisation(1),
        support=walls,
        load=(Load("x1", pressure=-6.0),),
        point=points,
        solver=QUIET,
    )


# Inside, on faces between cells, at a node, on the boundary.
PLACES = ((0.31, 0.22, 0.17), (0.5, 0.3, 0.1), (0.5, 0.5, 0.25), (1.0, 0.4, 0.2))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_uniform_stress_is_exact_anywhere(dimension):
    points = tuple(Point(f"p{i}", at[:dimension]) for i, at in enumerate(PLACES))
    cell = CellType.tetrahedron if dimension == 3 else CellType.triangle
    found = run(stretched(dimension, points), COMM, box_body((2, 2, 2)[:dimension], cell=cell))
    expected = {"xx": 6.0, "yy": 0.0, "zz": 0.0 if dimension == 3 else NU * 6, "xy": 0.0}
    expected |= {"yz": 0.0, "xz": 0.0} if dimension == 3 else {}
    for point in points:
        for name, value in expected.items():
            there = found.quantities[f"stress_{point.name}_{name}"]
            assert there == pytest.approx(value, abs=1e-9), (point.name, name)
    assert ("stress_p0_yz" in found.quantities) == (dimension == 3)


@pytest.mark.parametrize("kinematics", ["3D", "plane strain", "plane stress"])
def test_strains_of_a_bar_are_those_of_hooke(kinematics):
    """Pulled by σ: ε = σ / E along it, and −ν σ / E across; in plane strain E/(1−ν²), ν/(1−ν)."""
    dimension, wide = (3 if kinematics == "3D" else 2), kinematics == "plane strain"
    points = tuple(Point(f"p{i}", at[:dimension]) for i, at in enumerate(PLACES))
    scene = dataclasses.replace(stretched(dimension, points), kinematics=kinematics)
    found = run(scene, COMM, box_body((2, 2, 2)[:dimension])).quantities
    along = 6.0 / E * (1 - NU**2 if wide else 1)
    across = -along * (NU / (1 - NU) if wide else NU)
    expected = {"xx": along, "yy": across, "zz": 0.0 if wide else across, "xy": 0.0}
    for point in points:
        for name, value in expected.items():
            assert found[f"strain_{point.name}_{name}"] == pytest.approx(value, abs=1e-13)
    assert ("strain_p0_yz" in found) == (dimension == 3)


@pytest.mark.parametrize("kinematics", ["3D", "plane strain", "plane stress", "axisymmetric"])
def test_strains_have_what_heat_makes_of_them(kinematics):
    """Free to grow along x and across, held along y: ε_yy = 0, and the others by Hooke."""
    dimension = 3 if kinematics == "3D" else 2
    rise, expansion = 50.0, 2e-5
    free = expansion * rise
    walls = [Support("y0", {"y": 0}), Support("y1", {"y": 0})]
    walls += [Support(f"{axis}0", {axis: 0}) for axis in "xz"[: dimension - 1]]
    scene = Scene(
        kinematics=kinematics,
        material=Material(E, NU, thermal_expansion=expansion),
        support=tuple(walls),
        temperature=(Temperature(value=rise),),
        point=(Point("p", (0.6, 0.3, 0.2)[:dimension]),),
        solver=QUIET,
    )
    found = run(scene, COMM, box_body((2, 2, 2)[:dimension])).quantities
    side = free * (1 + NU)  # of σ_yy = −E α ΔT alone
    expected = {"xx": side, "yy": 0.0, "zz": side, "xy": 0.0}
    if kinematics == "plane strain":  # σ_zz acts, too: σ_yy = σ_zz = −E α ΔT / (1 − ν)
        expected |= {"xx": free * (1 + 2 * NU / (1 - NU)), "zz": 0.0}
    # By a ring's axis nodes are looked at from a millionth inside, which FFCx rounds to the node.
    exact = 1e-8 if kinematics == "axisymmetric" else 1e-13
    for name, value in expected.items():
        assert found[f"strain_p_{name}"] == pytest.approx(value, abs=exact), name


def test_shear_strain_is_half_of_the_change_of_the_angle():
    """And linear: u_x = y² / 10 has ε_xy = y / 10."""
    moved = {"x": lambda x: 0.1 * x[1] ** 2, "y": 0}
    scene = Scene(
        kinematics="plane stress",
        material=Material(E, NU),
        support=(Support("body", moved),),
        point=BENT,
        solver=QUIET,
    )
    found = run(scene, COMM, box_body((3, 2), (3, 1))).quantities
    for point in BENT:
        assert found[f"strain_{point.name}_xy"] == pytest.approx(0.1 * point.at[1], abs=1e-12)


def bent(cell, points):
    """A beam of height 1, held along x at x = 0, with a moment's traction at x = 3; its body."""
    return Scene(
        kinematics="plane stress",
        material=Material(E, NU),
        discretisation=Discretisation(2),
        support=(Support("x0", {"x": 0}),),
        load=(Load("x1", traction=(Profile("y", (0.0, 1.0), (-2.0, 2.0)), 0.0)),),
        point=points,
        solver=dataclasses.replace(QUIET, stabilisation=True),
    ), box_body((3, 2), (3, 1), cell)


BENT = (Point("a", (1.1, 0.8)), Point("b", (2.0, 0.0)), Point("c", (0.7, 0.5)))


@pytest.mark.parametrize("cell", [CellType.triangle, CellType.quadrilateral])
def test_a_linear_stress_is_exact_at_degree_2(cell):
    """Pure bending: σ_xx = 4 (y − ½), and nothing else."""
    scene, body = bent(cell, BENT)
    found = run(scene, COMM, body).quantities
    for point in BENT:
        expected = 4 * (point.at[1] - 0.5)
        assert found[f"stress_{point.name}_xx"] == pytest.approx(expected, abs=1e-8)
        for other in ("yy", "zz", "xy"):
            assert found[f"stress_{point.name}_{other}"] == pytest.approx(0, abs=1e-8)


def test_a_cantilever_has_the_stress_of_beam_theory_away_from_its_ends():
    """σ_xx = M y / I at half its length, which is exact there; and the shear ³⁄₂ F / A."""
    force, height, length = 2.0, 1.0, 8.0
    scene = Scene(
        kinematics="plane stress",
        material=Material(E, NU),
        discretisation=Discretisation(2),
        support=(Support("x0", {"x": 0, "y": 0}),),
        load=(Load("x1", force=(0.0, -force)),),
        point=(Point("top", (4.0, 0.75)), Point("middle", (4.0, 0.5))),
        solver=QUIET,
    )
    found = run(scene, COMM, box_body((32, 8), (length, height))).quantities
    bending = force * (length - 4.0) * 0.25 / (height**3 / 12)
    assert found["stress_top_xx"] == pytest.approx(bending, rel=2e-3)
    assert found["stress_middle_xy"] == pytest.approx(-1.5 * force / height, rel=3e-2)
    assert found["stress_middle_xx"] == pytest.approx(0, abs=1e-6 * bending)


def test_materials_keep_the_stress_that_each_has():
    """Two bars side by side, stretched alike: E ε in each, at a face between them their mean."""
    parts = [
        Box("lower", (0, 0), (2, 1), (4, 2)),
        Box("upper", (0, 1), (2, 2), (4, 2)),
    ]
    scene = Scene(
        kinematics="plane stress",
        material=(Material(1000, 0.0, on="lower"), Material(3000, 0.0, on="upper")),
        discretisation=Discretisation(1),
        support=(
            *(Support(f"{name}.x0", {"x": 0}) for name in ("lower", "upper")),
            *(Support(f"{name}.x1", {"x": 0.01}) for name in ("lower", "upper")),
            Support("lower.y0", {"y": 0}),
        ),
        point=(Point("low", (0.9, 0.95)), Point("high", (0.9, 1.05)), Point("face", (0.9, 1.0))),
        solver=QUIET,
    )
    found = run(scene, COMM, boxes(parts, "triangle", welded=[("lower", "upper")])).quantities
    assert found["stress_low_xx"] == pytest.approx(5.0, rel=1e-6)
    assert found["stress_high_xx"] == pytest.approx(15.0, rel=1e-6)
    assert found["stress_face_xx"] == pytest.approx(10.0, rel=1e-6)


def test_ranks_and_quick_answers_have_the_same():
    scene, body = bent(CellType.triangle, BENT)
    scene = dataclasses.replace(scene, support=(Support("x0", {"x": 0, "y": 0}),))
    names = [f"stress_{point.name}_{one}" for point in BENT for one in ("xx", "yy", "xy")]
    here = run(scene, COMM, body).quantities
    own = box_body((3, 2), (3, 1), CellType.triangle, comm=MPI.COMM_SELF)
    alone = run(scene, MPI.COMM_SELF, own)
    quick = Study(scene, COMM, body).solve({"load.0.traction.0.values": [-4.0, 4.0]}).quantities
    for name in names:
        assert here[name] == pytest.approx(alone.quantities[name], abs=1e-9)
        assert quick[name] == pytest.approx(2 * here[name], abs=1e-9)


@pytest.mark.errors
def test_it_has_no_error_bar():
    scene, body = bent(CellType.quadrilateral, BENT)
    found = run(with_solver(scene, errors="all"), COMM, body)
    assert "displacement_a" in found.errors
    assert "stress_a_xx" not in found.errors
