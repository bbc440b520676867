"""Each check fails on a wrong solution, and passes on the right one."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.checks import run_checks
from fenics_contact.parallel import largest
from fenics_contact.quantities import support_reactions
from fenics_contact.solver import solve
from tests.scenes import slab

COMM = MPI.COMM_WORLD


@pytest.fixture(scope="module")
def solved():
    prepared = Run(slab(end_load=300, cells=(32, 4)), COMM)
    return prepared.problem, solve(prepared.problem)


def checks_of(problem, solution):
    problem.displacement.x.array[:] = solution.displacement.ravel()
    reactions, _ = support_reactions(problem, solution)
    return run_checks(problem, solution, reactions)


def failed(problem, solution):
    return {name for name, check in checks_of(problem, solution).items() if not check.passed}


def with_slipping_points_carrying(factor, problem, solution):
    """The bulk's forces changed so that slipping points need this much of their friction."""
    contact = problem.contacts[0]
    internal = solution.internal_force.copy()
    slipping = np.linalg.norm(contact.slip(solution.displacement), axis=1) > 1e-3
    nodes = contact.nodes[slipping]
    internal[nodes] = problem.load[nodes] + factor * (internal - problem.load)[nodes]
    return dataclasses.replace(solution, internal_force=internal)


def test_the_right_solution_passes_them_all(solved):
    checks = checks_of(*solved)
    assert set(checks) == {
        "equilibrium",
        "boundary_stress",
        "friction_cone",
        "friction_law",
        "dissipation",
    }
    assert not failed(*solved)


def test_equilibrium_fails_when_the_bulk_is_out_of_balance(solved):
    """A displacement that is not the solution: its reactions do not balance the loads."""
    problem, solution = solved
    wrong = dataclasses.replace(solution, internal_force=1.001 * solution.internal_force)
    assert "equilibrium" in failed(problem, wrong)


def test_equilibrium_fails_when_friction_is_left_out(solved):
    problem, solution = solved
    wrong = dataclasses.replace(
        solution, friction_force=[0 * force for force in solution.friction_force]
    )
    found = failed(problem, wrong)
    assert {"equilibrium", "friction_law"} <= found


def test_friction_cone_fails_when_a_point_carries_more_than_its_bound(solved):
    problem, solution = solved
    found = failed(problem, with_slipping_points_carrying(1.01, problem, solution))
    assert {"friction_cone", "friction_law"} <= found


def test_friction_law_fails_when_a_slipping_point_carries_less(solved):
    problem, solution = solved
    found = failed(problem, with_slipping_points_carrying(0.99, problem, solution))
    assert "friction_law" in found
    assert "friction_cone" not in found


def test_dissipation_fails_when_friction_pushes_along_the_slip(solved):
    problem, solution = solved
    contact = problem.contacts[0]
    displacement = solution.displacement.copy()
    displacement[contact.nodes, 0] *= -1
    found = failed(problem, dataclasses.replace(solution, displacement=displacement))
    assert "dissipation" in found


def test_boundary_stress_fails_for_another_stress_than_the_resultants(solved):
    """The stress of a slab half as deformed does not carry the same contact forces."""
    problem, solution = solved
    wrong = dataclasses.replace(solution, displacement=0.5 * solution.displacement)
    assert "boundary_stress" in failed(problem, wrong)


def test_an_unconverged_iterate_fails(solved):
    """The adhesive start itself, taken for an answer."""
    problem, solution = solved
    stuck = dataclasses.replace(
        solution,
        displacement=0 * solution.displacement,
        internal_force=0 * solution.internal_force,
        friction_force=[0 * force for force in solution.friction_force],
    )
    assert {"equilibrium", "friction_law", "boundary_stress"} <= failed(problem, stuck)


def test_a_value_that_is_not_a_number_fails(solved):
    problem, solution = solved
    wrong = dataclasses.replace(solution, internal_force=np.nan * solution.internal_force)
    assert "equilibrium" in failed(problem, wrong)
    assert largest(COMM, np.zeros(0)) == 0
