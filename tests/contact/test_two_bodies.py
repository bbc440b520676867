"""Contact between deformable bodies: statics, exact fields, rigid limits, one solver by another."""

import dataclasses
from itertools import product
from pathlib import Path as File

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    Load,
    Material,
    MeshSource,
    NotConvergedError,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.body.materials import Moduli
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.common.parallel import largest, on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.verification.boxes import Box, boxes
from tests.contact.shuffled import Shuffled
from tests.messages import refused

COMM = MPI.COMM_WORLD
LOWER = Box("lower", (0, -1), (1, 0), (6, 5))
UPPER = Box("upper", (0, 0), (1, 1), (4, 3))
TOP = Box("top", (0, 1), (1, 2), (5, 4))
CLAMP = Support("lower.y0", {"x": 0, "y": 0})


def touching(on="upper.y0", against="lower.y1", **contact):
    return Contact(on, against=against, **contact)


ROUGH = touching(friction_coefficient=0.5)


def pressed(traction=(0.1, -1.0), contact=None, **changes):
    """A block on another one, clamped at its bottom, loaded at the top."""
    contacts = contact if isinstance(contact, tuple) else (contact or ROUGH,)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(CLAMP,),
        load=(Load("upper.y1", traction=traction),),
        contact=contacts,
    )
    return dataclasses.replace(scene, **changes)


def box_pair(shape, shared=(0.0, 0.0)):
    """Two boxes, one on the other, of any cell; the upper may be moved sideways and up."""
    if shape in ("hexahedron", "tetrahedron"):
        parts = (
            Box("lower", (0, 0, -1), (1, 1, 0), (3, 2, 2)),
            Box("upper", (0, 0, 0), (1, 1, 1), (2, 3, 2)),
        )
    else:
        (aside, above) = shared
        parts = (LOWER, Box("upper", (aside, above), (1 + aside, 1 + above), (4, 3)))
    return boxes(parts, shape)


CROSSED = [
    *product(["quadrilateral", "triangle", "hexahedron", "tetrahedron"], ["condensed"]),
    *product(["hexahedron", "tetrahedron"], ["iterative"]),
]


