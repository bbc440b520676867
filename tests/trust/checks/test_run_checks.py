"""Each check fails on a wrong solution, and passes on the right one."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Check,
    Contact,
    Discretisation,
    Load,
    Material,
    Run,
    Scene,
    Support,
)
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.simulation import verdict
from fenics_contact.solve.load_steps.load_stepper import solve
from fenics_contact.trust.friction_checks import compared_friction, dissipation
from fenics_contact.trust.run_checks import run_checks
from tests.messages import refused
from tests.scenes import box_body, slab
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD


@pytest.fixture(scope="module")
def solved():
    prepared = Run(slab(end_load=300, cells=(32, 4)), COMM)
    return prepared.problem, solve(prepared.problem)


def checks_of(problem, solution):
    problem.displacement.x.array[:] = solution.displacement.ravel()
    forces = BulkForces(problem, solution)
    return run_checks(forces)


def failed(problem, solution):
    return {name for name, check in checks_of(problem, solution).items() if not check.passed}


def with_slipping_points_carrying(factor, problem, solution):
    """The bulk's forces changed so that slipping points need this much of their friction."""
    contact = problem.contacts[0]
    internal = solution.internal_force.copy()
    slipping = np.linalg.norm(solution.states[0].slip, axis=1) > 1e-3
    nodes = contact.nodes[slipping]
    internal[nodes] = problem.load[nodes] + factor * (internal - problem.load)[nodes]
    return with_body(solution, internal_force=internal)


def test_the_right_solution_passes_them_all(solved):
    checks = checks_of(*solved)
    assert set(checks) == {
        "equilibrium",
        "resultant",
        "boundary_stress",
        "friction_cone",
        "friction_law",
        "dissipation",
        "stick_creep",
    }
    assert not failed(*solved)


def test_equilibrium_fails_when_the_bulk_is_out_of_balance(solved):
    """A displacement that is not the solution: its reactions do not balance the loads."""
    problem, solution = solved
    wrong = with_body(solution, internal_force=1.001 * solution.internal_force)
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
    state = dataclasses.replace(solution.states[0], slip=-solution.states[0].slip)
    found = failed(problem, dataclasses.replace(solution, states=[state]))
    assert "dissipation" in found


def test_dissipation_fails_however_far_open_points_move(solved):
    """Beside the motion of one that does not touch, wrong slips must not look like round-off."""
    problem, solution = solved
    (compared,) = compared_friction(BulkForces(problem, solution))
    slip, status, bulk = -compared.slip, compared.status.copy(), compared.bulk.copy()
    bound = compared.bound.copy()
    slip[:1], status[:1], bulk[:1], bound[:1] = 1e9, OPEN, 0.0, 0.0
    wrong = dataclasses.replace(compared, slip=slip, status=status, bulk=bulk, bound=bound)
    assert not dissipation([wrong]).passed
    right = dataclasses.replace(wrong, slip=-slip)
    assert dissipation([right]).passed


def test_boundary_stress_fails_for_another_stress_than_the_resultants(solved):
    """The stress of a slab half as deformed does not carry the same contact forces."""
    problem, solution = solved
    wrong = with_body(solution, displacement=0.5 * solution.displacement)
    assert "boundary_stress" in failed(problem, wrong)


def test_an_unconverged_iterate_fails(solved):
    """The adhesive start itself, taken for an answer."""
    problem, solution = solved
    none = with_body(
        solution,
        displacement=0 * solution.displacement,
        internal_force=0 * solution.internal_force,
    )
    forces = [0 * force for force in solution.friction_force]
    stuck = dataclasses.replace(none, friction_force=forces)
    assert {"equilibrium", "friction_law", "boundary_stress"} <= failed(problem, stuck)


def test_a_value_that_is_not_a_number_fails(solved):
    problem, solution = solved
    wrong = with_body(solution, internal_force=np.nan * solution.internal_force)
    assert {"equilibrium", "friction_cone", "friction_law", "dissipation"} <= failed(problem, wrong)


