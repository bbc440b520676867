"""Contacts that share nodes, and slaves that supports hold: right, and as sparse as they are."""

import dataclasses
from itertools import product

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Group, Material, Obstacle, Scene, Steps, Support
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.verification.boxes import Box, boxes
from tests.solve.condensed.stiff_and_soft import Split
from tests.solve.same_answer import require_same

COMM = MPI.COMM_WORLD
# A block on a floor and against a wall, which may stand against the floor as well.
BLOCK = Box("block", (0, 0), (1, 1), (6, 6))
FLOOR = Box("floor", (0, -0.5), (1.25, 0), (5, 3))
WALL = Box("wall", (-0.5, -0.5), (0, 1.25), (3, 7))
FLAT = (BLOCK, FLOOR, WALL)
DEEP = (
    Box("block", (0, 0, 0), (1, 1, 1), (3, 3, 3)),
    Box("floor", (0, -0.5, 0), (1.25, 0, 1), (2, 1, 2)),
    Box("wall", (-0.5, -0.5, 0), (0, 1.25, 1), (1, 4, 2)),
)
BOTH = (("block.y0", "floor.y1"), ("block.x0", "wall.x1"))
RING = (BOTH[0], ("block.x0", "wall.upper"), ("floor.x0", "wall.lower"))


def seat(pairs=BOTH, slaves=(), dimension=2, **changes):
    """A block in a seat, its top moved down and sideways; what it stands on is clamped."""
    clamped = dict.fromkeys("xyz"[:dimension], 0)
    moved = clamped | {"x": -0.002, "y": -0.01}
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("floor.y0", clamped),
            Support("wall.x0", clamped),
            Support("block.y1", moved),
        ),
        contact=tuple(
            Contact(on, against=against, slave=slave, friction_coefficient=0.3)
            for (on, against), slave in zip(pairs, slaves or ("auto",) * len(pairs), strict=True)
        ),
    )
    return dataclasses.replace(scene, **changes)


def ring_body():
    """The block, the floor and the wall, whose side is two groups that share a node."""
    body = boxes(FLAT)
    tags = body.facet_tags
    (old,) = body.groups["wall.x1"].tags
    height = mesh.compute_midpoints(body.mesh, 1, tags.indices)[:, 1]
    values = np.where((tags.values == old) & (height < 0), 99, tags.values).astype(np.int32)
    groups = body.groups | {"wall.upper": Group(1, (old,)), "wall.lower": Group(1, (99,))}
    tags = mesh.meshtags(body.mesh, 1, tags.indices, values)
    return dataclasses.replace(body, facet_tags=tags, groups=groups)


CHOICES = list(product(["on", "against"], repeat=2))
RINGS = list(product(["on", "against"], repeat=3))


@pytest.mark.parametrize("slaves", CHOICES)
def test_a_slave_with_two_contacts_and_a_slave_that_is_a_master(slaves):
    require_same(seat(slaves=slaves), boxes(FLAT))


@pytest.mark.parametrize("slaves", CHOICES)
def test_the_same_with_stiff_and_soft_apart(slaves, monkeypatch):
    """Derived jumps too, as on contacts with many dofs."""
    split = Split(monkeypatch)
    require_same(seat(slaves=slaves), boxes(FLAT))
    split.require_used()


@pytest.mark.parametrize("slaves", RINGS)
def test_three_surfaces_at_one_edge(slaves):
    """With two of these choices each jump is measured from the next one's slave, in a ring."""
    require_same(seat(RING, slaves), ring_body())


@pytest.mark.parametrize("slaves", CHOICES)
@pytest.mark.parametrize("degree", [1, 2])
def test_the_same_in_space(slaves, degree):
    scene = seat(slaves=slaves, dimension=3, discretisation=Discretisation(degree=degree))
    require_same(scene, boxes(DEEP, "hexahedron"))


@pytest.mark.parametrize("driven", [{"indentation": 0.004}, {"force": 2.0}])
def test_an_obstacle_beside_another_body(driven):
    wall = Obstacle("plane", normal=(1, 0), position=(0, 0.5), **driven)
    scene = seat(BOTH[:1])
    scene = dataclasses.replace(
        scene,
        support=(scene.support[0], scene.support[2]),
        contact=(
            *scene.contact,
            Contact("block.x0", obstacle=wall, friction_coefficient=0.2),
        ),
    )
    require_same(scene, boxes(FLAT[:2]))


@pytest.mark.parametrize("slaves", CHOICES)
def test_bodies_that_slide_are_paired_anew(slaves):
    scene = seat(slaves=slaves, steps=Steps(number=3))
    contacts = tuple(dataclasses.replace(c, law="incremental") for c in scene.contact)
    require_same(dataclasses.replace(scene, contact=contacts), boxes(FLAT))


def variables_of(scene, body):
    problem = Problem.on_mesh(scene, body)
    surfaces = [SurfaceMatrix(contact) for contact in problem.contacts]
    dofs = ContactDofs(problem.spaces, problem.constrained, problem.discrete.sides)
    return ContactVariables(dofs, surfaces), surfaces, dofs


@pytest.mark.parametrize("slaves", CHOICES)
def test_only_shared_and_held_dofs_are_derived(slaves):
    """Of two contacts the corner's dofs, and those at the top that its support holds."""
    variables, surfaces, _ = variables_of(seat(slaves=slaves), boxes(FLAT))
    assert len(variables.derived) <= 4
    for surface in surfaces:
        rows, unknowns = variables.own_unknowns(surface)
        assert len(set(rows)) == len(rows)
        assert len(set(unknowns)) == len(unknowns)


@pytest.mark.parametrize(
    ("pairs", "slaves"), [(BOTH, s) for s in CHOICES] + [(RING, s) for s in RINGS]
)
def test_unknowns_are_displacements_in_other_terms(pairs, slaves):
    """T y, its inverse, its transpose, and the jumps, each against its definition."""
    variables, surfaces, dofs = variables_of(
        seat(pairs, slaves), ring_body() if pairs is RING else boxes(FLAT)
    )
    random = np.random.default_rng(3)
    moved, forces = random.normal(size=(2, variables.count))
    unknowns = variables.unknowns(moved)
    np.testing.assert_allclose(variables.displacements(unknowns), moved, rtol=1e-12, atol=1e-12)
    assert variables.forces(forces) @ unknowns == pytest.approx(forces @ moved, rel=1e-12)
    at_all = random.normal(size=len(dofs.numbers))
    held = np.where(dofs.is_free, 0.0, at_all)
    at_all[dofs.is_free] = moved
    every = np.concatenate([unknowns, variables.derived @ unknowns])
    for surface in surfaces:
        pairing = surface.contact.kinematics.pairing
        expected = at_all[dofs.places(surface.dofs)]
        opposite = at_all[dofs.places(pairing.dofs)].reshape(-1, 2)
        expected -= pairing.whole_projection().apply(opposite).reshape(-1)
        expected[np.repeat(~pairing.whole_faced(), 2)] = 0.0
        np.testing.assert_allclose(variables.derived_jumps(unknowns), every[variables.count :])
        rows, own = variables.own_unknowns(surface)
        found = variables.held_part(surface, held)
        found[rows] += every[own]
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)
