"""Checks of one-sided contact: the right solution passes, each wrong one fails its check."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Obstacle, Run, Scene, Support
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.solve.load_steps.load_stepper import solve
from tests.scenes import box_body
from tests.trust.checks.test_run_checks import checks_of, failed
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD


@pytest.fixture(scope="module")
def solved():
    """A parabola pressed into a block on its base."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y1", obstacle=Obstacle("parabola", radius=2, position=(0.5, 1), indentation=0.03)
            ),
        ),
    )
    prepared = Run(scene, COMM, box_body((24, 16), (1, 1)))
    return prepared.problem, solve(prepared.problem)


def with_state(solution, **arrays):
    return dataclasses.replace(solution, states=[dataclasses.replace(solution.states[0], **arrays)])


def pulling(problem, solution, where, factor):
    """The bulk's forces changed so that some of the contact's nodes need other ones."""
    internal = solution.internal_force.copy()
    nodes = problem.contacts[0].nodes[where]
    peak = solution.states[0].contact_pressure.max(initial=0.0)
    peak = COMM.allreduce(peak, op=MPI.MAX)
    internal[nodes, 1] += factor * peak * problem.contacts[0].trace.weights[where]
    return with_body(solution, internal_force=internal)


def test_the_right_solution_passes_them_all(solved):
    assert set(checks_of(*solved)) == {
        "equilibrium",
        "boundary_stress",
        "unseen_contact",
        "contact_law",
        "complementarity",
        "tension",
        "penetration",
        "penetration_depth",
        "pressure_recovery",
    }
    assert not failed(*solved)


def test_contact_law_fails_when_penalty_and_bulk_disagree(solved):
    problem, solution = solved
    wrong = dataclasses.replace(
        solution, normal_force=[1.001 * force for force in solution.normal_force]
    )
    assert {"contact_law", "equilibrium"} <= failed(problem, wrong)


def test_tension_fails_when_the_bulk_needs_to_be_pulled(solved):
    problem, solution = solved
    is_open = solution.states[0].status == "OPEN"
    found = failed(problem, pulling(problem, solution, is_open, 0.01))
    assert {"tension", "complementarity"} <= found


def test_complementarity_fails_for_pressure_across_a_gap(solved):
    problem, solution = solved
    is_open = solution.states[0].status == "OPEN"
    found = failed(problem, pulling(problem, solution, is_open, -0.01))
    assert "complementarity" in found
    assert "tension" not in found


def test_penetration_fails_for_a_penalty_as_soft_as_the_body(solved):
    problem, solution = solved
    energy = 1e4 * solution.states[0].penalty_energy
    assert failed(problem, with_state(solution, penalty_energy=energy)) == {"penetration"}


def test_pressure_recovery_fails_for_other_pressures_of_the_same_resultant(solved):
    """All the force moved to half of the points."""
    problem, solution = solved
    points = problem.contacts[0].trace.coordinates[:, 0]
    pressure = np.where(points < 0.5, 2.0, 0.0) * solution.states[0].contact_pressure
    assert "pressure_recovery" in failed(problem, with_state(solution, contact_pressure=pressure))


def test_not_a_number_fails(solved):
    problem, solution = solved
    wrong = with_body(solution, internal_force=np.nan * solution.internal_force)
    assert {"equilibrium", "contact_law"} <= failed(problem, wrong)


def test_reaction_pressure_carries_the_force_and_nothing_else(solved):
    """Its integral is the contact's force, though it knows nothing of the penalty."""
    problem, solution = solved
    contact = problem.contacts[0]
    nodal = BulkForces(problem, solution).pressure(0)
    force = contact.trace.integral(contact.trace.at_points(nodal))
    given = contact.trace.integral(solution.states[0].contact_pressure)
    assert force == pytest.approx(given, rel=1e-9)
    # Linear in the forces: a block under uniform pressure has it exactly.
    everywhere = COMM.allreduce(np.abs(nodal).max(initial=0.0), op=MPI.MAX)
    assert everywhere < 1.2 * COMM.allreduce(
        solution.states[0].contact_pressure.max(initial=0.0), op=MPI.MAX
    )