@pytest.mark.parametrize("slave", ["on", "against"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("cell, solver", CROSSED)
def test_uniform_pressure_crosses_meshes_that_do_not_match(cell, solver, degree, slave):
    """The patch test: with ν = 0 a column under p is compressed by p/E, whatever the meshes."""
    space = cell in ("hexahedron", "tetrahedron")
    up, sides = ("z", ("x", "y")) if space else ("y", ("x",))
    scene = Scene(
        kinematics="3D" if space else "plane strain",
        material=(Material(1000, 0.0, on="upper"), Material(300, 0.0, on="lower")),
        discretisation=Discretisation(degree),
        support=(
            Support(f"lower.{up}0", {up: 0}),
            *(Support(body, {axis: 0}) for body in ("upper", "lower") for axis in sides),
        ),
        load=(Load(f"upper.{up}1", pressure=5.0),),
        contact=(touching(f"upper.{up}0", f"lower.{up}1", slave=slave, penalty_parameter=1e-9),),
        solver=SolverSettings(solver=solver),
    )
    prepared = Run(scene, COMM, box_pair(cell))
    assert prepared.solve().passed
    solution, spaces = prepared.solution, prepared.problem.spaces
    state = solution.states[0]
    assert largest(COMM, np.abs(state.contact_pressure - 5)) <= 5e-7
    height = spaces.coordinates[:, 2 if space else 1]
    is_upper = spaces.parts.of_node == list(spaces.parts.names).index("upper")
    lowered = 5 / 300 * (1 + np.minimum(height, 0)) + is_upper * (5e-9 + 5 / 1000 * height)
    found = -solution.displacement[:, 2 if space else 1]
    # Stress error 1e-9: strains are differences of displacements over a cell. The iterative solver
    # ends at the round-off of forces w/ε₁ for displacements w up to p/E.
    round_off = 20 * np.finfo(float).eps * (5 / 300) / 1e-9
    share = round_off / 5 if solver == "iterative" else 1e-9
    assert largest(COMM, np.abs(found - lowered)) <= share * 5 / 300


@pytest.mark.parametrize("law", ["static", "incremental"])
@pytest.mark.parametrize("cell, degree", [("quadrilateral", 2), ("tetrahedron", 1)])
def test_solvers_agree(cell, degree, law):
    """Jumps as unknowns, all displacements at once, and multigrid: one answer."""
    space = cell == "tetrahedron"
    up = "z" if space else "y"
    coefficient = 0.3 if space else 0.08
    motion = {"x": 0.02, up: -0.05} | ({"y": 0.005} if space else {})
    scene = Scene(
        kinematics="3D" if space else "plane strain",
        material=(Material(1000, 0.3, on="upper"), Material(300, 0.2, on="lower")),
        discretisation=Discretisation(degree),
        support=(
            Support(f"lower.{up}0", dict.fromkeys(motion, 0)),
            Support(f"upper.{up}1", motion),
        ),
        steps=Steps(number=2 if law == "incremental" else 1),
        contact=(
            touching(f"upper.{up}0", f"lower.{up}1", friction_coefficient=coefficient, law=law),
        ),
    )
    found = {}
    for solver in ("condensed", "full", "iterative") if space else ("condensed", "full"):
        chosen = dataclasses.replace(scene, solver=SolverSettings(solver=solver, tolerance=1e-12))
        prepared = Run(chosen, COMM, box_pair(cell))
        assert prepared.solve().passed
        found[solver] = prepared.solution
    reference = found.pop("full")
    assert {"STICK", "SLIP"} <= set().union(*COMM.allgather(set(reference.states[0].status)))
    for solver, solution in found.items():
        moved = largest(COMM, np.abs(solution.displacement - reference.displacement).ravel())
        # Krylov vectors end at the round-off of the penalty, a direct solver goes below.
        assert moved <= (1e-8 if solver == "iterative" else 1e-10) * 0.05
        pressures = solution.states[0].contact_pressure, reference.states[0].contact_pressure
        assert largest(COMM, np.abs(pressures[0] - pressures[1])) <= 1e-7 * largest(
            COMM, pressures[1]
        )


def test_against_a_body_that_cannot_move_it_is_as_against_a_rigid_obstacle():
    """Held everywhere, the lower body is a plane: an independent way to the same numbers."""
    lifted = box_pair("quadrilateral", (0.0, 0.01))
    base = pressed(
        contact=touching(friction_coefficient=0.3, penalty_parameter=1e-7, slave="on"),
        support=(Support("upper.y1", {"x": 0.01, "y": -0.03}), Support("lower", {"x": 0, "y": 0})),
        load=(),
    )
    plane = Contact(
        "upper.y0",
        obstacle=Obstacle("plane", position=(0, 0), normal=(0, 1)),
        friction_coefficient=0.3,
        penalty_parameter=1e-7,
        regularisation_parameter=1e-9,
    )
    own = dataclasses.replace(base.contact[0], regularisation_parameter=1e-9)
    first = run(dataclasses.replace(base, contact=(own,)), COMM, lifted)
    second = run(dataclasses.replace(base, contact=(plane,)), COMM, lifted)
    assert first.passed and second.passed
    assert first.quantities["slip_area"] > 0.05
    for key in ("max_contact_pressure", "contact_area", "max_slip", "strain_energy"):
        assert first.quantities[key] == pytest.approx(second.quantities[key], rel=1e-8), key
    assert first.points.contact_pressure == pytest.approx(second.points.contact_pressure, rel=1e-7)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_stack_that_only_contact_holds(solver):
    """Three blocks: each joint carries the loads above it; nothing else holds two of them."""
    scene = pressed(
        load=(Load("top.y1", traction=(0.1, -1.0)),),
        contact=(
            touching(friction_coefficient=0.5),
            touching("top.y0", "upper.y1", friction_coefficient=0.5),
        ),
        solver=SolverSettings(solver=solver),
    )
    prepared = Run(scene, COMM, boxes((LOWER, UPPER, TOP)))
    assert prepared.model["bodies"] == ["lower", "upper", "top"]
    assert prepared.model["free_rigid_motions"] == 6
    result = prepared.solve()
    assert result.passed
    for contact in result.contacts:
        assert contact["quantities"]["normal_force"] == pytest.approx(1.0, rel=1e-8)
        assert contact["quantities"]["friction_force"] == pytest.approx([-0.1, 0.0], abs=1e-8)
    assert result.quantities["reaction"] == pytest.approx([-0.1, 1.0], abs=1e-8)


def test_a_surface_that_is_slave_here_and_beside_a_master_there():
    """The middle block's sides meet at corners, where one node is slave and another's master."""
    wedge = Box("wedge", (1, -0.5), (2, 0.5), (3, 4))
    scene = pressed(
        load=(Load("upper.y1", traction=(0, -1.0)),),
        support=(CLAMP, Support("wedge.x1", {"x": -0.002, "y": 0})),
        contact=(
            touching(friction_coefficient=0.5, slave="against"),
            touching("lower.x1", "wedge.x0", friction_coefficient=0.2, slave="against"),
        ),
    )
    answers = [
        run(dataclasses.replace(scene, solver=SolverSettings(solver=solver)), COMM, body)
        for solver in ("condensed", "full")
        for body in [boxes((LOWER, UPPER, wedge))]
    ]
    assert all(answer.passed for answer in answers)
    for key in ("max_contact_pressure", "strain_energy"):
        values = [answer.quantities[key] for answer in answers]
        assert values[0] == pytest.approx(values[1], rel=1e-7), key
    for one, other in zip(answers[0].contacts, answers[1].contacts, strict=True):
        forces = [contact["quantities"]["contact_force"] for contact in (one, other)]
        assert forces[0] == pytest.approx(forces[1], rel=1e-6, abs=1e-8)


def test_bodies_come_together_from_a_distance():
    scene = pressed(
        (0, -1.0),
        touching(friction_coefficient=0.3),
        support=(CLAMP, Support("upper.x0", {"x": 0})),
    )
    result = run(scene, COMM, box_pair("quadrilateral", (0.0, 0.05)))
    assert result.passed
    assert result.quantities["normal_force"] == pytest.approx(1.0, rel=1e-8)


def test_surfaces_that_partly_face_each_other():
    """A block over the edge of another one: contact ends where either of them does."""
    scene = pressed(
        contact=touching(penalty_parameter=1e-7),
        support=(CLAMP, Support("upper.y1", {"x": 0, "y": -0.01})),
        load=(),
    )
    for slave in ("on", "against"):
        contact = dataclasses.replace(scene.contact[0], slave=slave)
        body = boxes((LOWER, Box("upper", (0.53, 0), (1.53, 1), (7, 5))))
        result = run(dataclasses.replace(scene, contact=(contact,)), COMM, body)
        assert result.passed
        assert result.quantities["contact_area"] == pytest.approx(0.47, abs=0.02)
        force = result.quantities["normal_force"]
        assert result.supports[0]["reaction"][1] == pytest.approx(force, rel=1e-7)
        assert result.supports[1]["reaction"][1] == pytest.approx(-force, rel=1e-7)


def test_pairing_follows_bodies_that_slide():
    """A block shoved half its width along, then left: as if it had been meshed there."""
    long = Box("lower", (0, -1), (2, 0), (12, 5))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            CLAMP,
            Support("upper.y1", {"y": -0.01}),
            Support("upper.y1", {"x": 0.5}, path=Path(time=(0, 0.5, 1), factor=(0, 1, 1))),
        ),
        steps=Steps(number=8),
        contact=(touching(penalty_parameter=1e-7),),
    )
    there = dataclasses.replace(
        scene, support=(CLAMP, Support("upper.y1", {"x": 0, "y": -0.01})), steps=Steps()
    )
    slid = run(scene, COMM, boxes((long, Box("upper", (0.1, 0), (1.1, 1), (4, 3)))))
    meshed = run(there, COMM, boxes((long, Box("upper", (0.6, 0), (1.6, 1), (4, 3)))))
    assert slid.passed and meshed.passed
    assert "slid far" in slid.verdict and "slid far" not in meshed.verdict
    for key in ("normal_force", "max_contact_pressure"):
        assert slid.quantities[key] == pytest.approx(meshed.quantities[key], rel=2e-3), key
    # In one step, with what faced what at first, the pressure is that of the wrong place.
    once = run(
        dataclasses.replace(scene, steps=Steps()),
        COMM,
        boxes((long, Box("upper", (0.1, 0), (1.1, 1), (4, 3)))),
    )
    error = once.quantities["normal_force"] / meshed.quantities["normal_force"] - 1
    assert abs(error) > 1e-2


