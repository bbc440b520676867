"""The friction energy against its formula, and its derivatives by Taylor's test."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Contact, Material, Scene, run
from fenics_contact.contact.laws.energies import smoothed_norm
from fenics_contact.problem.problem import Problem
from tests.scenes import PULLED_BLOCK, box_body
from tests.solve.matrices import product

COMM = MPI.COMM_WORLD
EPSILON = 0.1


@pytest.mark.parametrize("slip", [0.0, 1e-9, 0.05, 0.1, 0.100001, 3.0])
def test_smoothed_norm_and_its_slope_follow_the_paper(slip):
    """(2.6) and (2.8): |v|²/(2ε) and v/ε inside, |v| − ε/2 and v/|v| beyond."""
    mesh = box_body((2, 2)).mesh
    vector = fem.Constant(mesh, np.array([0.6, -0.8]) * slip)
    value = smoothed_norm(vector, fem.Constant(mesh, EPSILON))
    slope = ufl.diff(smoothed_norm(v := ufl.variable(vector), fem.Constant(mesh, EPSILON)), v)

    def mean(expression):
        return COMM.allreduce(fem.assemble_scalar(fem.form(expression * ufl.dx(mesh))))

    inside = slip <= EPSILON
    assert mean(value) == pytest.approx(slip**2 / (2 * EPSILON) if inside else slip - EPSILON / 2)
    expected = slip / EPSILON if inside else 1.0
    assert mean(slope[0]) == pytest.approx(0.6 * expected)
    assert mean(slope[1]) == pytest.approx(-0.8 * expected)


def pad(dimension, coefficient=0.4):
    cells = (3, 2, 2)[:dimension]
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(100, 0.3),
        contact=(
            Contact(
                f"{'xyz'[dimension - 1]}0",
                pressure=lambda x: 2 + x[0],
                friction_coefficient=coefficient,
                regularisation_parameter=EPSILON,
            ),
        ),
    )
    return Problem.on_mesh(scene, box_body(cells))


def set_state(problem, x):
    """Stick (|u_T| < ε) on one half, slip on the other, far from the kink at ε."""
    points = problem.contacts[0].trace.surface.coordinates
    state = np.zeros((len(points), problem.contacts[0].trace.surface.components))
    state[:, 0] = np.where(points[:, 0] < 0.4, 0.02, 0.6) + 0.01 * points[:, 1]
    state[:, 1] = np.where(points[:, 0] < 0.4, 0.03, -0.5)
    problem.contacts[0].kinematics.move(
        state + np.reshape(x, (-1, state.shape[1]) if np.ndim(x) else ())
    )
    return state


@pytest.mark.parametrize("dimension", [2, 3])
def test_taylor_residual_and_tangent(dimension):
    """Energy to residual and residual to tangent: remainders of second order."""
    problem = pad(dimension)
    contact = problem.contacts[0]
    forms = contact.friction_term.compiled_forms
    energy, residual = fem.form(forms.energy), forms.residual
    coordinates = problem.contacts[0].trace.surface.coordinates
    direction = np.stack(
        [
            np.sin(3 * coordinates[:, 0] + i)
            for i in range(problem.contacts[0].trace.surface.components)
        ],
        axis=1,
    ).ravel()
    owned = slice(
        0,
        problem.contacts[0].trace.surface.owned_nodes
        * problem.contacts[0].trace.surface.components,
    )

    def evaluate(step):
        set_state(problem, step * direction)
        value = COMM.allreduce(fem.assemble_scalar(energy))
        return value, problem.contacts[0].trace.surface.assemble(residual).ravel()

    value, slope = evaluate(0.0)
    # Where q is the direction of the slip, the primal-dual tangent is Newton's own.
    state = set_state(problem, 0.0)
    contact.friction_term.tangent_state.stick_all()
    contact.kinematics.move(state)
    contact.follow()
    contact.follow()
    matrix = fem.assemble_matrix(contact.friction_term.compiled_forms.tangent)
    matrix.scatter_reverse()
    change = product(matrix, direction)
    work = COMM.allreduce(slope[owned] @ direction[owned])
    steps = (1e-3, 5e-4)
    first, second = [], []
    for step in steps:
        moved, force = evaluate(step)
        first.append(abs(moved - value - step * work))
        difference = (force - slope)[owned] - step * change
        second.append(np.sqrt(COMM.allreduce(difference @ difference)))
    assert np.log2(first[0] / first[1]) == pytest.approx(2, abs=0.05)
    if dimension == 2:  # a slipping line force has one direction: the residual is linear
        assert max(second) < 1e-12
    else:
        assert np.log2(second[0] / second[1]) == pytest.approx(2, abs=0.05)


@pytest.mark.serial
def test_tangent_is_symmetric_and_semidefinite():
    problem = pad(3)
    state = set_state(problem, 0.0)
    contact = problem.contacts[0]
    contact.kinematics.move(state)
    contact.follow()
    contact.follow()
    matrix = fem.assemble_matrix(contact.friction_term.compiled_forms.tangent)
    dense = matrix.to_dense()
    assert np.abs(dense - dense.T).max() < 1e-12 * np.abs(dense).max()
    assert np.linalg.eigvalsh(dense).min() > -1e-10 * np.abs(dense).max()


@pytest.mark.serial
def test_tangent_on_the_way_is_positive():
    """With |q| < 1 the tangent resists every tangential motion, slipping or not."""
    problem = pad(3)
    contact = problem.contacts[0]
    contact.friction_term.tangent_state.stick_all()
    contact.kinematics.move(0.4 * set_state(problem, 0.0))
    contact.follow()
    dense = fem.assemble_matrix(contact.friction_term.compiled_forms.tangent).to_dense()
    tangential = contact.trace.numbers[:, None] * 3 + np.arange(2)
    rows = np.sort(tangential.ravel())
    block = dense[np.ix_(rows, rows)]
    assert np.linalg.eigvalsh(block + block.T).min() > -1e-10


def test_friction_resists_slip_and_ignores_normal_motion():
    problem = pad(3)
    components = problem.contacts[0].trace.surface.components
    residual = problem.contacts[0].friction_term.compiled_forms.residual
    normal_only = np.zeros((len(problem.contacts[0].trace.surface.coordinates), components))
    normal_only[:, 2] = 0.7
    problem.contacts[0].kinematics.move(normal_only)
    assert np.abs(problem.contacts[0].trace.surface.assemble(residual)).max() == 0
    sliding = np.zeros_like(normal_only)
    sliding[:, 0] = 0.7
    problem.contacts[0].kinematics.move(sliding)
    force = -problem.contacts[0].trace.surface.assemble(residual)[
        : problem.contacts[0].trace.surface.owned_nodes
    ]
    total = COMM.allreduce(force.sum(axis=0))
    # ∫ μ (2 + x) over the unit square of the bottom
    assert total == pytest.approx([-0.4 * 2.5, 0, 0], abs=1e-12)


def pulled_block(epsilon):
    contact = dataclasses.replace(PULLED_BLOCK.contact[0], regularisation_parameter=epsilon)
    result = run(dataclasses.replace(PULLED_BLOCK, contact=(contact,)), COMM, box_body((6, 6, 2)))
    return result, result.contacts[0]["parameters"]["regularisation_parameter"]


def test_undecided_points_are_those_whose_status_hangs_on_epsilon():
    """None where ε is small, though many stick with more than half of their bound."""
    fine, epsilon = pulled_block("auto")
    twice, _ = pulled_block(2 * epsilon)
    assert (fine.points.status == twice.points.status).all()
    assert fine.contacts[0]["quantities"]["undecided_points"] == 0
    creep = np.linalg.norm(fine.points.slip, axis=1)
    sticks = fine.points.status == "STICK"
    assert (sticks & (creep > 0.5 * epsilon)).sum() > 5
    # creep follows ε: the share of the bound that a point carries does not
    assert np.linalg.norm(twice.points.slip, axis=1)[sticks] == pytest.approx(
        2 * creep[sticks], rel=1e-2
    )
    coarse, twice = pulled_block(8000 * epsilon)[0], pulled_block(16000 * epsilon)[0]
    slips = coarse.points.status == "SLIP"
    near = slips & (np.linalg.norm(coarse.points.slip, axis=1) < 16000 * epsilon)
    assert coarse.contacts[0]["quantities"]["undecided_points"] == near.sum()
    changed = coarse.points.status != twice.points.status
    assert near[changed].all()
    assert changed.sum() > 0.5 * near.sum() > 0
