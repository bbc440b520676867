"""The stiffness of bodies applied and not formed, and contacts solved by their forces."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import find

from fenics_contact import Discretisation, Load, Material, Run
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve import solver_choice
from fenics_contact.solve.condensed.applied.applied_bulk import AppliedBulk
from fenics_contact.solve.condensed.applied.dual_tangent import DualTangent
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent, OfSchur
from fenics_contact.solve.condensed.scalar_border import ScalarBorder
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.tangent import ContactTangent
from fenics_contact.solve.systems import near_nodes
from fenics_contact.verification.boxes import boxes
from tests.solve.condensed.test_near_nodes import beams
from tests.solve.condensed.test_shared_surfaces import DEEP, FLAT, on_a_plate
from tests.solve.same_answer import require_same

COMM = MPI.COMM_WORLD


@pytest.fixture
def of_few(monkeypatch):
    """Apply S however few dofs contacts have; counts the solves with the tangent."""
    found = []
    plain = DualTangent.solve

    def counted(tangent, *given):
        found.append(given)
        return plain(tangent, *given)

    monkeypatch.setattr(solver_choice, "_VERY_MANY", 0)
    monkeypatch.setattr(DualTangent, "solve", counted)
    return found


def loose(**changes):
    """Two blocks that loads alone press on a plate, and aside; friction holds them."""
    scene = on_a_plate(("on", "on"), 3, **changes)
    loads = tuple(
        load
        for name in ("left", "right")
        for load in (Load(f"{name}.y1", pressure=2.0), Load(f"{name}.y1", traction=(0.4, 0, 0.3)))
    )
    return dataclasses.replace(scene, support=scene.support[:1], load=loads)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("make", [lambda **keys: on_a_plate(("on", "on"), 3, **keys), loose])
def test_the_answer_is_that_of_the_full_system(of_few, make, degree):
    scene = make(discretisation=Discretisation(degree=degree))
    require_same(scene, boxes(DEEP, "hexahedron"), 1e-7)
    assert COMM.bcast(len(of_few) > 0)


def test_what_closes_comes_back_and_other_bodies_keep_their_factors(of_few, monkeypatch):
    monkeypatch.setattr(near_nodes, "_FEW", 0)
    made = require_same(*beams(3), 1e-7)
    assert made.solution.factorisations > 1
    assert COMM.bcast(len(of_few) > 0)


def test_no_memory_is_asked_for_all_contact_dofs_squared(of_few):
    """The estimate grows with the contact dofs, and is far below that of S."""
    found = []
    for cells in (2, 4):
        scene = on_a_plate(("on", "on"), 3)
        shapes = tuple(
            dataclasses.replace(one, cells=tuple(cells * number for number in one.cells))
            for one in DEEP
        )
        problem = Problem.on_mesh(scene, boxes(shapes, "hexahedron"))
        count = solver_choice.contact_unknowns(problem)
        found.append((count, solver_choice.memory_terms(problem, "condensed")["dense"]))
    (few, small), (many, large) = found
    assert many > 3 * few
    assert large / small == pytest.approx(many / few, rel=0.1)
    assert large < 8 * many**2


def test_models_that_need_the_stiffness_formed_have_it(monkeypatch):
    """Bodies in the plane and nearly incompressible ones."""
    monkeypatch.setattr(solver_choice, "_VERY_MANY", 0)
    deep, body = on_a_plate(("on", "on"), 3), boxes(DEEP, "hexahedron")
    assert solver_choice.applies_stiffness(Problem.on_mesh(deep, body), [None, None])
    soft = dataclasses.replace(deep, material=Material(1000, 0.4999))
    assert not solver_choice.applies_stiffness(Problem.on_mesh(soft, body), [None, None])
    flat = Problem.on_mesh(on_a_plate(("on", "on")), boxes(FLAT))
    assert not solver_choice.applies_stiffness(flat, [None, None])


def bulks(scene, body):
    """The bulk with S applied and with S formed, of the same contact dofs."""
    problem = Run(scene, COMM, body).problem
    system = CondensedSystem(problem, Timings())
    known = system.stiffness, system.held, system.dofs.free
    return system, AppliedBulk(*known), CondensedBulk(*known)


@pytest.mark.parametrize("make", [lambda: on_a_plate(("on", "on"), 3), loose])
def test_what_is_applied_is_the_schur_complement(make):
    system, applied, formed = bulks(make(), boxes(DEEP, "hexahedron"))
    random = np.random.default_rng(3 + COMM.rank)
    x, load = random.normal(size=applied.count), random.normal(size=len(system.held))
    load[system.held] = 0.0
    x = COMM.bcast(x)
    mine, theirs = applied.condense(load), formed.condense(load)
    found = applied.expand(load, x)
    assert found == pytest.approx(formed.expand(load, x), rel=1e-9, abs=1e-11)
    several = applied.expand(np.array([load, 2 * load]), np.array([x, 2 * x]))
    assert several == pytest.approx(np.array([found, 2 * found]), rel=1e-11, abs=1e-13)
    motions = 0
    if COMM.rank == 0:
        size = np.abs(formed.schur).max()
        assert applied.times(x) == pytest.approx(formed.schur @ x, rel=1e-9, abs=1e-10 * size)
        assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-11)
        motions = applied.motions.shape[1]
        if motions:
            # Forces in balance on each part that could move.
            basis, _ = np.linalg.qr(applied.motions)
            assert np.abs(formed.schur @ basis).max() <= 1e-11 * size
            x -= basis @ (basis.T @ x)
        assert formed.schur @ applied.compliance(x) == pytest.approx(x, abs=1e-8)
    assert COMM.bcast(motions) == (0 if len(make().support) > 1 else 12)
    for thing in (applied, formed, system):
        thing.destroy()


class GivenSchur(OfSchur):
    """Two bodies of 15 dofs; of the second none resists three motions."""

    def __init__(self, random):
        super().__init__(np.zeros((0, 0)))
        null, _ = np.linalg.qr(random.normal(size=(15, 3)))
        held, free = random.normal(size=(2, 15, 15))
        away = np.eye(15) - null @ null.T
        self.written = np.zeros((30, 30))
        self.written[:15, :15], self.written[15:, 15:] = held @ held.T, away @ free @ free.T @ away
        springs = np.zeros(30)
        springs[[15, 19, 24]] = 5.0
        self._inverse = np.linalg.inv(self.written + np.diag(springs))
        self.motions = np.zeros((30, 3))
        self.motions[15:] = null

    diagonal = property(lambda self: self.written.diagonal())
    stiffest = property(lambda self: self.written.diagonal().max())

    def times(self, values):
        return self.written @ values

    def held_times(self, values):
        return self.diagonal * values

    def moved_by(self, forces):
        return forces @ self._inverse


def contacts_of(jumps, derived, random):
    """W of bonded, sticking and sliding nodes, and of nodes that are coupled."""
    added = np.zeros((30 + derived, 30 + derived))
    for first in (9, 12, 18, 21, 24):
        normal, along = np.eye(3)[2], np.eye(3)[0]
        block = jumps * np.outer(normal, normal)
        if first == 24:
            block += 0.3 * jumps * np.outer(along, normal) + 1e-5 * np.eye(3)
        else:
            block += jumps * (np.eye(3) - np.outer(normal, normal))
        added[first : first + 3, first : first + 3] = block
    pair = random.normal(size=(2, 3)) * np.sqrt(jumps)
    added[18:21, 18:21] += pair.T @ pair
    added[range(30, 30 + derived), range(30, 30 + derived)] = jumps
    return added


@pytest.mark.parametrize("held", [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("derived", [0, 2])
@pytest.mark.parametrize("jumps", [1e2, 1e5])
def test_tangent_against_a_plain_solve(held, derived, jumps):
    """With scalars that are free or held, derived jumps, and contacts that slide."""
    random = np.random.default_rng(4)
    schur = GivenSchur(random)
    rows = random.normal(size=(derived, 30))
    constant = ConstantTangent(schur.matrix, np.zeros((30, 0)), np.zeros(0), rows, schur)
    columns = random.normal(size=(30, 2))
    columns -= schur.motions @ (schur.motions.T @ columns)
    # The first scalar is as the shortening of a bolt that nothing else holds.
    corner = columns.T @ np.linalg.pinv(schur.written) @ columns + np.diag([0.0, 3.0])
    border = ScalarBorder(columns, corner, corner.diagonal())
    border.hold(np.array(held))
    tangent = ContactTangent(DualTangent(constant, schur, np.arange(30) // 3), border)
    added = contacts_of(jumps, derived, random)
    tangent.set(find(added))
    every = np.vstack([np.eye(30), rows])
    lines = np.where(np.array(held)[:, None], 0.0, columns.T)
    own = np.where(np.array(held)[:, None], np.diag(corner.diagonal()), corner)
    whole = np.block([[schur.written + every.T @ added @ every, columns], [lines, own]])
    right = random.normal(size=32)
    for matrix, found in (
        (whole, tangent.solve(right)),
        (whole.T, tangent.solve_transposed(right)),
    ):
        # Forces of derived jumps follow from differences of displacements.
        allowed = 1e-6 if derived else 3e-8
        assert np.linalg.norm(matrix @ found - right) <= allowed * np.linalg.norm(right)
    if not any(held):
        assert tangent.multiply(found) == pytest.approx(whole @ found, rel=1e-9, abs=1e-9)
    loosely = tangent.solve(right, 1e-3)
    left = np.linalg.norm(whole @ loosely - right) / np.linalg.norm(right)
    assert left <= 3e-3


def test_no_number_where_nothing_resists_a_motion():
    random = np.random.default_rng(5)
    schur = GivenSchur(random)
    constant = ConstantTangent(
        schur.matrix, np.zeros((30, 0)), np.zeros(0), np.zeros((0, 30)), schur
    )
    tangent = ContactTangent(DualTangent(constant, schur, np.arange(30) // 3))
    added = np.zeros((30, 30))
    added[3, 3] = 1e4  # on the body that is held
    tangent.set(find(added))
    assert np.isnan(tangent.solve(schur.motions @ np.ones(3))).all()
    balanced = np.append(random.normal(size=15), np.zeros(15))
    found = tangent.solve(balanced)
    assert (schur.written + added) @ found == pytest.approx(balanced, abs=1e-7)
