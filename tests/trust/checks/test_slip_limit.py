"""Torques and pulls near the limit of friction: shares by formulas, and what slips as a whole."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    MeshSource,
    NoEquilibriumError,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.common.parallel import on_root
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.results.quantities import headlines
from fenics_contact.simulation.verdict import slips_as_a_whole
from fenics_contact.trust.run_checks import run_checks
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
SILENT = SolverSettings(errors="none")
# A ring of inner and outer radius, its groups `hole` and `rim`; the hole may lie aside.
RING = """
DefineConstant[ inner = 0.5, outer = 1, aside = 0, cells = 24 ];
Point(1) = {0, 0, 0};
Point(10) = {aside, 0, 0};
For i In {0:3}
  Point(2 + i) = {outer * Cos(i * Pi / 2), outer * Sin(i * Pi / 2), 0};
  Point(6 + i) = {aside + inner * Cos(i * Pi / 2), inner * Sin(i * Pi / 2), 0};
EndFor
For i In {0:3}
  Circle(1 + i) = {2 + i, 1, 2 + (i + 1) % 4};
  Circle(5 + i) = {6 + i, 10, 6 + (i + 1) % 4};
  Line(9 + i) = {6 + i, 2 + i};
EndFor
For i In {0:3}
  Curve Loop(1 + i) = {9 + i, 1 + i, -(9 + (i + 1) % 4), -(5 + i)};
  Plane Surface(1 + i) = {1 + i};
EndFor
Transfinite Curve{1:8} = cells / 4 + 1;
Transfinite Curve{9:12} = 3;
Transfinite Surface{1:4};
Recombine Surface{1:4};
Physical Curve("hole") = {5:8};
Physical Curve("rim") = {1:4};
Physical Surface("body") = {1:4};
"""
E_MODULUS, FIT, FRICTION = 1000.0, 1e-3, 0.15
# Lamé, plane stress: a ring of .5 to 1 gives way by p/E (5/3 − ν) at its rim, one of 1 to 2 that is
# held at its rim by p/E 3 (1 − ν²)/(1 + ν + 4 (1 − ν)) in its hole.
PRESSURE = E_MODULUS * FIT / (5 / 3 - 0.3 + 3 * (1 - 0.3**2) / (1.3 + 4 * 0.7))
LIMIT = FRICTION * PRESSURE * 2 * np.pi  # torque, at radius 1


@pytest.fixture(scope="module")
def geometry(tmp_path_factory):
    path = on_root(COMM, lambda: str(tmp_path_factory.mktemp("rings") / "ring.geo"))
    on_root(COMM, lambda: Path(path).write_text(RING))
    return path


def ring_in_ring(geometry, share, order=2):
    """A ring in a ring that is held outside, turned by its hole with a share of the limit."""
    shear = share * LIMIT / (2 * np.pi * 0.25)
    traction = (lambda x: -shear * x[1] / 0.5, lambda x: shear * x[0] / 0.5)
    return Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(geometry, {"inner": 0.5, "outer": 1}, order=order, name="shaft"),
            MeshSource(geometry, {"inner": 1, "outer": 2}, order=order, name="hub"),
        ),
        material=Material(E_MODULUS, 0.3),
        support=(Support("hub.rim", {"x": 0, "y": 0}),),
        load=(Load("shaft.hole", traction=traction, path={"time": [1, 2], "factor": [0, 1]}),),
        contact=(
            Contact(
                "shaft.rim",
                against="hub.hole",
                interference=FIT,
                law="incremental",
                friction_coefficient=FRICTION,
            ),
        ),
        steps=Steps(times=(1, 2)),
        solver=SILENT,
    )


def shares(result):
    """Of each contact, and of each part."""
    of_contacts = [contact.quantities.get("slip_share") for contact in result.contacts]
    return of_contacts, dict(result.slip_limit.parts) if result.slip_limit else None


@pytest.mark.parametrize(("share", "order"), [(0.5, 2), (0.98, 2), (0.9, 1)])
def test_a_ring_in_a_ring_holds(geometry, share, order):
    """T / (μ p 2π R²), where friction's resultant is 0; facets of order 1 count as round, too."""
    result = run(ring_in_ring(geometry, share, order), COMM)
    assert result.exit_code == 0
    (of_contact,), parts = shares(result)
    # Straight facets touch along their middles as far as their arcs let them.
    assert of_contact == pytest.approx(share, rel=1e-3 if order == 2 else 0.05)
    assert parts == {"shaft": pytest.approx(of_contact, rel=1e-9), "hub": None}
    assert "rotation about z" in result.slip_limit.motion
    assert result.checks["slip_limit"].value == pytest.approx(of_contact, rel=1e-9)
    assert f"friction at {100 * of_contact:.3g} % of its limit" in headlines(result)[0]
    assert headlines(result)[1] == (
        f"Part 'shaft': friction holds it with {100 * of_contact:.3g} % of its limit."
    )


