"""Slaves and masters that follow each other in a ring: avoided, solved, or refused beforehand."""

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Group,
    Material,
    MeshSource,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.common.parallel import largest
from fenics_contact.contact.choice_of_slaves import has_ring, without_rings
from fenics_contact.mesh.loading import load_body
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.iterative.contact_zone import cannot_be_carried
from fenics_contact.solve.solver_choice import choose_solver
from fenics_contact.verification.boxes import Box, boxes
from tests import cad
from tests.messages import refused
from tests.scenes import with_solver
from tests.solve.same_answer import require_same, solved

COMM = MPI.COMM_WORLD
CLAMPED = {"x": 0, "y": 0, "z": 0}


def assembly(pairs, slave, support):
    """Elastic bodies with friction between some of their faces, in one contact each."""
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=support,
        contact=tuple(
            Contact(on, against=against, name=on[0], slave=slave, friction_coefficient=0.3)
            for on, against in pairs
        ),
    )


def four(slave):
    """Blocks around an edge, each in contact with the next; all but the first are moved at it."""
    places = {"a": (0, 0), "b": (1, 0), "c": (1, 1), "d": (0, 1)}
    body = boxes(
        tuple(
            Box(name, (x, y, 0), (x + 1, y + 1, 1), (2, 2, 1)) for name, (x, y) in places.items()
        ),
        "hexahedron",
    )
    pairs = (("a.x1", "b.x0"), ("b.y1", "c.y0"), ("c.x0", "d.x1"), ("d.y0", "a.y1"))
    push = {"a": (0, 0), "b": (-0.01, 0), "c": (-0.01, -0.01), "d": (0, -0.01)}
    sides = ("y0", "x1", "y1", "x0")
    support = tuple(
        Support(f"{name}.{side}", {"x": dx, "y": dy, "z": 0})
        for (name, (dx, dy)), side in zip(push.items(), sides, strict=True)
    )
    return assembly(pairs, slave, support), body


def three(slave):
    """A block on a floor and against a wall, which stands at the floor: they meet in an edge.

    Each that comes first is covered by the next.
    """
    parts = (
        Box("block", (0, 0, 0), (1, 1, 1), (4, 4, 2)),
        Box("floor", (0, -0.5, 0), (1.25, 0, 1), (3, 2, 2)),
        Box("wall", (-0.5, -0.5, 0), (0, 1, 1), (2, 6, 2)),
    )
    body = boxes(parts, "hexahedron")
    tags, (old,) = body.facet_tags, body.groups["wall.x1"].tags
    height = mesh.compute_midpoints(body.mesh, 2, tags.indices)[:, 1]
    values = np.where((tags.values == old) & (height < 0), 99, tags.values).astype(np.int32)
    groups = body.groups | {"wall.upper": Group(2, (old,)), "wall.lower": Group(2, (99,))}
    tags = mesh.meshtags(body.mesh, 2, tags.indices, values)
    body = dataclasses.replace(body, facet_tags=tags, groups=groups)
    pairs = (("block.y0", "floor.y1"), ("floor.x0", "wall.lower"), ("wall.upper", "block.x0"))
    support = (
        Support("floor.y0", CLAMPED),
        Support("wall.x0", CLAMPED),
        Support("block.y1", CLAMPED | {"x": -0.002, "y": -0.01}),
    )
    return assembly(pairs, slave, support), body


def test_four_bodies_are_chosen_in_no_ring():
    """So that the iterative solver has the answer that the condensed one has."""
    scene, body = four("auto")
    found = Run(scene, COMM, body).contacts()
    assert [one["slave"] for one in found] == ["a.x1", "c.y0", "c.x0", "a.y1"]
    assert found[1]["slave_reason"] == "so masters do not follow each other in a ring"
    scene = dataclasses.replace(scene, solver=SolverSettings(errors="none"))
    moved = [
        solved(scene, body, solver)[0].solution.displacement
        for solver in ("iterative", "condensed")
    ]
    assert largest(COMM, np.abs(moved[0] - moved[1])) < 1e-7 * largest(COMM, np.abs(moved[1]))


@pytest.mark.parametrize("slave", ["auto", "on"])
@pytest.mark.parametrize("bodies", [three, four])
def test_rings_and_what_is_chosen_for_them_have_one_answer(bodies, slave):
    scene, body = bodies(slave)
    assert ("in a ring" in cannot_be_carried(Problem.on_mesh(scene, body))) == (slave == "on")
    require_same(scene, body)


@pytest.mark.parametrize(
    ("slave", "message"), [("on", "contacts_in_a_ring"), ("auto", "carried_and_shared_slave")]
)
def test_three_bodies_at_an_edge_are_refused_and_condensed(slave, message):
    """One has slaves of two contacts there, and what these follow is the next one's slave."""
    scene, body = three(slave)
    with refused(message):
        choose_solver(Problem.on_mesh(with_solver(scene, solver="iterative"), body))
    assert choose_solver(Problem.on_mesh(scene, body)).name == "condensed"


def test_bodies_with_any_contacts_have_a_choice_without_rings():
    """Surfaces of one body may share nodes, others never do."""
    random = np.random.default_rng(0)
    rings = 0
    for _ in range(300):
        bodies, contacts = random.integers(3, 7), random.integers(3, 12)
        of = np.array([random.choice(bodies, 2, replace=False) for _ in range(contacts)]).ravel()
        met = random.random((2 * contacts, 2 * contacts)) < random.choice([0.3, 0.6, 1.0])
        shared = (of[:, None] == of) & (met | met.T) | np.eye(2 * contacts, dtype=bool)
        choice = list(random.random(contacts) < 0.5)
        rings += has_ring(choice, shared)
        assert not has_ring(without_rings(choice, range(contacts), shared), shared)
    assert rings > 100


@pytest.mark.serial
def test_a_bolt_in_a_hole_with_play(tmp_path):
    """Its head ends at the shank, before the hole: no node there faces the plate, but facets do.

    So the jump at the head follows the hole's edge, and that in the hole the edge of the head.
    """
    groups = {
        "plate": (10,),
        "head": (17,),
        "hole": (14,),
        "shank": (18,),
        "foot": (2,),
        "end": (21,),
    }
    file = cad.write_shapes(tmp_path / "joint.step", lambda occ: cad.joint(occ, 4.7))
    source = MeshSource(file, size=4.0, curvature=12, order=2, groups=groups)
    body = load_body(source, 3, COMM)

    def refusal(slaves):
        contacts = tuple(
            Contact(on, against=against, slave=slave)
            for (on, against), slave in zip(
                (("plate", "head"), ("hole", "shank")), slaves, strict=True
            )
        )
        support = (Support("foot", CLAMPED), Support("end", CLAMPED))
        scene = assembly((), "auto", support)
        scene = dataclasses.replace(scene, contact=contacts, discretisation=Discretisation(2))
        return cannot_be_carried(Problem.on_mesh(scene, body))

    assert "in a ring" in refusal(("against", "on"))
    assert refusal(("auto", "auto")) == ""
