"""Pairs of bodies by the iterative solver: the condensed one's answers."""

import dataclasses
from itertools import product

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Group,
    Load,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.common.parallel import largest
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.iterative.iterative_system import (
    FreeBodies,
    IterativeSystem,
    Preconditioner,
)
from fenics_contact.solve.solver_choice import choose_solver
from fenics_contact.solve.systems.full_system import FullSystem
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD
LOWER = Box("lower", (0, 0, -1), (1, 1, 0), (5, 5, 4))
UPPER = Box("upper", (0, 0, 0), (1, 1, 1), (4, 4, 3))
TOP = Box("top", (0, 0, 1), (1, 1, 2), (3, 3, 3))
CLAMP = Support("lower.z0", {"x": 0, "y": 0, "z": 0})
DEEP = (
    Box("block", (0, 0, 0), (1, 1, 1), (4, 4, 4)),
    Box("floor", (0, -0.5, 0), (1.25, 0, 1), (3, 2, 3)),
    Box("wall", (-0.5, -0.5, 0), (0, 1.25, 1), (2, 5, 3)),
)
CHOICES = list(product(["on", "against"], repeat=2))


def pair(coefficient, **changes):
    """A block pressed onto another, its top moved down and aside."""
    contact = Contact("upper.z0", against="lower.z1", friction_coefficient=coefficient)
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(CLAMP, Support("upper.z1", {"x": 0.004, "y": 0.001, "z": -0.02})),
        contact=(contact,),
    )
    return dataclasses.replace(scene, **changes)


def solved(scene, body, solver):
    prepared = Run(
        dataclasses.replace(scene, solver=SolverSettings(solver=solver, errors="none")), COMM, body
    )
    result = prepared.solve()
    assert result.passed, result.verdict
    return prepared.solution


def require_same(scene, body):
    found, wanted = (solved(scene, body, solver) for solver in ("iterative", "condensed"))
    parts = [(found.displacement, wanted.displacement)]
    parts += list(zip(found.contact_force, wanted.contact_force, strict=True))
    for one, other in parts:
        assert largest(COMM, np.abs(one - other)) < 1e-7 * largest(COMM, np.abs(other))
    return found


@pytest.mark.parametrize("coefficient", [0.0, 0.05, 0.3, 1.0])
def test_sticking_and_slipping(coefficient):
    require_same(pair(coefficient), boxes((LOWER, UPPER), "hexahedron"))


def test_bodies_that_slide_are_paired_anew():
    contact = Contact("upper.z0", against="lower.z1", friction_coefficient=0.1, law="incremental")
    aside = Support("upper.z1", {"x": 0.15, "y": 0.02, "z": -0.02})
    scene = pair(0.1, contact=(contact,), support=(CLAMP, aside), steps=Steps(number=3))
    require_same(scene, boxes((LOWER, UPPER), "hexahedron"))


def test_bodies_that_only_contact_holds():
    """Each slave or master of what holds it, a load moves the upper one."""
    contacts = (
        Contact("upper.z0", against="lower.z1", friction_coefficient=0.5),
        Contact("top.z0", against="upper.z1", friction_coefficient=0.5),
    )
    load = (Load("top.z1", traction=(0.1, 0, -1)),)
    scene = pair(0.5, contact=contacts, support=(CLAMP,), load=load)
    require_same(scene, boxes((LOWER, UPPER, TOP), "hexahedron"))


def seat(slaves):
    """A block on a floor and against a wall: its edge is in both contacts."""
    clamped = {"x": 0, "y": 0, "z": 0}
    faces = (("block.y0", "floor.y1"), ("block.x0", "wall.x1"))
    contacts = tuple(
        Contact(on, against=against, slave=slave, friction_coefficient=0.3)
        for (on, against), slave in zip(faces, slaves, strict=True)
    )
    support = (
        Support("floor.y0", clamped),
        Support("wall.x0", clamped),
        Support("block.y1", clamped | {"x": -0.002, "y": -0.01}),
    )
    return pair(0.3, contact=contacts, support=support)


@pytest.mark.parametrize("slaves", CHOICES)
def test_contacts_that_share_an_edge(slaves):
    """Its nodes are slaves twice, masters twice, or a slave here and a master there."""
    require_same(seat(slaves), boxes(DEEP, "hexahedron"))


def cycles(monkeypatch, scene, body):
    """How often multigrid was applied in a solve."""
    applied, precondition = [], Preconditioner.apply

    def counted(self, of, right, solution):
        applied.append(1)
        precondition(self, of, right, solution)

    monkeypatch.setattr(Preconditioner, "apply", counted)
    settings = SolverSettings(solver="iterative", errors="none")
    assert Run(dataclasses.replace(scene, solver=settings), COMM, body).solve().converged
    return len(applied)


def test_slaves_that_are_masters_cost_no_more(monkeypatch):
    """Else what is as stiff as the penalty is left to multigrid, which cannot follow it."""
    body = boxes(DEEP, "hexahedron")
    counts = [cycles(monkeypatch, seat(slaves), body) for slaves in CHOICES]
    apart, linked = [counts[0], counts[3]], counts[1:3]
    assert max(linked) < 1.5 * max(apart)