RING = """
DefineConstant[ inner = 1, outer = 2, cells = 8 ];
Point(1) = {0, 0, 0};
If (inner > 0)
  Point(2) = {inner, 0, 0}; Point(3) = {0, inner, 0};
  Circle(1) = {3, 1, 2};
EndIf
Point(4) = {outer, 0, 0}; Point(5) = {0, outer, 0};
Circle(2) = {4, 1, 5};
If (inner > 0)
  Line(3) = {2, 4}; Line(4) = {5, 3};
  Curve Loop(1) = {1, 3, 2, 4};
Else
  Line(3) = {1, 4}; Line(4) = {5, 1};
  Curve Loop(1) = {3, 2, 4};
EndIf
Plane Surface(1) = {1};
Transfinite Curve{2} = cells + 1;
If (inner > 0)
  Transfinite Curve{1} = cells + 1;
  Physical Curve("hole") = {1};
EndIf
Mesh.MeshSizeMax = outer / cells;
Physical Curve("rim") = {2};
Physical Curve("below") = {3};
Physical Curve("left") = {4};
Physical Surface("body") = {1};
"""


@pytest.mark.parametrize("slave", ["on", "against"])
def test_press_fit_of_a_pin_in_a_hole(slave, tmp_path):
    """A pin too thick by δ: p = E δ (c² − b²) / (2 b c²) in plane stress (Lamé)."""
    folder = on_root(COMM, lambda: str(tmp_path))  # one folder for all ranks
    geometry = f"{folder}/ring.geo"
    on_root(COMM, lambda: File(geometry).write_text(RING))
    hole, rim, too_thick = 1.0, 2.0, 1e-3
    scene = Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(
                geometry, {"inner": 0, "outer": hole + too_thick, "cells": 16}, order=2, name="pin"
            ),
            MeshSource(geometry, {"inner": hole, "outer": rim, "cells": 21}, order=2, name="ring"),
        ),
        material=Material(1000, 0.3),
        symmetry=("pin.below", "pin.left", "ring.below", "ring.left"),
        contact=(touching("pin.rim", "ring.hole", slave=slave),),
    )
    result = run(scene, COMM)
    assert result.passed
    expected = 1000 * too_thick * (rim**2 - hole**2) / (2 * hole * rim**2)
    assert result.points.contact_pressure.mean() == pytest.approx(expected, rel=2e-3)
    # Pointwise as far as circles of order 2 have the gap: p varies by E over h of its error.
    assert result.points.contact_pressure == pytest.approx(expected, rel=1e-2)
    for side in (0, 2):  # ∫ p n over a quarter of the circle, on the pin and on the ring
        reactions = result.supports[side]["reaction"], result.supports[side + 1]["reaction"]
        across = sum(np.array(reaction) for reaction in reactions)
        assert np.abs(across) == pytest.approx(expected * hole, rel=3e-3)


