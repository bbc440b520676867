"""Sectors of rings against whole rings, of which they are copies, and against formulas."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    CyclicSymmetry,
    Discretisation,
    Load,
    Material,
    Motion,
    Point,
    Rotation,
    Run,
    Scene,
    SolverSettings,
    Study,
    Support,
    SupportAxes,
    Temperature,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve import solver_choice
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.problem.rings import ring
from tests.problem.sectors import SECTORS, around, fitted, hub_on_shaft, sector

COMM = MPI.COMM_WORLD
E, NU = 1000.0, 0.3
CUT = CyclicSymmetry("ring.x0", "ring.x1", SECTORS)
SUMS = ("pressure_integral", "contact_area", "strain_energy", "external_work", "slip_area")


def pair(mesh=None, **scene):
    """Results of the whole and of its sector."""
    mesh = mesh or {}
    whole = Run(fitted(True, **scene), COMM, hub_on_shaft(SECTORS, **mesh)).solve()
    return whole, sector(mesh, **scene).solve()


def off_at_points(whole, part, name):
    """Largest difference of an array at the sector's points from the same points of the whole."""
    apart = part.points.coordinates[:, None] - whole.points.coordinates
    same = np.linalg.norm(apart, axis=2)
    assert same.min(axis=1).max() < 1e-9
    ours, others = (getattr(one.points, name) for one in (part, whole))
    return np.abs(ours - others[same.argmin(axis=1)]).max() / np.abs(others).max()


@pytest.mark.parametrize(
    ("scene", "mesh"),
    [
        ({}, {}),
        ({"slave": "on", "law": "incremental"}, {}),
        ({"solver": "full"}, {}),
        ({}, {"cells": ((2, 2), (3, 2)), "order": 2}),
        ({"solver": "full", "slave": "on"}, {"cells": ((3, 2), (2, 2)), "order": 2}),
        ({}, {"cell": "triangle", "cells": ((3, 2), (3, 2))}),
        ({"dimension": 3}, {"dimension": 3, "cells": ((1, 1), (1, 1))}),
    ],
)
def test_a_hub_on_a_shaft_is_that_of_the_whole(scene, mesh):
    """Pressed, twisted, partly slipping: pressures and friction are the same at every point."""
    whole, part = pair(mesh, **scene)
    assert part.passed, part.verdict
    assert part.model.symmetry == "1 of 12 sectors about z"
    assert off_at_points(whole, part, "contact_pressure") < 1e-8
    assert off_at_points(whole, part, "friction_traction") < 1e-8
    if not mesh:
        assert 0.1 < part.quantities["slip_area"] / part.quantities["contact_area"] < 0.9
    for name in SUMS:
        value = part.cyclic_symmetry.whole[name]
        assert value == pytest.approx(whole.quantities[name], rel=1e-8)
        assert value == pytest.approx(SECTORS * part.quantities[name])


def pressed_ring(share, layers=4, cells=4, **scene):
    body = ring(cells if share < 1 else cells * SECTORS, turn=share, layers=layers)
    given = {
        "kinematics": "plane stress",
        "material": Material(E, NU, density=2e-3),
        "discretisation": Discretisation(2),
        "point": (Point("bore", (10.0, 0.0)),),
        "cyclic_symmetry": CUT if share < 1 else None,
    }
    return Run(Scene(**(given | scene)), COMM, body)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_sector_under_pressure_follows_lame(solver):
    """u(a) of a ring under pressure p inside; what turns freely is held where nothing acts."""
    settings = SolverSettings(solver=solver, stabilisation=True)
    result = pressed_ring(1 / SECTORS, load=(Load("ring.y0", pressure=1),), solver=settings).solve()
    assert result.passed, result.verdict
    inner, outer = 10.0, 30.0
    share = (outer**2 + inner**2) / (outer**2 - inner**2)
    expected = inner / E * (share + NU)
    assert result.quantities["displacement_bore"][0] == pytest.approx(expected, rel=1e-3)
    # Hoop stress pulls at the cut: its resultant is p a.
    across = result.cyclic_symmetry
    assert np.linalg.norm(across.force) == pytest.approx(inner, rel=1e-3)
    assert across.jump == pytest.approx(0, abs=1e-12)


