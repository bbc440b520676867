"""More points in contact than dofs: pressures are the limit of those of a penalty."""

import numpy as np
import pytest

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import LocalProblem, PointLaws, solve
from tests.solve.exact.problems import violation

POINTS, NODES = 7, 4
COEFFICIENT = 0.3


class Body:
    """A body with 4 nodes that move in the plane, and 7 points on it with areas of their own.

    A displacement u of the nodes opens the gaps at the points by H_n u, and moves them by H_t u.
    """

    def __init__(self) -> None:
        random = np.random.default_rng(2)
        root = random.normal(size=(2 * NODES, 2 * NODES))
        self.stiffness = root @ root.T + 2 * np.eye(2 * NODES)
        shapes = random.uniform(0, 1, (POINTS, NODES))
        self.across, self.along = np.kron(shapes, [1.0, 0.0]), np.kron(shapes, [0.0, 1.0])
        self.areas = random.uniform(0.5, 1.5, POINTS)
        # Nodes that move by −.1 close all gaps at once, and the load presses on all points.
        self.gap = 0.1 * shapes.sum(axis=1)
        self.load = -self.across.T @ random.uniform(2, 3, POINTS)
        self.slip = 5.0  # against the obstacle, so large that all that touches slips

    def problem(self, coefficient: float) -> LocalProblem:
        rows = np.stack([self.across, self.along], axis=1).reshape(2 * POINTS, -1)
        inverse = np.linalg.inv(self.stiffness)
        free = rows @ inverse @ self.load
        free[::2] += self.gap
        free[1::2] += self.slip
        laws = PointLaws(np.full(POINTS, coefficient))
        return LocalProblem(rows @ inverse @ rows.T, free, laws, self.areas)

    def penalised(self, coefficient: float, penalty: float) -> Array:
        """Forces across by r_n = A/ε₁ max(−gap, 0), from displacements; all that touches slips."""
        closed = np.ones(POINTS, dtype=bool)
        for _ in range(50):
            stiff = closed * self.areas / penalty
            matrix, load = self.stiffness.copy(), self.load.copy()
            # Friction −μ r_n acts against a slip that is positive.
            for row, factor in ((self.across, 1.0), (self.along, -coefficient)):
                matrix += factor * row.T @ (stiff[:, None] * self.across)
                load -= factor * row.T @ (stiff * self.gap)
            moved = np.linalg.solve(matrix, load)
            gap = self.across @ moved + self.gap
            if (closed == (gap < 0)).all():
                return np.asarray(-stiff * gap)
            closed = gap < 0
        raise AssertionError("the penalised problem has no answer")


@pytest.mark.parametrize("coefficient", [0.0, COEFFICIENT])
def test_forces_are_the_limit_of_those_of_a_penalty(coefficient: float) -> None:
    body = Body()
    answer = solve(body.problem(coefficient))
    assert answer.converged
    assert violation(answer) < 1e-9
    across = answer.forces[::2]
    assert np.count_nonzero(across) > NODES  # more than the gaps determine
    penalties = 1e-4 * np.array([1.0, 0.1, 0.01])
    apart = [np.abs(body.penalised(coefficient, one) - across).max() for one in penalties]
    assert apart[2] < 1e-3 * across.max()
    orders = -np.diff(np.log10(apart))
    assert np.allclose(orders, 1.0, atol=0.05)


def test_without_friction_they_are_least_in_the_norm_of_the_areas() -> None:
    """Of all forces that leave the same gaps: Σ r²/A by another method, the pseudo-inverse."""
    body = Body()
    problem = body.problem(0.0)
    answer = solve(problem)
    across = answer.forces[::2]
    touching = across > 0
    block = problem.compliance[::2, ::2][np.ix_(touching, touching)]
    root = np.sqrt(body.areas[touching])
    least = root * (np.linalg.pinv(block * root) @ -problem.free[::2][touching])
    assert np.allclose(across[touching], least, atol=1e-8 * across.max())
    # Equal areas give other forces with the same gaps: which ones counts.
    other = solve(LocalProblem(problem.compliance, problem.free, problem.laws))
    assert np.abs(other.forces[::2] - across).max() > 1e-3 * across.max()
    assert np.allclose(other.gaps, answer.gaps, atol=1e-8)


def test_the_next_answer_is_prepared_for_it() -> None:
    problem = Body().problem(COEFFICIENT)
    first = solve(problem)
    again = solve(problem.with_free(problem.free * 1.01), first.forces)
    assert again.converged
    assert again.steps < first.steps


def test_a_point_that_supports_hold_has_no_force_though_round_off_moves_it() -> None:
    """Its compliance and gap are not quite 0, as differences of long numbers."""
    compliance = np.diag([1.0, 1.0, 1e-29, 1e-29])
    compliance[0, 2] = compliance[2, 0] = 1e-17
    free = np.array([-1.0, 0.0, -3e-17, 1e-18])
    answer = solve(LocalProblem(compliance, free, PointLaws(np.full(2, COEFFICIENT))))
    assert answer.converged
    assert answer.forces[:2] == pytest.approx([1.0, 0.0])
    assert np.abs(answer.forces[2:]).max() <= 1e-15