DISC = """
DefineConstant[ inner = 0, outer = 1, cells = 24 ];
Point(1) = {0, 0, 0};
Point(2) = {outer, 0, 0}; Point(3) = {0, outer, 0}; Point(4) = {-outer, 0, 0};
Point(5) = {0, -outer, 0};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Physical Curve("rim") = {1, 2, 3, 4};
If (inner > 0)
  Point(6) = {inner, 0, 0}; Point(7) = {0, inner, 0}; Point(8) = {-inner, 0, 0};
  Point(9) = {0, -inner, 0};
  Circle(5) = {6, 1, 7}; Circle(6) = {7, 1, 8}; Circle(7) = {8, 1, 9}; Circle(8) = {9, 1, 6};
  Curve Loop(2) = {5, 6, 7, 8};
  Physical Curve("hole") = {5, 6, 7, 8};
  Plane Surface(1) = {1, 2};
Else
  Plane Surface(1) = {1};
EndIf
Physical Surface("body") = {1};
Mesh.MeshSizeMax = 2 * Pi * outer / cells;
"""


@pytest.mark.parametrize("law, steps", [("static", 1), ("incremental", 3)])
def test_a_loose_pin_hangs_on_its_pressure(law, steps, tmp_path):
    """In a hole that is wider, friction holds nothing before the pin lies on the wall."""
    folder = on_root(COMM, lambda: str(tmp_path))
    geometry = f"{folder}/disc.geo"
    on_root(COMM, lambda: File(geometry).write_text(DISC))
    scene = Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(geometry, {"outer": 0.98}, order=2, name="pin"),
            MeshSource(geometry, {"inner": 1, "outer": 2, "cells": 40}, order=2, name="ring"),
        ),
        material=Material(1000, 0.3),
        support=(Support("ring.rim", {"x": 0, "y": 0}),),
        load=(Load("pin", body_force=(0.0, -1.0)),),
        contact=(touching("pin.rim", "ring.hole", friction_coefficient=0.3, law=law),),
        steps=Steps(number=steps),
    )
    prepared = Run(scene, COMM)
    result = prepared.solve()
    assert result.passed
    for step in result.steps:
        weight = np.pi * 0.98**2 * step["load_factor"]
        found = step["quantities"]
        assert found["normal_force"] is None  # the surfaces go all around
        carried, rubbed = found["contact_force"][1], found["friction_force"][1]
        assert carried - rubbed > 0.9 * weight
        assert carried == pytest.approx(weight, rel=1e-3)
    lowered = -prepared.solution.displacement[:, 1]
    assert largest(COMM, lowered) > 0.02  # the clearance