@pytest.mark.parametrize("share", [1.02, 1.1, 1.5])
def test_a_ring_in_a_ring_slips(geometry, share):
    """What loads ask for, and what friction can hold, by the pressures of the step before."""
    result = run(ring_in_ring(geometry, share), COMM)
    assert result.exit_code == 3
    said = re.search(
        r"'shaft' slips as a whole \(rotation about z of 'shaft'\): no support holds it so, "
        r"friction can hold a moment of (\S+) at the most, and the loads ask for (\S+), by",
        result.verdict,
    )
    assert float(said[1]) == pytest.approx(LIMIT, rel=2e-3)
    assert float(said[2]) == pytest.approx(share * LIMIT, rel=1e-3)
    assert "same units" not in result.verdict


def test_a_hub_that_is_turned_is_held_by_the_support(geometry):
    """The same torque on a shaft that is held: nothing can slip as a whole, beyond the limit."""
    scene = ring_in_ring(geometry, 0.5)
    held = Support("shaft.hole", {"x": 0, "y": 0})
    result = run(dataclasses.replace(scene, support=(*scene.support, held), load=()), COMM)
    (of_contact,), parts = shares(result)
    assert of_contact == pytest.approx(0.0, abs=1e-6)
    assert parts is None and "slip_limit" not in result.checks


def test_friction_used_up_fails_the_check(geometry):
    """An answer in which all that friction can carry turns one part."""
    prepared = Run(ring_in_ring(geometry, 0.9), COMM)
    prepared.solve()
    problem, solution = prepared.problem, prepared.solution
    right = run_checks(BulkForces(problem, solution))["slip_limit"]
    assert right.passed
    (state,) = solution.states
    more = dataclasses.replace(state, friction_traction=state.friction_traction / right.value)
    wrong = dataclasses.replace(solution, states=(more,))
    check = run_checks(BulkForces(problem, wrong))["slip_limit"]
    assert not check.passed
    assert check.part == "shaft"
    assert slips_as_a_whole(problem, wrong).startswith(
        " There is no equilibrium: 'shaft' slips as a whole (rotation about z of 'shaft'): "
    )
    assert slips_as_a_whole(problem, solution) == ""


def block(pull, **changes):
    """A block of 1 × 1 on a rough floor, pressed down with 10 and pulled."""
    given = {
        "kinematics": "plane strain",
        "material": Material(1000, 0.0),
        "load": (Load("y1", pressure=10), Load("y1", traction=pull)),
        "contact": (Contact("y0", obstacle=Obstacle("plane"), friction_coefficient=0.5),),
        "solver": SILENT,
    }
    return Scene(**given | changes)


def test_a_pull_uses_what_it_is_of_the_limit():
    """As before: |friction| over μ N, of a block that nothing else holds."""
    result = run(block((3.0, 0.0)), COMM, body=box_body((6, 4), (2, 1)))
    (of_contact,), parts = shares(result)
    assert of_contact == pytest.approx(0.6, rel=1e-6)
    assert list(parts.values()) == [pytest.approx(0.6, rel=1e-6)]
    assert "translation along x" in result.slip_limit.motion
    assert "(60 % of its limit)" in headlines(result)[0]


def test_all_contacts_of_a_part_count():
    """Between the floor and a known pressure with friction of its own: F / Σ μ N."""
    both = (
        Contact("y0", obstacle=Obstacle("plane"), friction_coefficient=0.5),
        Contact("y1", pressure=10, friction_coefficient=0.2),
    )
    scene = block((0, 0), contact=both, load=(Load("x1", traction=(10.0, 0.0)),))
    result = run(scene, COMM, body=box_body((6, 4), (2, 1)))
    of_contacts, parts = shares(result)
    assert list(parts.values()) == [pytest.approx(10 / (2 * 10 * 0.7), rel=1e-6)]
    carried = [abs(contact.quantities["friction_force"][0]) for contact in result.contacts]
    assert sum(carried) == pytest.approx(10, rel=1e-6)
    assert of_contacts == pytest.approx([carried[0] / 10, carried[1] / 4], rel=1e-6)


def test_a_plane_of_symmetry_lets_no_half_slip_away_from_it():
    """Half of a block that is squeezed: friction has a resultant, and its mirror image the rest."""
    scene = block((0, 0), symmetry=("x0",), material=Material(1000, 0.3))
    result = run(scene, COMM, body=box_body((6, 4), (2, 1)))
    assert abs(result.quantities["friction_force"][0]) > 1
    assert shares(result) == ([None], None)
    assert "(- of its limit)" in headlines(result)[0]