def test_a_single_value_that_is_not_a_number_fails_on_any_rank(solved):
    """One point of the contact, on the rank that owns it."""
    problem, solution = solved
    contact = problem.contacts[0]
    internal = solution.internal_force.copy()
    middle = np.abs(problem.spaces.coordinates[contact.nodes, 0] - 4) < 1e-6
    assert COMM.allreduce(int(middle[contact.owned_nodes].sum())) == 1
    internal[contact.nodes[middle]] = np.nan
    wrong = with_body(solution, internal_force=internal)
    assert {"friction_cone", "friction_law", "dissipation"} <= failed(problem, wrong)


def two_pads():
    """Two rough pads that share a point of the strip's top."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x1", traction=(30, 0)),),
        contact=(
            Contact("left", pressure=20, friction_coefficient=0.2),
            Contact("right", pressure=30, friction_coefficient=0.4),
        ),
    )
    patches = {"left": ("y1", lambda x: x[0] < 1), "right": ("y1", lambda x: x[0] > 1)}
    return Run(scene, COMM, box_body((16, 4), (2, 0.5), patches=patches))


def test_contacts_that_share_a_point_pass_and_can_fail():
    prepared = two_pads()
    assert prepared.solve().passed
    problem, solution = prepared.problem, prepared.solution
    ones = [
        contact.trace.surface.on_body(contact.trace.at_all_nodes(np.ones(len(contact.nodes))))
        for contact in problem.contacts
    ]
    assert COMM.allreduce(int((ones[0] * ones[1] > 0).sum())) > 0
    friction = [force.copy() for force in solution.friction_force]
    friction[1] *= 0.99
    wrong = dataclasses.replace(solution, friction_force=friction)
    assert "friction_law" in failed(problem, wrong)


@pytest.mark.parametrize("cells", [4, 40])
@pytest.mark.parametrize("degree", [1, 2])
def test_contact_that_supports_hold_along_its_normal(cells, degree):
    """A sheared layer: the supports' normal reaction is in σ n and in K u − f, and is left out."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.25),
        discretisation=Discretisation(degree),
        support=(Support("body", {"y": 0}), Support("y0", {"x": 0.1})),
        contact=(Contact("y1", pressure=20, friction_coefficient=0.4),),
    )
    prepared = Run(scene, COMM, box_body((cells, 2), (2, 0.5)))
    result = prepared.solve()
    assert result.passed
    assert {"friction_cone", "friction_law", "dissipation", "boundary_stress"} <= set(result.checks)
    solution = prepared.solution
    wrong = with_body(solution, internal_force=0.98 * solution.internal_force)
    assert {"friction_law", "equilibrium"} <= failed(prepared.problem, wrong)


def test_contact_that_cannot_slip_is_refused():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.25),
        support=(Support("body", {"x": 0}),),
        contact=(Contact("y1", pressure=20, friction_coefficient=0.4),),
    )
    with refused("nothing_can_slip"):
        Run(scene, COMM, box_body((4, 2), (2, 0.5)))


def test_load_on_the_contact_itself_leaves_boundary_stress_out():
    scene = dataclasses.replace(slab(), load=(*slab().load, Load("top", traction=(-20, 0))))
    result = Run(scene, COMM).solve()
    assert result.passed
    assert "boundary_stress" not in result.checks
    assert "friction_law" in result.checks


def test_a_body_without_stress_fails_on_the_coarsest_mesh():
    prepared = Run(slab(cells=(2, 1), degree=1), COMM)
    prepared.solve()
    problem, solution = prepared.problem, prepared.solution
    none = with_body(
        solution,
        displacement=0 * solution.displacement,
        internal_force=0 * solution.internal_force,
    )
    assert "boundary_stress" in failed(problem, none)


def test_one_check_is_not_all_checks():
    check = Check(value=0.0, limit=1.0)
    assert verdict.of_checks({"a": check}) == "Converged; the one check of the physics passed."
    both = {"a": check, "b": check}
    assert verdict.of_checks(both) == "Converged; all 2 checks of the physics passed."
