"""Contacts so large that S is applied and not formed have the answers of the other solvers."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Discretisation, Run, Steps, Support
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve import solver_choice
from fenics_contact.solve.condensed import elimination
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.glued import recycled, zone
from fenics_contact.solve.glued_system import GluedSystem, is_glueable
from fenics_contact.solve.solver_choice import memory_terms
from fenics_contact.solve.systems.near_nodes import near_nodes
from fenics_contact.verification.boxes import boxes
from tests.scenes import with_solver
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.solve.condensed.test_near_nodes import beams
from tests.solve.condensed.test_shared_surfaces import DEEP, FLAT, on_a_plate
from tests.solve.newton.test_held_by_friction import clamp
from tests.solve.same_answer import require_same

COMM = MPI.COMM_WORLD


@pytest.fixture
def glued(monkeypatch):
    """Solve without S, however few jumps there are; the systems that were made so."""
    made = []

    class Noted(GluedSystem):
        def __init__(self, *given):
            super().__init__(*given)
            made.append(self)

    monkeypatch.setattr(solver_choice, "_MOST_JUMPS", 0)
    monkeypatch.setattr(solver_choice, "GluedSystem", Noted)
    return made


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(("dimension", "shapes"), [(2, FLAT), (3, DEEP)])
def test_the_answer_is_that_of_all_displacements(glued, dimension, shapes, degree):
    scene = on_a_plate(("on", "on"), dimension, discretisation=Discretisation(degree=degree))
    require_same(scene, boxes(shapes, "hexahedron") if dimension == 3 else boxes(shapes))
    assert len(glued) == 1


def test_bodies_that_slide_are_glued_anew(glued):
    scene = on_a_plate(("on", "on"), steps=Steps(number=3))
    pulled = Support("left.y1", {"x": -0.1, "y": -0.01})
    scene = dataclasses.replace(scene, support=(scene.support[0], pulled, scene.support[2]))
    contacts = tuple(dataclasses.replace(c, law="incremental") for c in scene.contact)
    made = require_same(dataclasses.replace(scene, contact=contacts), boxes(FLAT))
    assert made.solution.factorisations > 1
    assert len(glued) == 1


def test_a_bolt_and_what_friction_holds_are_those_of_the_dense_tangent(glued, monkeypatch):
    mine = clamp()
    mine.solve()
    assert len(glued) == 1
    monkeypatch.setattr(solver_choice, "_MOST_JUMPS", 10**9)
    theirs = clamp()
    theirs.solve()
    assert len(glued) == 1
    size = COMM.allreduce(np.abs(theirs.solution.displacement).max(initial=0), op=MPI.MAX)
    off = np.abs(mine.solution.displacement - theirs.solution.displacement).max(initial=0)
    assert COMM.allreduce(off, op=MPI.MAX) <= 1e-8 * size
    for one, other in zip(mine.steps, theirs.steps, strict=True):
        for contact, expected in zip(one.contacts, other.contacts, strict=True):
            for name in ("normal_force", "friction_force", "max_contact_pressure"):
                found = contact.quantities[name]
                assert found == pytest.approx(expected.quantities[name], rel=1e-8, abs=1e-7), name
        forces = [step.preloads["shank"].force for step in (one, other)]
        assert forces[0] == pytest.approx(forces[1], rel=1e-8)


@pytest.mark.serial
def test_a_run_goes_on(glued, tmp_path):
    scene, body = on_a_plate(("on", "on"), steps=Steps(number=2)), boxes(FLAT)
    contacts = tuple(dataclasses.replace(c, law="incremental") for c in scene.contact)
    scene = with_solver(dataclasses.replace(scene, contact=contacts), solver="condensed")
    whole = Run(scene, COMM, body).solve()
    stopped_after(scene, body, tmp_path, 1)
    found = resumed(scene, body, tmp_path)
    assert len(glued) == 3
    for contact, expected in zip(found.contacts, whole.contacts, strict=True):
        for name in ("normal_force", "contact_area", "friction_work"):
            number = pytest.approx(expected.quantities[name], rel=1e-8)
            assert contact.quantities[name] == number, name


def systems(monkeypatch, slaves="on"):
    """The same problem without S and with it, masters eliminated."""
    monkeypatch.setattr(elimination, "_MANY", 0)
    monkeypatch.setattr(elimination, "_ENOUGH", 0)
    scene = on_a_plate((slaves, slaves), 3)
    problem = Problem.on_mesh(scene, boxes(DEEP, "hexahedron"))
    return GluedSystem(problem, Timings(), near_nodes(problem)), CondensedSystem(problem, Timings())


def test_a_product_is_that_with_the_stiffness_written_out(monkeypatch):
    mine, theirs = systems(monkeypatch)
    assert mine.width == theirs.width
    if COMM.rank == 0:
        values = np.random.default_rng(1).normal(size=mine.width)
        expected = theirs.dense_tangent.times(values)
        assert mine.dense_tangent.times(values) == pytest.approx(
            expected, rel=1e-9, abs=1e-9 * np.abs(expected).max()
        )
    mine.destroy()
    theirs.destroy()


def test_what_is_known_of_the_stiffness_is_not_asked_for_again(monkeypatch):
    mine, theirs = systems(monkeypatch)
    if COMM.rank == 0:
        tangent, right = mine.dense_tangent, np.random.default_rng(2).normal(size=mine.width)
        none = np.zeros(0, dtype=np.int64)
        tangent.set((none, none, np.zeros(0)))
        found = tangent.solve(right, 1e-9)
        assert tangent.times(found) == pytest.approx(right, abs=1e-7)
        every = np.arange(mine.width)
        tangent.set((every, every, np.full(mine.width, 1e3)))
        solves = []
        usual = recycled.Directions.add
        monkeypatch.setattr(
            recycled.Directions, "add", lambda own, way: solves.append(way) or usual(own, way)
        )
        first = tangent.solve(right, 1e-9)
        assert tangent.multiply(first) == pytest.approx(right, abs=1e-7)
        assert solves
        solves.clear()
        again = tangent.solve(right, 1e-8)
        assert not solves
        assert again == pytest.approx(first, rel=1e-6, abs=1e-9)
    mine.destroy()
    theirs.destroy()


def test_the_cells_at_both_surfaces_have_all_stiffness_where_they_are_the_bodies(monkeypatch):
    """Jumps that no contact resists: both bodies give way one after the other."""
    monkeypatch.setattr(zone, "_LAYERS", 20)
    monkeypatch.setattr(zone, "_SPRINGS", 0.0)
    mine, theirs = systems(monkeypatch, "against")
    if COMM.rank == 0:
        tangent = mine.dense_tangent.inner
        none = np.zeros(0, dtype=np.int64)
        tangent.set((none, none, np.zeros(0)))
        jumps = np.random.default_rng(5).normal(size=(mine.width, 3))
        forces = np.column_stack([tangent.times(one) for one in jumps.T])
        assert tangent.split.nearly_solved_each(forces) == pytest.approx(jumps, abs=1e-8)
        assert tangent.split.nearly_solved(forces[:, 1]) == pytest.approx(jumps[:, 1], abs=1e-8)
    mine.destroy()
    theirs.destroy()


def test_directions_that_others_say_are_left_out():
    known = recycled.Directions(5, lambda jumps: 2 * jumps)
    first, second, right = np.random.default_rng(6).normal(size=(3, 5))
    for one in (first, second, first - second, first + 1e-12 * second):
        known.add(one)
    solves = []

    def nearly_solved(rest):
        solves.append(rest)
        return rest.copy()

    def product(values, bulk):
        return bulk

    found = recycled.solve(first + 3 * second, 1e-9, known, product, nearly_solved)
    assert not solves
    assert found == pytest.approx(0.5 * (first + 3 * second), abs=1e-12)
    assert recycled.solve(right, 1e-9, known, product, nearly_solved) == pytest.approx(0.5 * right)
    assert len(solves) == 1
    for one in np.random.default_rng(7).normal(size=(6, 5)):  # more than there are unknowns
        known.add(one)
    other = recycled.solve(right[::-1], 1e-9, known, product, nearly_solved)
    assert other == pytest.approx(0.5 * right[::-1])
    with np.errstate(all="ignore"):
        known.add(np.full(5, 1e308) * 10)  # not finite
        last = recycled.solve(right, 1e-9, known, product, nearly_solved)
    assert last == pytest.approx(0.5 * right)


def test_a_search_along_a_step_takes_no_further_products(monkeypatch):
    mine, theirs = systems(monkeypatch)
    if COMM.rank == 0:
        own = mine.body.bulk.of_jumps.own
        first, second = np.random.default_rng(3).normal(size=(2, mine.width))
        own.times(first), own.times(second)
        between = 0.3 * first + 0.7 * second
        expected = own.product(between)
        monkeypatch.setattr(own, "product", None)
        monkeypatch.setattr(own, "_factor", None)
        assert own.times(between) == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    mine.destroy()
    theirs.destroy()


def test_bodies_that_move_together_are_refused():
    problem = Problem.on_mesh(on_a_plate(("on", "on"), support=()), boxes(FLAT))
    with pytest.raises(NotConvergedError, match="singular: is the body held"):
        GluedSystem(problem, Timings(), near_nodes(problem))


def test_it_is_for_what_it_can_solve_alone():
    problem = Problem.on_mesh(on_a_plate(("on", "on")), boxes(FLAT))
    assert is_glueable(problem, near_nodes(problem))
    held_slaves, body = beams(gap=0.0)  # whose jumps are derived
    problem = Problem.on_mesh(held_slaves, body)
    assert not is_glueable(problem, near_nodes(problem))


def test_the_estimate_of_memory_follows(monkeypatch):
    problem = Problem.on_mesh(on_a_plate(("on", "on")), boxes(FLAT))
    monkeypatch.setattr(solver_choice, "_DENSE", {"condensed": 1e9, "full": 0.0, "iterative": 0.0})
    large = memory_terms(problem, "condensed")["dense"]
    monkeypatch.setattr(solver_choice, "_MOST_JUMPS", 0)
    assert memory_terms(problem, "condensed")["dense"] < 1e-3 * large
    assert memory_terms(problem, "condensed", is_kept=True)["dense"] == pytest.approx(large)