def test_a_sector_of_a_rotor():
    """Hoop stress at the bore, E u/a = ρω²/4 ((3 + ν) b² + (1 − ν) a²)."""
    speed, inner, outer = 1.5, 10.0, 30.0
    settings = SolverSettings(stabilisation=True)
    load = Load("ring", rotation=Rotation(speed))
    result = pressed_ring(1 / SECTORS, load=(load,), solver=settings).solve()
    assert result.passed, result.verdict
    hoop = 2e-3 * speed**2 / 4 * ((3 + NU) * outer**2 + (1 - NU) * inner**2)
    assert result.quantities["displacement_bore"][0] == pytest.approx(inner * hoop / E, rel=5e-4)


def test_a_sector_that_is_twisted():
    """τ = T/(2π r²): held inside, its rim turns by T/(4πG) (1/a² − 1/b²)."""
    inner, outer, shear = 10.0, 30.0, 0.1
    held = Support("ring.y0", {"x": 0, "y": 0})
    load = Load("ring.y1", traction=around(shear))
    point = Point("rim", (outer, 0.0))
    scene = {"support": (held,), "load": (load,), "point": (point,)}
    result = pressed_ring(1 / SECTORS, layers=8, **scene).solve()
    assert result.passed, result.verdict
    torque = 2 * np.pi * outer**2 * shear
    modulus = E / (2 * (1 + NU))
    turn = torque / (4 * np.pi * modulus) * (1 / inner**2 - 1 / outer**2)
    assert result.quantities["displacement_rim"][1] == pytest.approx(turn * outer, rel=2e-3)
    assert result.cyclic_symmetry.whole["torque"] == pytest.approx(-torque, rel=1e-5)
    # Across the cut acts τ along the radius, ∫ τ dr.
    expected = torque / (2 * np.pi) * (1 / inner - 1 / outer)
    assert abs(result.cyclic_symmetry.force[0]) == pytest.approx(expected, rel=5e-3)


def graded(dimension, cell="", amount=0.3, skew=0.0):
    """A sector of a ring whose cut faces are divided differently.

    Args:
        dimension: 2 or 3.
        cell: Kind of the cells.
        amount: By which they differ.
        skew: Angle by which the rim is ahead of the bore: the faces are curved then (radian).
    """
    length = 2.0 if dimension == 3 else None
    body = ring(3, order=1, turn=1 / SECTORS, layers=4, cell=cell, length=length)
    x = body.mesh.geometry.x
    turned, share = np.arctan2(x[:, 1], x[:, 0]), (np.hypot(x[:, 0], x[:, 1]) - 10) / 20
    ahead = turned * SECTORS / (2 * np.pi)
    share = share + amount * share * (1 - share) * ahead
    if dimension == 3:
        x[:, 2] += 0.5 * amount * x[:, 2] * (2 - x[:, 2]) * np.cos(turned * SECTORS / 2)
    turned, radius = turned + skew * share, 10 + 20 * share
    x[:, 0], x[:, 1] = radius * np.cos(turned), radius * np.sin(turned)
    return body