def test_a_ring_pushed_along_its_axis():
    """Axisymmetric, of 1 to 2, in a sleeve that presses with 10: F / (μ p 4π), and no torsion."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        load=(Load("y1", traction=(0.0, 1.0)),),
        contact=(Contact("x1", pressure=10, friction_coefficient=0.2),),
        solver=SILENT,
    )
    body = box_body((4, 6), (1, 1))
    body.mesh.geometry.x[:, 0] += 1
    (of_contact,), parts = shares(run(scene, COMM, body=body))
    expected = 3 * np.pi / (0.2 * 10 * 4 * np.pi)
    assert of_contact == pytest.approx(expected, rel=1e-6)
    assert list(parts.values()) == [pytest.approx(expected, rel=1e-6)]


@pytest.mark.parametrize(("sides", "mean"), [((1, 1), 0.382598), ((4, 2), 1.186467)])
def test_a_block_turned_about_the_normal_of_the_floor(sides, mean):
    """It turns at μ p A times the mean distance from its middle, .382598 of a square of side 1."""
    long, wide = sides
    turn = 0.6 * 0.5 * 10 * mean * 12 / (long**2 + wide**2)  # of the limit; ∫ r² = A (a² + b²)/12
    traction = (
        lambda x: -turn * (x[1] - wide / 2),
        lambda x: turn * (x[0] - long / 2),
        0.0,
    )
    scene = block(
        traction,
        kinematics="3D",
        load=(Load("z1", pressure=10), Load("z1", traction=traction)),
        contact=(Contact("z0", obstacle=Obstacle("plane"), friction_coefficient=0.5),),
    )
    result = run(scene, COMM, body=box_body((3 * long, 3 * wide, 2), (long, wide, 0.6)))
    (of_contact,), parts = shares(result)
    assert of_contact == pytest.approx(0.6, rel=1e-2)
    assert list(parts.values()) == [pytest.approx(of_contact, rel=1e-9)]
    assert result.exit_code == 0


def braked(geometry, share, pads=True):
    """A ring that turns in a frictionless fit, held by pads in its hole that press with 1."""
    scene = ring_in_ring(geometry, 0.0)
    # Of the pads: .2 × 1 × 2π r² at r = .5; ∫ r² over the ring is π/2 (1 − r⁴).
    turn = share * 0.2 * 2 * np.pi * 0.25 / (np.pi / 2 * (1 - 0.5**4))
    fit = dataclasses.replace(scene.contact[0], friction_coefficient=0.0)
    pad = Contact("shaft.hole", pressure=1.0, friction_coefficient=0.2)
    force = (lambda x: -turn * x[1], lambda x: turn * x[0])
    return dataclasses.replace(
        scene,
        load=(Load("shaft.body", body_force=force),),
        contact=(fit, pad) if pads else (fit,),
        steps=Steps(),
    )


@pytest.mark.parametrize("order", [1, 2])
def test_facets_of_a_bearing_do_not_hold_its_shaft(geometry, order):
    """Where pressures are known, what they cannot hold is refused before anything is solved."""

    def meshed(scene):
        mesh = tuple(dataclasses.replace(source, order=order) for source in scene.mesh)
        return dataclasses.replace(scene, mesh=mesh)

    held = Run(meshed(braked(geometry, 0.98)), COMM)
    assert held.free_motion.used_share == pytest.approx(0.98, rel=3e-2 if order == 1 else 1e-3)
    turns = "rotation about z of 'shaft'"
    with refused("loads_exceed_friction", NoEquilibriumError, motion=turns, share="…"):
        Run(meshed(braked(geometry, 1.05)), COMM)
    with refused("motion_is_pushed", NoEquilibriumError, motion=turns):
        Run(meshed(braked(geometry, 0.5, False)), COMM)


def test_a_shaft_turns_about_its_axis_wherever_its_centre_of_mass_lies(geometry):
    """With its hole aside by a: pads in there slip by .5 + a cos θ, in the mean as before.

    The load is without that on a disc of radius .5 at a, ∫ r² = π/4 (1/8 + a²).
    """
    aside = 0.1
    lighter = 1 - np.pi * 0.25 * aside**2 / (np.pi / 2 * (1 - 0.5**4))

    def with_hole_aside(scene):
        shaft, hub = scene.mesh
        given = {**shaft.parameters, "aside": aside}
        return dataclasses.replace(scene, mesh=(dataclasses.replace(shaft, parameters=given), hub))

    held = Run(with_hole_aside(braked(geometry, 0.98)), COMM).free_motion
    assert held.used_share == pytest.approx(0.98 * lighter, rel=1e-3)
    resisted = {row["motion"]: row["resisted_by"] for row in held.motions}
    turns = "translation along y of 'shaft', rotation about z of 'shaft'"
    assert resisted[turns] == ["friction at 'shaft.hole'"]
    with refused("loads_exceed_friction", NoEquilibriumError, motion=turns, share="…"):
        Run(with_hole_aside(braked(geometry, 1.05)), COMM)


def test_uneven_facets_do_not_hold_a_smooth_shaft(geometry):
    """Normals averaged over facets of unlike length are off; the shaft may turn all the same."""
    uneven = geometry.replace("ring.geo", "uneven.geo")
    steps = "Transfinite Curve{1:8} = cells / 4 + 1"
    text = RING.replace(steps, f"{steps} Using Progression 1.15")
    on_root(COMM, lambda: Path(uneven).write_text(text))
    scene = braked(uneven, 0.0, pads=False)
    mesh = tuple(dataclasses.replace(source, order=1) for source in scene.mesh)
    turns = "rotation about z of 'shaft'"
    with refused("motion_is_undetermined", NoEquilibriumError, motion=turns):
        Run(dataclasses.replace(scene, mesh=mesh, load=()), COMM)
