"""A block pressed on a rough floor, free to lift at its side: no load moves its edges."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Point, Scene, run
from fenics_contact.body.description import BodyDescription
from fenics_contact.evaluate.contact_areas import Zones, contact_area, cut_areas, stick_area
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.trust.error_estimates.mesh import edge_shift
from fenics_contact.trust.error_estimates.mesh.edge_shift import (
    edges_inside,
    shifted_answers,
    standing,
)
from fenics_contact.trust.error_estimates.solving_again import last_step_again
from tests.scenes import box_body, with_solver

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
# What a reference on a fine mesh knows well; forces along the normal and peaks say less.
ASKED = (
    "friction_force",
    "friction_work",
    "max_slip",
    "strain_energy",
    "external_work",
    "contact_area",
    "displacement_corner",
    "displacement_foot",
    "displacement_inside",
)


def floor(cells, comm=COMM, **changes):
    """Right half of a block 4 × 1, pressed by p = 10 exp(−(x/.3)²) on its top, and its mesh."""
    contact = Contact("y0", obstacle=Obstacle(), friction_coefficient=0.3)
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000, 0.3),),
        symmetry=("x0",),
        load=(Load("y1", pressure=lambda x: 10 * np.exp(-((x[0] / 0.3) ** 2))),),
        contact=(dataclasses.replace(contact, **changes),),
        point=(
            Point("corner", (2.0, 1.0)),
            Point("foot", (2.0, 0.0)),
            Point("inside", (0.25, 0.5)),
        ),
    )
    return scene, box_body((2 * cells, cells), (2.0, 1.0), comm=comm)


def solved(cells, errors, **changes):
    scene, body = floor(cells, **changes)
    return run(with_solver(scene, errors=errors), COMM, body)


@pytest.fixture(scope="module")
def reference():
    return solved(72, "none").quantities


def ratios(cells, reference):
    """Error bar over true error, by quantity."""
    found = solved(cells, "auto")
    return {
        name: found.errors[name]["total"]
        / np.linalg.norm(np.subtract(found.quantities[name], reference[name]))
        for name in ASKED
    }


def test_bars_hold_wherever_the_edge_is_in_its_cell(reference):
    every = []
    for cells in (5, 6, 12):
        found = ratios(cells, reference)
        assert min(found.values()) > 1, (cells, found)
        every += found.values()
    assert np.median(every) < 4


def on_springs(cells, comm=COMM):
    """Right half of a long slab on springs, pressed in its middle, and its mesh."""
    scene, _ = floor(1, comm)
    foundation = Contact("y0", foundation_stiffness=100.0, friction_coefficient=1.0)
    return (
        dataclasses.replace(scene, kinematics="plane stress", contact=(foundation,), point=()),
        box_body((8 * cells, cells), (8.0, 1.0), comm=comm),
    )


def with_load_steps(look, cells, comm=COMM, model=floor, **changes):
    """What a function finds of load steps at their end, with areas as the measure."""
    scene, body = model(cells, comm, **changes)
    problem = Problem(scene, DiscreteBody(BodyDescription.of(scene), body))
    with stepping(problem) as load_steps:
        load_steps.solve()
        return look(load_steps, areas(problem))


def areas(problem):
    def measure(solution):
        (contact,), (state,) = problem.contacts, solution.states
        return {
            (0, "contact_area"): contact_area(Zones(contact, state)),
            (0, "stick_area"): stick_area(Zones(contact, state)),
        }

    return measure


def moved(load_steps, measure):
    """How far both edges get to either side, in pieces, and whether all is there again."""
    problem, solution = load_steps.problem, load_steps.last.solution
    before = measure(solution)
    edges = edges_inside(problem, solution)
    rows = shifted_answers(load_steps, measure, edges)
    pieces = dict(zip(before, cut_areas(problem.contacts[0], solution.states[0]), strict=True))
    span = {key: np.ptp([found[key] for _, found in rows]) / pieces[key] for key in before}
    strong = problem.contacts[0].friction.bound_of(np.ones(1))[0]
    return len(rows), span, strong, problem.disturbance


def test_a_shift_moves_both_edges_by_about_a_piece_to_either_side():
    count, span, strong, disturbance = with_load_steps(moved, 8)
    assert count == 9
    for pieces in span.values():
        assert 0.5 < pieces < 4
    assert strong == pytest.approx(0.3)
    assert disturbance is None


def test_where_half_of_a_large_shift_moves_an_edge_as_far_it_is_made_smaller():
    # The first size moves this edge by so little that it was moved by twelve pieces in all.
    count, span, *_ = with_load_steps(moved, 3, model=on_springs)
    assert count == 9
    assert 0.5 < span[0, "contact_area"] < 4


def weakened(load_steps, measure):
    """Sizes of shifts, if the floor's friction held the body only where it is not less."""
    again = edge_shift.last_step_again

    def held(of, measure, change, **more):
        def tried(problem):
            change(problem)
            of_unit = problem.contacts[0].friction.bound_of(np.ones(1))[0]
            weaker.append(of_unit < 0.3 * (1 - 1e-9))

        weaker = []
        found = again(of, measure, tried, **more)
        return None if weaker[-1] else found

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(edge_shift, "last_step_again", held)
        edges = edges_inside(load_steps.problem, load_steps.last.solution)
        return [size for size, _ in shifted_answers(load_steps, measure, edges)]


def test_where_less_friction_holds_nothing_more_of_it_tells_twice_as_much():
    sizes = with_load_steps(weakened, 8)
    assert sorted(sizes) == pytest.approx(np.arange(9) / 8)


def kinds_standing(load_steps, measure):
    """Areas whose edges half of the load does not move."""
    problem, solution = load_steps.problem, load_steps.last.solution
    half = last_step_again(load_steps, measure, lambda problem: problem.set_time(0.5))
    edges = edges_inside(problem, solution)
    return [edge.area for edge in standing(edges, [measure(solution), half])]


def test_edges_stand_where_all_is_proportional_to_the_load():
    assert with_load_steps(kinds_standing, 8) == ["contact_area", "stick_area"]
    hollow = Obstacle("parabola", radius=500.0)
    assert "contact_area" not in with_load_steps(kinds_standing, 8, obstacle=hollow)


def test_shifts_do_not_depend_on_the_number_of_ranks():
    scene, body = floor(6)
    together = run(scene, COMM, body)
    scene, body = floor(6, MPI.COMM_SELF)
    alone = run(scene, MPI.COMM_SELF, body)
    for name in ASKED:
        expected = alone.errors[name]["mesh"]
        assert together.errors[name]["mesh"] == pytest.approx(expected, rel=1e-5), name


def test_bars_are_in_proportion_to_the_thickness():
    """A thickness far from 1 moves no edge: it changes what is in total, and nothing else."""
    scene, body = floor(6)
    flat = with_solver(dataclasses.replace(scene, kinematics="plane stress"), errors="auto")
    one = run(flat, COMM, body)
    for thickness in (1 / 50, 50.0):
        thick = run(dataclasses.replace(flat, thickness=thickness), COMM, body)
        for name in ("friction_force", "friction_work", "contact_area", "stick_area"):
            expected = thickness * one.errors[name]["total"]
            assert thick.errors[name]["total"] == pytest.approx(expected, rel=1e-3), name
        for name in ("max_slip", "displacement_corner"):
            assert thick.errors[name]["total"] == pytest.approx(one.errors[name]["total"], rel=1e-3)
