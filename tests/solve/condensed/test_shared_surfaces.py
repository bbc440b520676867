"""A surface in several contacts, slave or master: by the condensed solver as by the full one."""

import dataclasses
from itertools import product

import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Group,
    Material,
    Scene,
    Steps,
    Support,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.verification.boxes import Box, boxes
from tests.solve.same_answer import require_same

COMM = MPI.COMM_WORLD
PLATE = Box("plate", (0, -0.4), (2, 0), (10, 3))
LEFT = Box("left", (0.1, 0), (0.9, 0.5), (5, 3))
RIGHT = Box("right", (1.1, 0), (1.8, 0.5), (3, 4))
FLAT = (PLATE, LEFT, RIGHT)
DEEP = (
    Box("plate", (0, -0.4, 0), (2, 0, 1), (6, 1, 2)),
    Box("left", (0.1, 0, 0), (0.9, 0.5, 1), (3, 2, 3)),
    Box("right", (1.1, 0, 0), (1.8, 0.5, 1), (2, 2, 3)),
)
CHOICES = list(product(["on", "against"], repeat=2))


def on_a_plate(slaves=("auto", "auto"), dimension=2, **changes):
    """Two blocks on one face of a plate, pressed down and aside."""
    clamped = dict.fromkeys("xyz"[:dimension], 0)
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("plate.y0", clamped),
            Support("left.y1", clamped | {"x": 0.001, "y": -0.01}),
            Support("right.y1", clamped | {"x": -0.004, "y": -0.01}),
        ),
        contact=tuple(
            Contact(
                "plate.y1", against=f"{name}.y0", name=name, slave=slave, friction_coefficient=0.3
            )
            for name, slave in zip(("left", "right"), slaves, strict=True)
        ),
    )
    return dataclasses.replace(scene, **changes)


@pytest.mark.parametrize("slaves", CHOICES)
def test_two_blocks_on_one_face(slaves):
    require_same(on_a_plate(slaves), boxes(FLAT))


@pytest.mark.parametrize("degree", [1, 2])
def test_the_same_in_space(degree):
    scene = on_a_plate(("on", "on"), 3, discretisation=Discretisation(degree=degree))
    require_same(scene, boxes(DEEP, "hexahedron"))


def test_bodies_that_slide_are_paired_anew():
    scene = on_a_plate(("on", "on"), steps=Steps(number=3))
    contacts = tuple(dataclasses.replace(c, law="incremental") for c in scene.contact)
    require_same(dataclasses.replace(scene, contact=contacts), boxes(FLAT))


def derived_of(scene, body):
    """How many jumps are no unknowns, and how many unknowns there are."""
    problem = Problem.on_mesh(scene, body)
    surfaces = [SurfaceMatrix(contact) for contact in problem.contacts]
    variables = ContactVariables(
        ContactDofs(problem.spaces, problem.constrained, problem.discrete.sides),
        surfaces,
    )
    return variables.derived_count, variables.count


def test_a_slave_at_two_places_has_no_derived_jumps():
    """No node of the plate faces both blocks; where they are close, one facet's two may."""
    assert derived_of(on_a_plate(("on", "on")), boxes(FLAT))[0] == 0
    assert derived_of(on_a_plate(("on", "on"), 3), boxes(DEEP, "hexahedron"))[0] == 0
    close = (PLATE, LEFT, Box("right", (0.95, 0), (1.8, 0.5), (3, 4)))
    assert derived_of(on_a_plate(("on", "on")), boxes(close))[0] <= 4


# Three blocks in a stack, both faces of the middle one a single group: a surface in two contacts.
STACK = (
    Box("lower", (0, -1), (1, 0), (6, 5)),
    Box("middle", (0, 0), (1, 0.5), (5, 3)),
    Box("upper", (0, 0.5), (1, 1.5), (4, 3)),
)


def in_one_group(body, name, *parts):
    tags = tuple(tag for part in parts for tag in body.groups[part].tags)
    return dataclasses.replace(body, groups=body.groups | {name: Group(body.dimension - 1, tags)})


def stack_of_three(slaves, **changes):
    clamped = {"x": 0, "y": 0}
    pairs = (("faces", "lower.y1"), ("upper.y0", "faces"))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("lower.y0", clamped), Support("upper.y1", {"x": 0.002, "y": -0.01})),
        contact=tuple(
            Contact(on, against=against, name=f"c{number}", slave=slave, friction_coefficient=0.3)
            for number, ((on, against), slave) in enumerate(zip(pairs, slaves, strict=True))
        ),
    )
    return dataclasses.replace(scene, **changes)


def stack_body():
    return in_one_group(boxes(STACK), "faces", "middle.y0", "middle.y1")


@pytest.mark.parametrize("slaves", CHOICES)
def test_both_faces_of_a_middle_part_in_one_group(slaves):
    require_same(stack_of_three(slaves), stack_body())
    assert derived_of(stack_of_three(slaves), stack_body())[0] == 0
