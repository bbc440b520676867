"""Couplings in a sector of a ring against whole rings, of which it is a copy, and formulas."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Coupling,
    CyclicSymmetry,
    Discretisation,
    Heat,
    Material,
    Modes,
    Point,
    Run,
    Scene,
    SolverSettings,
    Spring,
    Study,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.problem.rings import ring
from tests.problem.sectors import SECTORS as RING
from tests.problem.sectors import fitted, hub_on_shaft
from tests.problem.test_sector import off_at_points

COMM = MPI.COMM_WORLD
SECTORS, E, NU = 4, 1000.0, 0.3
KINDS, SOLVERS = ["rigid", "distributing"], ["condensed", "full"]


def solved(scene, body):
    found = Run(scene, COMM, body).solve()
    assert found.exit_code == 0, found.verdict
    return found


def turned(vector, number):
    """A vector of the plane, or of space, in the sector of a number."""
    x, y, *rest = vector
    for _ in range(number):
        x, y = -y, x
    return (x, y, *rest)


# --- Lugs on a ring: a point in each sector --------------------------------------------------

INNER, OUTER, TIP = 10.0, 20.0, 26.0


def lugs_on_ring(copies, dimension=2):
    """A lug in each sector, whose outer end is ``lug0.y1`` and so on."""
    low, high, more = ((0.0,), (4.0,), (1,)) if dimension == 3 else ((), (), ())
    turn = 2 * np.pi / SECTORS
    whole = Box("ring", (0.0, INNER, *low), (turn * copies, OUTER, *high), (6 * copies, 2, *more))
    lugs = [
        Box(
            f"lug{k}",
            (turn * (k + 1 / 6), OUTER, *low),
            (turn * (k + 1 / 2), TIP, *high),
            (2, 1, *more),
        )
        for k in range(copies)
    ]
    names = ["ring", *(lug.name for lug in lugs)]
    closed = ("ring",) if copies == SECTORS else ()
    kind = "quadrilateral" if dimension == 2 else "hexahedron"
    body = boxes([whole, *lugs], kind, welded=[names], closed=closed)
    x = body.mesh.geometry.x
    angle, radius = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0], x[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    return body


def on_lugs(copies, dimension=2, solver="condensed", kind="rigid", **more):
    """Each lug is pulled, turned and held by a spring that is stiffer along one axis."""
    flat = dimension == 2
    force = (3.0, 1.0) if flat else (3.0, 1.0, -2.0)
    moments = 5.0 if flat else (1.0, -4.0, 5.0)
    couplings, springs = [], []
    for k in range(copies):
        name = f"point{k}"
        couplings.append(
            Coupling(
                f"lug{k}.y1",
                kind=kind,
                at=turned((25.0, 12.0) if flat else (25.0, 12.0, 1.0), k),
                name=name,
                force=turned(force, k),
                moment=moments if flat else turned(moments, k),
            )
        )
        stiffness = {"x": 7.0, "y": 3.0} if k % 2 == 0 else {"x": 3.0, "y": 7.0}
        springs.append(Spring((name, "ground"), stiffness))
    axis = None if flat else (0, 0, 1)
    cut = CyclicSymmetry("ring.x0", "ring.x1", SECTORS, axis)
    supports = [Support("ring.y0", dict.fromkeys("xyz"[:dimension], 0.0))]
    given = {
        "kinematics": "plane strain" if flat else "3D",
        "material": Material(E, NU),
        "support": tuple(supports),
        "coupling": tuple(couplings),
        "spring": tuple(springs),
        "solver": SolverSettings(solver=solver, errors="none"),
        "cyclic_symmetry": None if copies == SECTORS else cut,
    }
    return Scene(**given | more)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_point_of_each_sector_moves_in_all_ways(dimension, kind, solver):
    scenes = [on_lugs(copies, dimension, solver, kind) for copies in (SECTORS, 1)]
    whole, part = (
        solved(scene, lugs_on_ring(copies, dimension))
        for scene, copies in zip(scenes, (SECTORS, 1), strict=True)
    )
    (own,) = part.couplings
    for k, other in enumerate(whole.couplings):
        moved = turned(own.displacement, k)
        assert moved == pytest.approx(other.displacement, rel=1e-9)
        angles = own.rotation if dimension == 2 else turned(own.rotation, k)
        assert angles == pytest.approx(other.rotation, rel=1e-9)
        assert turned(own.force, k) == pytest.approx(other.force, rel=1e-9)
    assert np.abs(own.displacement).max() > 1e-3
    energy = part.cyclic_symmetry.whole["strain_energy"]
    assert energy == pytest.approx(whole.quantities["strain_energy"], rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_point_of_each_sector_moves_with_heat(kind):
    """Of lugs that heat flows through from a hot bore to cold ends, as those of the whole ring."""
    warm = Material(E, NU, thermal_expansion=1e-4, conductivity=0.05)
    found = []
    for copies in (SECTORS, 1):
        cold = [Heat(f"lug{k}.y1", temperature=10) for k in range(copies)]
        heat = (Heat("ring.y0", temperature=80), *cold)
        bore = Point("bore", (12.0, 6.0))
        scene = on_lugs(copies, kind=kind, material=warm, heat=heat, point=(bore,))
        found.append(solved(scene, lugs_on_ring(copies)))
    whole, part = found
    (own,), other = part.couplings, whole.couplings[0]
    assert own.displacement == pytest.approx(other.displacement, rel=1e-9)
    assert own.rotation == pytest.approx(other.rotation, rel=1e-9)
    assert own.force == pytest.approx(other.force, rel=1e-9)
    name = "temperature_bore"
    assert 20 < part.quantities[name] < 79
    assert part.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-9)
    energy = part.cyclic_symmetry.whole["strain_energy"]
    assert energy == pytest.approx(whole.quantities["strain_energy"], rel=1e-9)
    assert part.checks["heat_balance"].value < 1e-9


# --- A shaft: one point for all sectors ------------------------------------------------------

LENGTH = 30.0


def shaft(copies, cells=3):
    """A tube about z of two cells along it, on copied meshes in waves."""
    body = ring(cells * copies, order=1, turn=copies / SECTORS, length=LENGTH)
    x = body.mesh.geometry.x
    x[:, 2] += (
        2 * np.sin(np.pi * x[:, 2] / LENGTH) * np.sin(SECTORS * np.arctan2(x[:, 1], x[:, 0]) + 0.4)
    )
    return body


def on_shaft(copies, solver="condensed", kind="rigid", **more):
    """Held at one end, pulled and twisted at the other."""
    share = copies / SECTORS
    end = Coupling(
        "ring.z1", kind=kind, at=(0, 0, LENGTH + 2), name="end",
        force=(0, 0, 40 * share), moment=(0, 0, 900 * share),
    )  # fmt: skip
    given = {
        "kinematics": "3D",
        "material": Material(E, NU),
        "support": (Support("ring.z0", dict.fromkeys("xyz", 0.0)),),
        "coupling": (end,),
        "solver": solver if isinstance(solver, SolverSettings) else SolverSettings(solver=solver),
        "cyclic_symmetry": None
        if copies == SECTORS
        else CyclicSymmetry("ring.x0", "ring.x1", SECTORS, (0, 0, 1)),
    }
    return Scene(**given | more)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_point_on_the_axis_is_one_for_all_sectors(kind, solver):
    whole, part = (solved(on_shaft(copies, solver, kind), shaft(copies)) for copies in (SECTORS, 1))
    (own,), (other,) = part.couplings, whole.couplings
    assert own.displacement == pytest.approx(other.displacement, rel=1e-9, abs=1e-12)
    assert own.rotation == pytest.approx(other.rotation, rel=1e-9, abs=1e-12)
    assert SECTORS * own.force[2] == pytest.approx(other.force[2], rel=1e-9)
    assert SECTORS * own.moment[2] == pytest.approx(other.moment[2], rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("beside", ["equal", "graded", "off-centre"])
def test_a_shaft_in_torsion(kind, beside):
    """θ = T L/(G J), with faces of the cut that match or do not, also by middles of edges."""
    inner, outer, torque = 10.0, 30.0, 900.0
    body = ring(4, order=2, turn=1 / SECTORS, length=LENGTH)
    x = body.mesh.geometry.x
    ahead = np.arctan2(x[:, 1], x[:, 0]) * SECTORS / (2 * np.pi)
    radius = np.hypot(x[:, 0], x[:, 1])
    shares = (radius - inner) / (outer - inner), x[:, 2] / LENGTH
    moves = {
        "equal": lambda share: 0 * share,
        "graded": lambda share: 0.3 * (1 - np.abs(2 * share - 1)),
        "off-centre": lambda share: share * (1 - share),
    }
    along, up = (ahead * moves[beside](share) for share in shares)
    x[:, :2] *= (1 + 5 * along / radius)[:, None]
    x[:, 2] += 10 * up
    scene = on_shaft(1, kind=kind, discretisation=Discretisation(2))
    part = solved(scene, body)
    polar = np.pi / 2 * (outer**4 - inner**4)
    modulus = E / (2 * (1 + NU))
    (end,) = part.couplings
    assert end.rotation[2] == pytest.approx(torque * LENGTH / (modulus * polar), rel=3e-4)
    whole = part.cyclic_symmetry
    assert whole.couplings["end"]["torque"] == pytest.approx(torque, rel=1e-9)
    assert whole.couplings["end"]["axial_force"] == pytest.approx(40, rel=1e-9)
    assert whole.whole["torque"] == pytest.approx(-torque, rel=1e-7)
    assert whole.whole["axial_force"] == pytest.approx(-40, rel=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_a_spring_at_the_axis_is_a_share_of_that_of_the_ring(kind):
    """Two springs in parallel, that of the shaft and that of the point: θ = T/(k + k')."""
    alone = solved(on_shaft(1, kind=kind), shaft(1)).couplings[0].rotation[2]
    stiffness = 900.0 / alone
    spring = Spring(("end", "ground"), rotational_stiffness={"z": 2 * stiffness / SECTORS})
    held = solved(on_shaft(1, kind=kind, spring=(spring,)), shaft(1)).couplings[0]
    assert held.rotation[2] == pytest.approx(alone / 3, rel=1e-9)


def test_a_hub_and_lugs_joined_by_springs():
    """A spring of each lug to the point that holds the hub, as of the whole ring."""
    found = []
    for copies in (SECTORS, 1):
        hub = Coupling("ring.y0", kind="distributing", at=(0, 0), name="hub", rotation={"z": 0})
        hub = dataclasses.replace(hub, displacement={"x": 0, "y": 0} if copies > 1 else {})
        scene = on_lugs(copies, support=())
        joined = [Spring((one.name, "hub"), 20.0, 400.0) for one in scene.coupling]
        scene = dataclasses.replace(
            scene, coupling=(hub, *scene.coupling), spring=(*scene.spring, *joined)
        )
        found.append(solved(scene, lugs_on_ring(copies)))
    whole, part = found
    assert part.couplings[1].displacement == pytest.approx(whole.couplings[1].displacement, 1e-9)
    assert part.couplings[1].rotation == pytest.approx(whole.couplings[1].rotation, rel=1e-9)
    torque = whole.couplings[0].moment[0]
    assert part.cyclic_symmetry.couplings["hub"]["torque"] == pytest.approx(torque, rel=1e-9)
    assert abs(torque) > 1


@pytest.mark.parametrize("kind", KINDS)
def test_modes_with_a_mass_at_a_point(kind):
    """Those of a ring in which all sectors move alike are those of its sector."""
    shapes = []
    for copies in (SECTORS, 1):
        end = dataclasses.replace(
            on_shaft(copies, kind=kind).coupling[0], force=None, moment=None,
            mass=5.0 * copies / SECTORS,
        )  # fmt: skip
        scene = on_shaft(copies, coupling=(end,), material=Material(E, NU, density=1e-4))
        scene = dataclasses.replace(scene, modes=Modes(8 if copies > 1 else 2))
        shapes.append([mode.natural_frequency for mode in solved(scene, shaft(copies)).modes])
    whole, part = shapes
    for frequency in part:
        assert min(abs(frequency / other - 1) for other in whole) < 1e-8


def test_derivatives_beside_a_contact_that_crosses_the_cut():
    """A press fit twisted by a rigid rim, against differences of answers."""
    rim = Coupling("hub.y1", at=(0, 0), name="rim", moment=2.0)
    scene = dataclasses.replace(fitted(False), load=(), coupling=(rim,))
    study = Study(scene, body=hub_on_shaft(1))
    of, keys = ["strain_energy", "pressure_integral", "rim.reaction_moment"], ["coupling.0.moment"]
    slopes = study.derivatives(of, keys)
    below, above = (study.solve({keys[0]: 2.0 + sign * 1e-3}) for sign in (-1, 1))
    for name in of[:2]:
        expected = (above.quantities[name] - below.quantities[name]) / 2e-3
        assert slopes[name][keys[0]] == pytest.approx(expected, rel=2e-4, abs=1e-6), name
    assert slopes[of[2]][keys[0]] == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_press_fit_that_a_rigid_rim_twists(solver):
    """Contact and coupling end in the cut: pressures and slip are those of the whole ring."""
    found = []
    for whole, copies in ((True, RING), (False, 1)):
        rim = Coupling("hub.y1", at=(0, 0), name="rim", moment=40.0 * copies / RING)
        scene = dataclasses.replace(fitted(whole, solver=solver), load=(), coupling=(rim,))
        found.append(solved(scene, hub_on_shaft(copies)))
    whole, part = found
    assert off_at_points(whole, part, "contact_pressure") < 1e-8
    assert off_at_points(whole, part, "friction_traction") < 1e-8
    assert part.couplings[0].rotation == pytest.approx(whole.couplings[0].rotation, rel=1e-8)


@pytest.mark.errors
def test_error_bars_of_couplings_in_a_sector():
    scene = on_shaft(1, solver=SolverSettings(errors="all"))
    coarse, fine = (solved(scene, shaft(1, cells)) for cells in (2, 6))
    (own,), (other,) = coarse.couplings, fine.couplings
    apart = abs(own.rotation[2] - other.rotation[2])
    assert apart < 1.2 * own.errors["rotation"]["total"] < 30 * apart


@pytest.mark.parametrize(
    ("coupling", "message"),
    [
        (Coupling("ring.z1"), "coupling_across_the_cut"),
        (Coupling("ring.z1", at=(0.1, 0, 0)), "coupling_across_the_cut_beside_the_axis"),
        (Coupling("ring.z1", at=(0, 0, 1), rotation={"x": 0.1}), "coupling_that_tilts_a_ring"),
        (Coupling("ring.z1", at=(0, 0, 1), force=(0, 2, 0)), "coupling_that_pulls_across_a_ring"),
        (Coupling("ring.x0", at=(0, 0, 0)), "coupling_at_one_face_of_the_cut"),
    ],
)
def test_couplings_that_a_ring_cannot_have(coupling, message):
    with refused(message):
        Run(on_shaft(1, coupling=(coupling,), support=()), COMM, shaft(1))


def test_a_point_on_a_skew_axis():
    body = shaft(1)
    turn = np.array([[1.0, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    body.mesh.geometry.x[:] = body.mesh.geometry.x @ turn.T
    axis = tuple(turn[:, 2])
    end = Coupling("ring.z1", kind="distributing", at=axis)
    cut = CyclicSymmetry("ring.x0", "ring.x1", SECTORS, axis)
    with refused("coupling_on_a_skew_axis"):
        Run(on_shaft(1, coupling=(end,), cyclic_symmetry=cut), COMM, body)