@pytest.mark.parametrize(
    ("dimension", "cell", "degree", "solver"),
    [
        (2, "triangle", 1, "condensed"),
        (2, "quadrilateral", 2, "full"),
        (3, "hexahedron", 1, "condensed"),
        (3, "tetrahedron", 2, "full"),
    ],
)
def test_a_uniform_stress_crosses_a_cut_that_does_not_match(dimension, cell, degree, solver):
    """Pressed inside and outside: u = −k (x, y), exactly, for faces on meshes of their own."""
    flat = dimension == 2
    scene = Scene(
        kinematics="plane strain" if flat else "3D",
        material=Material(E, NU),
        discretisation=Discretisation(degree),
        support=() if flat else (Support("ring.z0", {"z": 0}),),
        load=tuple(Load(f"ring.{side}", pressure=1) for side in ("y0", "y1")),
        point=(Point("bore", (10.0, 0.0, 0.0)[:dimension]),),
        solver=SolverSettings(solver=solver, stabilisation=True),
        cyclic_symmetry=CyclicSymmetry(
            "ring.x0", "ring.x1", SECTORS, None if flat else (0, 0, 1), (0.0,) * dimension
        ),
    )
    run = Run(scene, COMM, graded(dimension, cell))
    result = run.solve()
    assert result.passed, result.verdict
    shrunk = (1 + NU) * (1 - 2 * NU) / E if flat else (1 - NU) / E
    places = run.problem.spaces.coordinates[:, :2]
    moved = run.problem.displacement.x.array.reshape(-1, dimension)[:, :2] + shrunk * places
    # What turns freely is held at some displacement: apart from that turn it is exact.
    across = np.einsum("ni,ni->n", moved, places) / (places**2).sum(axis=1)
    about = (moved[:, 1] * places[:, 0] - moved[:, 0] * places[:, 1]) / (places**2).sum(axis=1)
    turns = COMM.allreduce(about.max(), MPI.MAX), COMM.allreduce(about.min(), MPI.MIN)
    assert np.abs(across).max() < 1e-10 * shrunk
    assert turns[0] - turns[1] < 1e-10 * shrunk


def test_a_cut_that_does_not_match_twists():
    """As a sector of equal faces: curved ones, which facets approximate differently."""
    shear, outer = 0.1, 30.0
    scene = Scene(
        kinematics="plane stress",
        material=Material(E, NU),
        discretisation=Discretisation(2),
        support=(Support("ring.y0", {"x": 0, "y": 0}),),
        load=(Load("ring.y1", traction=around(shear)),),
        cyclic_symmetry=CUT,
    )
    found = [Run(scene, COMM, graded(2, amount=amount, skew=0.1)).solve() for amount in (0.0, 0.3)]
    assert all(result.passed for result in found)
    energies = [result.quantities["strain_energy"] for result in found]
    assert energies[1] == pytest.approx(energies[0], rel=2e-3)
    assert found[1].cyclic_symmetry.whole["torque"] == pytest.approx(
        -2 * np.pi * outer**2 * shear, rel=2e-2
    )


def pinwheel(whole, at=(0.0, 0.0), solver="condensed", dimension=2):
    """A square, or a bar, that is pushed along its sides; a quarter of it has its middle in it."""
    end = (2.0, 2.0, 1.0)[:dimension]
    low = tuple(-x for x in end[:2]) if whole else (0.0, 0.0)
    cells = (8, 8) if whole else (4, 4)
    more = ((0.0,), (2,)) if dimension == 3 else ((), ())
    kind = "quadrilateral" if dimension == 2 else "hexahedron"
    body = boxes([Box("bar", (*low, *more[0]), end, (*cells, *more[1]))], kind)
    body.mesh.geometry.x[:, :2] += at
    sides = {"x1": (0, 1), "y1": (-1, 0), "x0": (0, -1), "y0": (1, 0)}
    ends = sides if whole else ("x1", "y1")
    axes = SupportAxes(cylindrical=(0, 0, 1), at=(*at, 0.0)[:dimension])
    springs = {"radial": 30.0, "around": 10.0} | ({"axial": 1.0} if dimension == 3 else {})
    axis = (0, 0, 1) if dimension == 3 else None
    cut = CyclicSymmetry("bar.x0", "bar.y0", 4, axis, (*at, 0.0)[:dimension])
    return Run(
        Scene(
            kinematics="plane strain" if dimension == 2 else "3D",
            material=Material(E, NU),
            support=tuple(
                Support(f"bar.{side}", foundation_stiffness=springs, axes=axes) for side in ends
            ),
            load=tuple(
                Load(f"bar.{side}", traction=(*sides[side], 0.1)[:dimension]) for side in ends
            ),
            point=(Point("corner", (2 + at[0], 2 + at[1], 1.0)[:dimension]),),
            solver=SolverSettings(solver=solver),
            cyclic_symmetry=None if whole else cut,
        ),
        COMM,
        body,
    )


