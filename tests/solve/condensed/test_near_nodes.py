"""Nodes that cannot touch are left out of the condensed problem, and come back where they close."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Load, Material, Run, Scene, Steps, Support
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.contact.contact_forces import ContactForces
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.description import words_on_contact_dofs
from fenics_contact.solve.condensed import elimination
from fenics_contact.solve.condensed.constant_tangent import OfSchur
from fenics_contact.solve.condensed.elimination import ReducedSchur
from fenics_contact.solve.load_steps.step_tries import StepTries
from fenics_contact.solve.near_system import NearSystem
from fenics_contact.solve.solver_choice import SolverChoice
from fenics_contact.solve.systems import near_nodes
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import with_solver
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.solve.condensed.test_shared_surfaces import DEEP, FLAT, on_a_plate
from tests.solve.same_answer import require_same, solved

COMM = MPI.COMM_WORLD
GAP = 0.05


@pytest.fixture
def of_few(monkeypatch):
    """Leave out nodes, and eliminate unknowns, of however few there are."""
    monkeypatch.setattr(near_nodes, "_FEW", 0)
    monkeypatch.setattr(elimination, "_MANY", 0)
    monkeypatch.setattr(elimination, "_ENOUGH", 0)


def beams(dimension=2, pressure=1.0, gap=GAP, **changes):
    """A beam, clamped at one end, that is pressed towards another one."""
    ends = dict.fromkeys("xyz"[:dimension], 0)
    deep = dimension == 3
    near, far = ((0,), (0.5,)) if deep else ((), ())
    top = 0.4 + gap
    body = boxes(
        (
            Box("low", (0, 0, *near), (3, 0.4, *far), (8, 1, 1) if deep else (12, 2)),
            Box("high", (0, top, *near), (3, top + 0.4, *far), (9, 1, 1) if deep else (13, 2)),
        ),
        "hexahedron" if deep else "quadrilateral",
    )
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        support=(Support("low.y0", ends), Support("high.x0", ends)),
        load=(Load("high.y1", pressure=pressure),),
        contact=(Contact("high.y0", against="low.y1", name="face", friction_coefficient=0.3),),
    )
    return dataclasses.replace(scene, **changes), body


def near_of(scene, body):
    return near_nodes.near_nodes(Problem.on_mesh(scene, body))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(("dimension", "shapes"), [(2, FLAT), (3, DEEP)])
def test_the_answer_is_that_of_all_nodes(of_few, dimension, shapes, degree):
    scene = on_a_plate(("on", "on"), dimension, discretisation=Discretisation(degree=degree))
    body = boxes(shapes, "hexahedron") if dimension == 3 else boxes(shapes)
    assert all(near is not None and not near.slaves.all() for near in near_of(scene, body))
    require_same(scene, body)


def test_bodies_that_slide_are_paired_anew(of_few):
    scene = on_a_plate(("on", "on"), steps=Steps(number=3))
    contacts = tuple(dataclasses.replace(c, law="incremental") for c in scene.contact)
    require_same(dataclasses.replace(scene, contact=contacts), boxes(FLAT))


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_closes_comes_back(of_few, dimension):
    scene, body = beams(dimension)
    assert not near_of(scene, body)[0].slaves.any()
    made = require_same(scene, body)
    assert made.solution.factorisations > 1
    pressed = (made.solution.states[0].contact_pressure > 0).sum()
    assert COMM.allreduce(int(pressed)) > 0


def test_it_comes_back_in_a_later_load_step(of_few):
    scene, body = beams(pressure=0.1, steps=Steps(number=4))
    contact = dataclasses.replace(scene.contact[0], law="incremental")
    scene = dataclasses.replace(scene, contact=(contact,))
    require_same(scene, body)
    _, result = solved(scene, body, "condensed")
    closed = [step["quantities"]["contact_area"] > 0 for step in result.steps]
    assert closed == sorted(closed)
    assert closed[0] != closed[-1]


@pytest.mark.serial
def test_what_another_run_found_closed_is_taken_up(of_few, tmp_path):
    """A run that is resumed has the contact dofs that closed before it was stopped."""
    scene, body = beams(steps=Steps(number=2))
    contact = dataclasses.replace(scene.contact[0], law="incremental")
    scene = with_solver(dataclasses.replace(scene, contact=(contact,)), solver="condensed")
    whole = Run(scene, COMM, body).solve()
    stopped_after(scene, body, tmp_path, 1)
    found = resumed(scene, body, tmp_path)
    assert len(found.steps) == 2
    for step, other in zip(found.steps, whole.steps, strict=True):
        for name in ("normal_force", "contact_area", "strain_energy"):
            expected = pytest.approx(other["quantities"][name], rel=1e-8)
            assert step["quantities"][name] == expected, name
    assert found.passed


def test_an_answer_that_is_not_asked_for_what_closed_is_wrong(of_few, monkeypatch):
    """What ``take_in_closed`` mends is there, and the checks see it."""
    scene, body = beams()
    monkeypatch.setattr(NearSystem, "take_in_closed", lambda system: False)
    assert not Run(with_solver(scene, solver="condensed"), COMM, body).solve().passed


@pytest.mark.parametrize("is_apart", [True, False], ids=["apart", "touching"])
def test_a_step_that_failed_is_tried_again_if_points_were_left_out(of_few, monkeypatch, is_apart):
    """Masters that nothing faces are left out of both: to take these in would change nothing."""
    scene, body = beams()
    if not is_apart:
        shapes = Box("low", (0, 0), (3, 0.4), (12, 2)), Box("high", (1, 0.4), (2, 0.8), (5, 2))
        body = boxes(shapes, "quadrilateral")
    (near,) = near_of(scene, body)
    assert not near.masters.all()
    assert near.slaves.all() != is_apart
    tries, condensed = [], []

    def failing(step_tries, time):
        tries.append(time)
        raise NotConvergedError("on purpose")

    condense = NearSystem._condense
    monkeypatch.setattr(StepTries, "_try_once", failing)
    monkeypatch.setattr(
        NearSystem, "_condense", lambda system: condensed.append(1) or condense(system)
    )
    assert not Run(with_solver(scene, solver="condensed"), COMM, body).solve().converged
    assert len(tries) == len(condensed) == (2 if is_apart else 1)


def test_a_contact_that_stays_open_has_no_contact_dofs(of_few):
    scene, body = beams(pressure=0.001)
    problem = Problem.on_mesh(scene, body)
    near = near_nodes.near_nodes(problem)[0]
    assert not near.slaves.any()
    assert not near.masters.any()
    made, result = solved(scene, body, "condensed")
    assert made.solution.factorisations == 1
    assert result.quantities["normal_force"] == 0


@pytest.mark.parametrize(("pressure", "closes"), [(0.001, False), (1.0, True)])
def test_a_contact_that_cannot_touch_is_passed_over(of_few, monkeypatch, pressure, closes):
    """Until it closes: its forces are asked for then, and the answer is that of all nodes."""
    scene, body = beams(pressure=pressure)
    asked, idle = [], []
    every, balance = ContactForces.all, NearSystem.balance
    monkeypatch.setattr(ContactForces, "all", lambda own: asked.append(1) or every(own))
    monkeypatch.setattr(
        NearSystem, "balance", lambda own, *of: idle.append(own.idle) or balance(own, *of)
    )
    solved(scene, body, "condensed")
    assert idle[0] == frozenset({0})
    assert (idle[-1] == frozenset()) == closes
    assert len(asked) == idle.count(frozenset())
    require_same(scene, body)


def test_check_says_what_each_contact_makes_of_the_contact_dofs(of_few):
    """Also of one that is left out; shares of the others add up; other solvers have none."""
    scene, body = beams(pressure=0.001)
    problem = Problem.on_mesh(scene, body)
    choice = SolverChoice("condensed", "", 0.0)
    nodes = sum(surface.dofs.size for surface in problem.contacts[0].sides.surfaces)
    (words,) = words_on_contact_dofs(problem, choice)
    assert f"open by {GAP:g} or more; its {nodes} displacements are left out" in words
    assert words_on_contact_dofs(problem, SolverChoice("full", "", 0.0)) == []
    near = Problem.on_mesh(on_a_plate(("on", "on")), boxes(FLAT))
    shares = [line.split("condensed onto, ")[1] for line in words_on_contact_dofs(near, choice)]
    assert sum(float(share.split()[0]) for share in shares) == pytest.approx(100, abs=1)


def test_few_contact_dofs_all_take_part():
    scene, body = beams()
    assert near_of(scene, body) == [None]


def symmetric(count, random):
    rows = random.normal(size=(count, count + 3))
    return rows @ rows.T + count * np.eye(count)


def test_unknowns_without_contact_are_eliminated(of_few):
    """All that is asked of what is left, by dense matrices written out."""
    random = np.random.default_rng(3)
    schur, kept = symmetric(30, random), random.random(30) < 0.4
    reduced = ReducedSchur.of(OfSchur(schur.copy()), kept)
    assert isinstance(reduced, ReducedSchur)
    added, forces = np.zeros((30, 30)), random.normal(size=30)
    places = np.flatnonzero(kept)
    added[np.ix_(places, places)] = random.normal(size=(len(places),) * 2)
    close = {"rtol": 1e-9, "atol": 1e-9 * np.abs(schur).max()}
    carried = reduced.carried(forces)
    own = np.linalg.solve(
        reduced.own.matrix + added[np.ix_(places, places)], reduced.onto_kept(forces, carried)
    )
    every = reduced.every(own, carried)
    np.testing.assert_allclose((schur + added) @ every, forces, **close)
    np.testing.assert_allclose(reduced.written(), schur, **close)
    np.testing.assert_allclose(reduced.times(forces), schur @ forces, **close)


def test_bodies_that_move_freely_when_glued_are_not_eliminated(of_few):
    random = np.random.default_rng(3)
    schur = symmetric(12, random)
    schur[5:, 5:] = np.outer(schur[5, 5:], schur[5, 5:])  # of rank 1
    given = OfSchur(schur)
    assert ReducedSchur.of(given, np.arange(12) < 5) is given