def test_a_slit_in_one_body():
    """Faces of a cut that ends inside share the node at its tip: slave and master at once."""
    points = np.array([[x, y] for y in (-1, 0, 1) for x in range(4)] + [[0, 0], [1, 0]], float)
    below = [[0, 1, 4, 5], [1, 2, 5, 6], [2, 3, 6, 7]]
    cells = np.array([*below, [12, 13, 8, 9], [13, 6, 9, 10], [6, 7, 10, 11]])
    made = compat.create_mesh(own := MPI.COMM_SELF, "quadrilateral", 1, points, cells)
    faces = [[4, 5], [5, 6], [12, 13], [13, 6]]
    lines = np.array([*faces, [0, 1], [1, 2], [2, 3], [8, 9], [9, 10], [10, 11]])
    values = np.array([1, 1, 2, 2, 3, 3, 3, 4, 4, 4], dtype=np.int32)
    names = ("under", "over", "bottom", "top")
    body = Body(
        made,
        compat.distributed_tags(made, 2, cells, np.ones(6, dtype=np.int32)),
        compat.distributed_tags(made, 1, lines, values),
        {name: Group(1, (tag + 1,)) for tag, name in enumerate(names)} | {"body": Group(2, (1,))},
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        load=(Load("top", pressure=lambda x: 4.0 - x[0]),),
        contact=(touching("over", "under", friction_coefficient=0.2),),
    )
    found = [
        run(dataclasses.replace(scene, solver=SolverSettings(solver=solver)), own, body)
        for solver in ("condensed", "full")
    ]
    assert all(result.passed for result in found)
    for key in ("normal_force", "max_contact_pressure", "strain_energy"):
        assert found[0].quantities[key] == pytest.approx(found[1].quantities[key], rel=1e-8)