def stack():
    """Two blocks that friction alone holds on a clamped one, pressed and pushed aside."""
    contacts = tuple(
        Contact(on, against=against, friction_coefficient=0.3)
        for on, against in (("upper.z0", "lower.z1"), ("top.z0", "upper.z1"))
    )
    load = (Load("top.z1", traction=(0.3, 0.0, -5.0)),)
    return pair(0.3, contact=contacts, support=(CLAMP,), load=load)


def test_bodies_that_no_support_holds():
    body = boxes((LOWER, UPPER, TOP), "hexahedron")
    require_same(stack(), body)
    assert choose_solver(Problem.on_mesh(stack(), body)).name == "condensed"


def test_rigid_motions_of_free_bodies_save_cycles(monkeypatch):
    body = boxes((LOWER, UPPER, TOP), "hexahedron")
    with monkeypatch.context() as patched:
        solved_for = cycles(patched, stack(), body)
    never = property(lambda _: False, lambda *_: None)
    monkeypatch.setattr(FreeBodies, "are_any", never, raising=False)
    assert solved_for < 0.7 * cycles(monkeypatch, stack(), body)


PLATE = (LOWER, Box("plate", (0, 0, 0), (1, 1, 0.25), (4, 4, 1)))
ABOVE = Box("above", (0, 0, 0.25), (1, 1, 1), (5, 5, 3))


@pytest.mark.parametrize("slaves", CHOICES)
def test_a_plate_between_two_bodies_whose_faces_are_one_group(slaves):
    """One cell thick, each cell of it in both contacts: a slave's other face is not in the zone."""
    body = boxes((*PLATE, ABOVE), "hexahedron")
    tags = body.groups["plate.z0"].tags + body.groups["plate.z1"].tags
    body = dataclasses.replace(body, groups=body.groups | {"plate.faces": Group(2, tags)})
    sides = (("plate.faces", "lower.z1"), ("above.z0", "plate.faces"))
    contacts = tuple(
        Contact(on, against=against, name=on[0], slave=slave, friction_coefficient=0.3)
        for (on, against), slave in zip(sides, slaves, strict=True)
    )
    support = (CLAMP, Support("above.z1", {"x": 0.004, "y": 0.001, "z": -0.02}))
    require_same(pair(0.3, contact=contacts, support=support), body)


@pytest.mark.parametrize("slave", ["auto", "on", "against"])
def test_a_face_against_a_body_and_an_obstacle(slave):
    """The upper block's face rests on a narrow block, and beside it on a ball."""
    ball = Obstacle("sphere", radius=2.0, position=(0.75, 0.5, 0.0), indentation=0.005)
    contacts = (
        Contact("upper.z0", against="half.z1", slave=slave, name="pair", friction_coefficient=0.3),
        Contact("upper.z0", obstacle=ball, name="ball", friction_coefficient=0.2),
    )
    half = Box("half", (0, 0, -1), (0.5, 1, 0), (3, 5, 4))
    scene = pair(
        0.3,
        contact=contacts,
        support=(Support("half.z0", {"x": 0, "y": 0, "z": 0}), pair(0.3).support[1]),
    )
    require_same(scene, boxes((half, UPPER), "hexahedron"))


@pytest.mark.parametrize("driven", [{"indentation": 0.004}, {"force": 2.0}])
def test_an_obstacle_beside_another_body(driven):
    plane = Obstacle("plane", normal=(1, 0, 0), position=(0, 0.5, 0.5), **driven)
    scene = pair(0.3)
    contacts = (*scene.contact, Contact("upper.x0", obstacle=plane, friction_coefficient=0.2))
    require_same(dataclasses.replace(scene, contact=contacts), boxes((LOWER, UPPER), "hexahedron"))


def test_the_tangent_is_that_of_the_full_solver():
    """K + Jᵀ K_c J, applied by its factors and as a matrix, where a part slips."""
    body = boxes((LOWER, UPPER), "hexahedron")
    images = []
    for kind in (FullSystem, IterativeSystem):
        problem = Problem.on_mesh(pair(0.1), body)
        problem.set_time(1.0)
        spaces = problem.spaces
        x = spaces.coordinates
        system = kind(problem, Timings())
        lowered = np.stack([1e-3 * x[:, 2], 0 * x[:, 0], -1e-3 * (x[:, 2] + x[:, 0])], axis=1)
        system.begin(lowered)
        system.linearise(system.state)
        given, image = system.tangent.createVecs()
        with given as array:
            array[:] = np.sin(np.arange(*given.getOwnershipRange()) ** 2.0)
            array[system.held] = 0.0
        system.tangent.mult(given, image)
        found = np.array(image.array_r)
        found[system.held] = 0.0
        images.append(found)
        system.destroy()
    assert largest(COMM, np.abs(images[0] - images[1])) <= 1e-12 * largest(COMM, np.abs(images[0]))