@pytest.mark.parametrize("solver", ["condensed", "full"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_quarter_with_the_axis_inside(solver, dimension):
    """The node on the axis belongs to both faces, and moves along the axis alone."""
    at = (0.7, -0.4)
    found = [pinwheel(w, at, solver, dimension).solve().quantities for w in (True, False)]
    for name in ("displacement_corner", "strain_energy"):
        scale = 4 if name == "strain_energy" else 1
        assert scale * np.array(found[1][name]) == pytest.approx(found[0][name], rel=1e-9)
    assert np.abs(found[1]["displacement_corner"]).min() > 1e-4


@pytest.mark.parametrize(("dimension", "motions"), [(2, 1), (3, 2)])
def test_what_moves_freely_goes_along_the_axis_or_turns_about_it(dimension, motions):
    run = pinwheel(False, dimension=dimension)
    scene = dataclasses.replace(run.scene, support=(), load=())
    rigid = RigidMotions(Problem.on_mesh(scene, run.problem.body))
    assert rigid.count == motions
    names = [rigid.describe(one) for one in np.eye(motions)]
    assert names == ["translation along z", "rotation about z"][-motions:]


def test_a_fit_by_any_number_of_answers_and_its_derivatives():
    """Of the interference and the pressure, against central differences."""
    of, keys = ("strain_energy", "pressure_integral"), ("contact.0.interference",)
    study = Study(fitted(False, twist=0.0), body=hub_on_shaft(1))
    slopes = study.derivatives(of, by=keys)
    step = 1e-5
    ends = [study.solve({keys[0]: 0.02 + sign * step}).quantities for sign in (1, -1)]
    for name in of:
        expected = (ends[0][name] - ends[1][name]) / (2 * step)
        assert slopes[name][keys[0]] == pytest.approx(expected, rel=1e-4)


@pytest.mark.errors
def test_error_bars_of_a_sector_hold_what_a_finer_mesh_changes():
    coarse, fine = (
        sector({"cells": cells}, twist=0.0, errors="all").solve()
        for cells in (((4, 2), (4, 3)), ((12, 6), (12, 9)))
    )
    for name in ("pressure_integral", "strain_energy"):
        change = abs(fine.quantities[name] - coarse.quantities[name])
        assert change < 1.5 * coarse.errors[name]["total"] < 20 * change


def test_cut_faces_that_are_no_copies():
    body = hub_on_shaft(1)
    for cut, message in (
        (CyclicSymmetry("cut0", "cut1", 11), "sector_of_another_angle"),
        (CyclicSymmetry("cut0", "cut1", SECTORS, at=(0.1, 0.0)), "sector_about_another_point"),
        (CyclicSymmetry("cut0", "shaft.x1", SECTORS), "sector_with_half_a_face"),
    ):
        with refused(message):
            Run(dataclasses.replace(fitted(False), cyclic_symmetry=cut), COMM, body)


def test_supports_that_hold_one_face_otherwise():
    scene = dataclasses.replace(fitted(False), support=(Support("shaft.y0", {"x": 0}),))
    with refused("sector_held_otherwise"):
        Run(scene, COMM, hub_on_shaft(1))


def test_a_face_without_facets():
    body = hub_on_shaft(1)
    groups = {**body.groups, "none": dataclasses.replace(body.groups["cut0"], tags=(99,))}
    cut = CyclicSymmetry("none", "cut0", SECTORS)
    with refused("sector_face_without_facets"):
        Run(
            dataclasses.replace(fitted(False), cyclic_symmetry=cut),
            COMM,
            dataclasses.replace(body, groups=groups),
        )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cyclic_symmetry": CyclicSymmetry("a", "b", 4, (0, 0, 1))}, "sector_with_axis_in_plane"),
        ({"cyclic_symmetry": CyclicSymmetry("a", "b", 4, at=(0, 0, 0))}, "sector_at_of_three"),
        ({"kinematics": "3D", "cyclic_symmetry": CyclicSymmetry("a", "b", 4)}, "sector_no_axis"),
        ({"kinematics": "axisymmetric"}, "sector_of_revolution"),
        ({"motion": Motion(end=1.0, step=0.1)}, "sector_with_motion"),
        ({"solver": SolverSettings(solver="iterative")}, "sector_iterative"),
    ],
)
def test_what_a_sector_cannot_have(change, message):
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU, density=1.0),
        cyclic_symmetry=CyclicSymmetry("a", "b", 4),
    )
    with refused(message):
        dataclasses.replace(scene, **change)