def test_forces_handed_over_at_the_wrong_place_are_noticed():
    """A projection whose columns are shuffled: resultants balance, moments do not."""
    prepared = Run(pressed(solver=SolverSettings(solver="full")), COMM, box_pair("quadrilateral"))
    pairing = prepared.problem.contacts[0].kinematics.pairing
    Shuffled(pairing).take_over()
    result = prepared.solve()
    assert not result.checks["action_and_reaction"].passed
    assert run(pressed(), COMM, box_pair("quadrilateral")).passed


def test_straight_facets_in_a_tight_hole_are_warned_of(tmp_path):
    folder = on_root(COMM, lambda: str(tmp_path))
    geometry = f"{folder}/ring.geo"
    on_root(COMM, lambda: File(geometry).write_text(RING))
    for order, trusted in ((1, False), (2, True)):
        scene = Scene(
            kinematics="plane stress",
            mesh=(
                MeshSource(geometry, {"inner": 0, "outer": 1.001}, order=order, name="pin"),
                MeshSource(geometry, {"cells": 11}, order=order, name="ring"),
            ),
            material=Material(1000, 0.3),
            symmetry=("pin.below", "pin.left", "ring.below", "ring.left"),
            contact=(touching("pin.rim", "ring.hole"),),
        )
        prepared = Run(scene, COMM)
        assert ("too straight" in prepared.solve().verdict) != trusted
        # Also where loads that come later find no answer, as these surfaces hold too little.
        later = prepared._result.unconverged(NotConvergedError("Nothing holds it."), 2.0, 1).verdict
        assert later.startswith("No answer at time 2") and ("too straight" in later) != trusted


