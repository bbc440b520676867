"""Forces and tangents point by point are those of the compiled forms, of every law and mode."""

import numpy as np
import pytest

from fenics_contact.body.description import BodyDescription
from fenics_contact.contact.laws import normal
from fenics_contact.contact.laws.normal.elastic_laws import Unilateral
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from tests.simulation.studies.cases import CASES

NAMES = ("prescribed", "unilateral", "foundation", "compliance", "incremental", "bolt")


def both(contact, action):
    """By the forms, then by points."""
    found = []
    for contact.forces.by_points in (False, True):
        found.append(action())
    return found


def modes_of(contact):
    """Those that its friction may have."""
    if not contact.friction.has_friction:
        return ("law",)
    others = ("status", "held", "off")
    return ("law", "coupled", *others) if contact.is_coulomb else ("law", *others)


def matrix_of(surface):
    size = len(surface.dofs)
    rows, columns, values = surface.entries()
    found = np.zeros((size, size))
    np.add.at(found, (rows, columns), values)
    return surface.contact.spaces.comm.allreduce(found)


def displaced(contact, random):
    """Most points touch, and some slip."""
    into = contact.trace.normals_at_nodes
    jump = 0.02 * into + 0.01 * random.normal(size=into.shape)
    contact.kinematics.move(
        contact.trace.surface.of_owners(jump) + contact.kinematics.motion_at_nodes
    )
    return contact.kinematics.tangential(contact.kinematics.jump_at_points())


def use_friction(contact, mode, slip):
    """Have a solver use friction in one of its ways, the tangent at a slip."""
    term = contact.friction_term
    term.follow_law()
    term.tangent_state.stick_all()
    term.linearise_at(0.7 * slip)
    term.linearise_at(slip)
    if mode == "coupled":
        term.follow_pressure()
    if mode == "held":
        term.hold(contact.trace.coordinates[:, : slip.shape[1]])
    if mode == "off":
        term.exert_nothing()
    if mode == "status":
        directions = slip / np.linalg.norm(slip, axis=1)[:, None]
        term.set_status(contact.trace.coordinates[:, 0] < 0.4, directions, contact.friction.bound)


@pytest.mark.parametrize("name", [*NAMES, "half-space", "in space", "two bodies"])
def test_both_ways_give_the_same(name):
    scene, make, _ = CASES[name]
    problem = Problem(scene, DiscreteBody(BodyDescription.of(scene), make()))
    random = np.random.default_rng(3)
    for contact in problem.contacts:
        surface = SurfaceMatrix(contact)
        contact.friction.regularisation.set(0.005)
        for mode in modes_of(contact):
            slip = displaced(contact, random)
            contact.friction.set_bound(1 + contact.trace.coordinates[:, 0])
            if contact.friction.has_friction:
                use_friction(contact, mode, slip)
            for held in (False, True) if mode in ("law", "status") else (False,):
                if held:
                    contact.normal_term.hold(2 + contact.trace.coordinates[:, 0])
                for term in contact.forces.terms:
                    expected, found = both(contact, lambda term=term, c=contact: c.forces.of(term))
                    scale = np.abs(expected).max(initial=1e-300)
                    assert np.abs(found - expected).max(initial=0) <= 1e-12 * scale
                expected, found = both(contact, lambda surface=surface: matrix_of(surface))
                scale = np.abs(expected).max(initial=1e-300)
                assert np.abs(found - expected).max(initial=0) <= 1e-12 * scale
                assert held or not contact.normal.follows_jump or scale > 1
                contact.normal_term.follow_law()


class Twice(Unilateral):
    """A law that changes its forces, and does not say what they are at the points."""

    def force(self):
        return 2 * super().force()


def test_a_law_with_forces_of_its_own_goes_by_its_forms(monkeypatch):
    scene, make, _ = CASES["unilateral"]
    laws = tuple(Twice if law is Unilateral else law for law in normal.LAWS)
    discrete = DiscreteBody(BodyDescription.of(scene), make())
    assert Problem(scene, discrete, by_points=True).contacts[0].forces.by_points
    monkeypatch.setattr(normal, "LAWS", laws)
    assert not Problem(scene, discrete, by_points=True).contacts[0].forces.by_points