def test_names_and_axes_of_a_sector():
    with refused("sector_of_one_face"):
        CyclicSymmetry("a", "a", 4)
    with refused("sector_along_nothing"):
        CyclicSymmetry("a", "b", 4, axis=(0, 0, 0))


def test_an_axis_along_none_of_the_model():
    """The quarter with the axis inside, turned in space: moved and strained alike."""
    upright = pinwheel(False, dimension=3)
    found = upright.solve()
    scene, body = upright.scene, upright.problem.body
    axis = np.array([1.0, 2.0, -2.0]) / 3
    beside = np.array([2.0, 1.0, 2.0]) / 3
    turn = np.column_stack([beside, np.cross(axis, beside), axis])

    def turned(vector):
        return tuple((turn @ vector).tolist())

    body.mesh.geometry.x[:] = body.mesh.geometry.x @ turn.T
    axes = SupportAxes(cylindrical=turned((0, 0, 1)))
    other = dataclasses.replace(
        scene,
        support=tuple(dataclasses.replace(one, axes=axes) for one in scene.support),
        load=tuple(Load(one.on, traction=turned(one.traction)) for one in scene.load),
        point=tuple(dataclasses.replace(one, at=turned(one.at)) for one in scene.point),
        cyclic_symmetry=CyclicSymmetry("bar.x0", "bar.y0", 4, turned((0, 0, 3))),
    )
    result = Run(other, COMM, body).solve()
    assert result.passed, result.verdict
    name = "displacement_corner"
    assert result.quantities[name] == pytest.approx(turned(found.quantities[name]), rel=1e-8)
    assert result.quantities["strain_energy"] == pytest.approx(
        found.quantities["strain_energy"], rel=1e-9
    )
    assert result.model.symmetry.startswith("1 of 4 sectors about (")


def test_a_saved_body_of_a_sector(tmp_path):
    """Answers of a body that is read again are those of one made anew."""
    scene = dataclasses.replace(fitted(False, twist=0.0), load=(Load("hub.y1", pressure=0.2),))
    body, file = hub_on_shaft(1), COMM.bcast(tmp_path / "sector.npz")
    study = Study(scene, body=body)
    study.solve()
    study.save(file)
    changes = {"contact.0.interference": 0.025}
    again = Study.load(file, scene=scene, body=body).solve(changes).quantities
    anew = Run(study.changed(changes), COMM, hub_on_shaft(1)).solve().quantities
    for name in (*SUMS, "reaction", "max_contact_pressure"):
        assert again[name] == pytest.approx(anew[name], rel=1e-8)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_hub_that_is_warmer_than_its_shaft(solver):
    """Thermal strains of the hub: the same pressures as of the whole ring."""
    warm = (Temperature(value=-5.0, on="hub"),)
    material = Material(E, NU, thermal_expansion=1e-3)
    whole, part = (
        Run(
            dataclasses.replace(fitted(whole, solver=solver), material=material, temperature=warm),
            COMM,
            hub_on_shaft(SECTORS if whole else 1),
        ).solve()
        for whole in (True, False)
    )
    assert off_at_points(whole, part, "contact_pressure") < 1e-8


def test_a_large_sector_has_no_multigrid(monkeypatch):
    """Whatever its size: multigrid knows of no cut."""
    monkeypatch.setattr(solver_choice, "_ITERATIVE_FROM", {1: 0, 2: 0})
    monkeypatch.setattr(solver_choice, "_LARGE_PAIR", 0)
    mesh = {"dimension": 3, "cells": ((1, 1), (1, 1))}
    run = sector(mesh, dimension=3, solver="auto")
    assert solver_choice.choose_solver(run.problem).name == "condensed"