def test_contact_ends_where_the_master_ends_after_sliding():
    """A block pushed over the edge of another one: .47 of its width stays on it."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            CLAMP,
            Support("upper.y1", {"y": -0.01}),
            Support("upper.y1", {"x": 0.53}, path=Path(time=(0, 0.9, 1), factor=(0, 1, 1))),
        ),
        steps=Steps(number=20),
        contact=(touching(),),
    )
    result = run(scene, COMM, boxes((LOWER, Box("upper", (0, 0), (1, 1), (7, 5)))))
    assert result.converged
    assert result.quantities["contact_area"] == pytest.approx(0.47, abs=0.03)


def test_the_end_of_a_body_opposite_is_found_once_until_it_is_paired_anew(monkeypatch):
    """It lies at x = 1, from points at .75 towards 1.07 of a slave that goes on to 1.53."""
    held = (CLAMP, Support("upper.y1", {"x": 0, "y": -0.01}))
    scene = pressed(contact=touching(slave="on"), support=held, load=())
    prepared = Run(scene, COMM, boxes((LOWER, Box("upper", (0.43, 0), (1.53, 1), (7, 5)))))
    contact = prepared.problem.contacts[0]
    kinematics, pieces = contact.kinematics, contact.trace.pieces.points
    reached = kinematics.reached
    cut = pieces[reached[pieces[:, 0]] != reached[pieces[:, 1]]]
    ends = np.where(reached[cut[:, 0]], cut.T, cut.T[::-1])
    x = contact.trace.coordinates[:, 0]

    def place(moved):
        first, last = x[ends] + moved
        return first + kinematics.end_of_obstacle(*ends) * (last - first)

    asked = []
    whole = kinematics.pairing.distances_from
    monkeypatch.setattr(
        kinematics.pairing,
        "distances_from",
        lambda *points: asked.append(len(points[0])) or whole(*points),
    )
    assert place(0.0) == pytest.approx(1.0, abs=1e-6)
    count = len(asked)
    assert place(0.0) == pytest.approx(1.0, abs=1e-6)
    assert len(asked) == count and (count > 0) == (len(cut) > 0)
    moved = np.zeros((len(prepared.problem.spaces.coordinates), 2))
    moved[contact.trace.all_nodes, 0] = 0.02
    kinematics.update_pairing(moved)
    assert place(0.02) == pytest.approx(1.0, abs=1e-6)


def test_rigid_motions_jump_where_something_is_faced_now():
    """The body opposite ends at x = 1, which points move beyond."""
    scene = pressed(contact=touching(slave="on", friction_coefficient=0.5))
    body = boxes((LOWER, Box("upper", (0.43, 0), (1.53, 1), (11, 5))))
    problem = Problem.on_mesh(scene, body)
    contact = problem.contacts[0]
    x = contact.trace.coordinates[:, 0]
    for moved in (0.0, 0.3):
        shift = np.zeros((len(problem.spaces.coordinates), 2))
        shift[contact.trace.all_nodes, 0] = moved
        contact.kinematics.update_pairing(shift)
        jumps = np.abs(RigidMotions(problem).jumps(contact)).max(axis=(1, 2))
        assert (jumps[x + moved < 0.89] > 0.1).all()
        assert (jumps[x + moved > 1.11] < 1e-12).all()


def test_slave_is_the_covered_surface_and_not_the_much_finer_one():
    def sides(parts, **contact):
        scene = pressed(contact=touching(friction_coefficient=0.5, **contact))
        found = Run(scene, COMM, boxes(parts)).contacts()[0]
        return found["slave"], found["slave_reason"]

    wide = Box("lower", (-1, -1), (2, 0), (9, 3))
    assert sides((wide, UPPER)) == ("upper.y0", "the other covers it")
    assert sides((wide, UPPER), slave="against") == ("lower.y1", "as the scene says")
    fine = Box("upper", (0, 0), (1, 1), (20, 4))
    assert sides((LOWER, fine)) == ("lower.y1", "it is not the much finer one")
    assert sides((LOWER, UPPER)) == ("upper.y0", "it comes first")


def test_several_blocks_on_one_foundation():
    """A surface in several contacts is the master of each, where the others are in one alone."""
    left, right = (Box(n, (x, 0), (x + 0.4, 0.4), (3, 3)) for n, x in (("a", 0), ("b", 0.6)))
    scene = pressed(
        load=(Load("a.y1", pressure=2.0), Load("b.y1", pressure=3.0)),
        contact=(
            Contact("lower.y1", against="a.y0", friction_coefficient=0.3, name="a"),
            touching("b.y0", friction_coefficient=0.3),
        ),
    )
    result = run(scene, COMM, boxes((LOWER, left, right)))
    assert result.passed
    assert [contact["slave"] for contact in result.contacts] == ["a.y0", "b.y0"]
    forces = [contact["quantities"]["normal_force"] for contact in result.contacts]
    assert forces == pytest.approx([0.8, 1.2], rel=1e-8)


def test_what_cannot_be_held_or_does_not_touch_is_refused():
    pair = box_pair("quadrilateral")
    with refused("motion_is_pushed", NoEquilibriumError, motion="translation along x of 'upper'"):
        run(pressed(contact=touching()), COMM, pair)
    apart = touching("upper.x1", "lower.x0", friction_coefficient=1)
    with refused("surfaces_do_not_face"):
        run(pressed(contact=apart), COMM, pair)


@pytest.mark.parametrize(
    "contacts, words",
    [
        ((touching(against="lower.y0"),), "surface_opposite_has_a_support"),
        ((Contact("upper.y0", obstacle=Obstacle("plane")), Contact("upper.y0")), "surface_twice"),
    ],
)
def test_surfaces_in_several_contacts(contacts, words):
    named = tuple(dataclasses.replace(c, name=f"c{i}") for i, c in enumerate(contacts))
    with refused(words):
        run(pressed(contact=named), COMM, box_pair("quadrilateral"))


@pytest.mark.parametrize("slaves", list(product(["auto", "on", "against"], repeat=2)))
def test_uniform_pressure_through_a_part_whose_faces_are_one_group(slaves):
    """Of each joint action is reaction, whichever the slaves are, and the pressure is the load."""
    body = boxes((LOWER, UPPER, TOP))
    tags = body.groups["upper.y0"].tags + body.groups["upper.y1"].tags
    body = dataclasses.replace(body, groups=body.groups | {"faces": Group(1, tags)})
    scene = pressed(
        load=(Load("top.y1", traction=(0, -1.0)),),
        material=Material(1000, 0.0),
        contact=tuple(
            touching(on, against, name=on, slave=slave, friction_coefficient=0.5)
            for (on, against), slave in zip(
                (("faces", "lower.y1"), ("top.y0", "faces")), slaves, strict=True
            )
        ),
    )
    result = run(scene, COMM, body)
    assert result.passed
    assert result.checks["action_and_reaction"].value < 1e-8
    for contact in result.contacts:
        assert contact["quantities"]["normal_force"] == pytest.approx(1.0, rel=1e-8)
        assert contact["quantities"]["max_contact_pressure"] == pytest.approx(1.0, rel=1e-7)


def chosen(body, *contacts):
    """Slaves that the program chooses, and why."""
    named = tuple(dataclasses.replace(c, name=f"c{i}") for i, c in enumerate(contacts))
    held = tuple(Support(f"{name}.y1", {"x": 0, "y": -0.01}) for name in "abc")
    scene = pressed(contact=named, load=(), support=(CLAMP, *held))
    found = Run(scene, COMM, body).contacts()
    return [contact["slave"] for contact in found], [contact["slave_reason"] for contact in found]


def test_slaves_are_chosen_so_that_none_has_two_contacts():
    """Of a chain of surfaces the ends are slaves, as each is in one contact alone."""
    parts = (
        Box("lower", (0, -1), (3, 0), (9, 3)),
        *(Box(name, (x, 0), (x + 0.8, 1), (3, 3)) for name, x in (("a", 0), ("b", 1), ("c", 2))),
    )
    body = boxes(parts)
    tags = body.groups["b.y0"].tags + body.groups["c.y0"].tags
    body = dataclasses.replace(body, groups=body.groups | {"two": Group(1, tags)})
    on = touching("lower.y1", "a.y0", friction_coefficient=0.5)
    two = touching("lower.y1", "two", friction_coefficient=0.5)
    slaves, reasons = chosen(body, on, two)
    assert slaves == ["a.y0", "two"]
    assert reasons == ["the other is in several contacts"] * 2
    again = touching("two", "lower.y1", friction_coefficient=0.5)
    # Both surfaces of one contact are in another: one is the slave of both, or they made a ring.
    slaves, reasons = chosen(body, on, two, again)
    assert slaves[0] == "a.y0"
    assert slaves[1] == slaves[2]
    assert "so masters do not follow each other in a ring" in reasons
    assert "so few surfaces are slaves of several contacts" in reasons
    slaves, _ = chosen(body, dataclasses.replace(on, slave="on"), two)
    assert slaves == ["lower.y1", "two"]


@pytest.mark.parametrize(
    "keys, words",
    [
        ({"obstacle": Obstacle("plane")}, "against_beside_obstacle"),
        ({"pressure": 1.0}, "against_beside_pressure"),
    ],
)
def test_a_contact_has_one_thing_opposite(keys, words):
    with refused(words, ValueError):
        touching(**keys)
    with refused("slave_without_against", ValueError):
        Contact("a", slave="on")
    with refused("against_itself", ValueError):
        Contact("a", against="a")


def test_moduli_of_two_bodies():
    """Compliances add up: E* = [(1 − ν₁²)/E₁ + (1 − ν₂²)/E₂]⁻¹ (Johnson, (4.1))."""
    soft, stiff = Moduli(100, 0.4, False), Moduli(1e8, 0.3, False)
    assert soft.against(stiff).plane_strain == pytest.approx(
        1 / ((1 - 0.4**2) / 100 + (1 - 0.3**2) / 1e8)
    )
    assert soft.against(soft).combined == pytest.approx(50)
    assert soft.against(stiff).confined == pytest.approx(soft.confined, rel=1e-5)
