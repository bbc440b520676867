"""The exact solver on problems from arrays: its answers satisfy the laws, in few steps."""

import numpy as np
import pytest
from scipy.optimize import nnls

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import LocalProblem, PointLaws, solve
from tests.solve.exact.problems import half_plane, half_space, one_point, pressed, violation

ROUNDING = 1e-11


@pytest.mark.parametrize(
    ("start", "status", "forces"),
    [
        ((0.0, 0.0), "OPEN", (0.0, 0.0)),
        ((0.5, 0.6), "STICK", (0.5, 0.6)),
        # The obstacle's force .2 and friction 1.5 · .2 = .3, against the slip.
        ((0.2, 0.3), "SLIP", (0.2, 0.3)),
    ],
)
def test_a_point_with_three_answers(start: Array, status: str, forces: Array) -> None:
    answer = solve(one_point(1.5), np.array(start))
    assert answer.converged
    assert list(answer.statuses) == [status]
    assert np.allclose(answer.forces, forces, atol=1e-14)
    assert violation(answer) < 1e-14


def test_a_wrong_answer_violates_the_laws() -> None:
    """The measure that the other tests judge by notices each law."""
    answer = solve(one_point(1.5), np.array([0.5, 0.6]))
    for wrong in ([0.5, -0.6], [-0.5, 0.6], [0.5, 0.9], [0.6, 0.6]):
        answer.__dict__["forces"] = np.array(wrong)
        assert violation(answer) > 0.01


def scenes(number: int, compliance: Array, places: Array, seed: int) -> list[LocalProblem]:
    """Paraboloids pressed in at random, with coefficients of .01 to 6."""
    random, found = np.random.default_rng(seed), []
    points = len(places)
    size = len(compliance) // points
    for _ in range(number):
        laws = PointLaws(np.full(points, 10 ** random.uniform(-2, 0.8)))
        aside = random.uniform(-0.03, 0.03, size - 1) * random.choice([0.05, 0.3, 1])
        depth = random.uniform(0.001, 0.03)
        found.append(pressed(compliance, places, depth, aside, laws))
    return found


@pytest.mark.parametrize(("body", "points", "number"), [(half_plane, 60, 100), (half_space, 8, 40)])
def test_scenes_at_random_have_answers_in_few_steps(body, points, number) -> None:
    answers = [solve(one) for one in scenes(number, *body(points), seed=5)]
    assert all(answer.converged for answer in answers)
    assert max(answer.residual for answer in answers) < ROUNDING
    assert max(map(violation, answers)) < 1e-10
    steps = [answer.steps + answer.sweeps for answer in answers]
    assert np.median(steps) <= 8
    assert np.percentile(steps, 95) <= 12


def test_without_friction_it_is_the_quadratic_programme() -> None:
    """Of the force across alone: least ½ rᵀWr + qᵀr with r ≥ 0, by another method."""
    compliance, places = half_plane(40)
    laws = PointLaws(np.ones(40), along=np.full(40, "none"))
    problem = pressed(compliance, places, 0.02, 0.01, laws)
    answer = solve(problem)
    across = compliance[::2, ::2]
    root = np.linalg.cholesky((across + across.T) / 2)
    expected = nnls(root.T, -np.linalg.solve(root, problem.free[::2]))[0]
    assert np.allclose(answer.forces[::2], expected, rtol=1e-6, atol=1e-9 * expected.max())
    assert not answer.forces[1::2].any()


def test_a_start_nearby_takes_fewer_steps() -> None:
    compliance, places = half_plane(60)
    problem = pressed(compliance, places, 0.02, 0.004, PointLaws(np.full(60, 0.3)))
    answer = solve(problem)
    lower = problem.free.copy()
    lower[::2] -= 2e-4
    warm, cold = solve(problem.with_free(lower), answer.forces), solve(problem.with_free(lower))
    assert warm.steps < cold.steps
    assert np.allclose(warm.forces, cold.forces, atol=1e-12 * cold.forces.max())
    stronger = problem.with_laws(PointLaws(np.full(60, 0.303)))
    assert solve(stronger, answer.forces).steps < cold.steps


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_obstacle_driven_by_a_force_goes_as_deep_as_that_needs(sign: float) -> None:
    """Its position is a row of scalars; prescribed at what was found, it needs that force."""
    compliance, places = half_plane(40)
    laws = PointLaws(np.full(40, 0.4))
    problem = pressed(compliance, places, 0.0, 0.003, laws)
    force = 3.0
    whole = np.zeros((81, 81))
    whole[:80, :80] = compliance
    whole[:80:2, 80] = -1.0  # the position moves the obstacle into the body
    whole[80, :80:2] = sign  # the forces are in balance with the given one
    driven = LocalProblem(whole, np.append(problem.free, -sign * force), laws, scalars=1)
    answer = solve(driven)
    assert answer.converged
    position = answer.forces[-1]
    assert answer.forces[:80:2].sum() == pytest.approx(force, rel=1e-11)
    at_rest = solve(pressed(compliance, places, position, 0.003, laws))
    assert np.allclose(answer.forces[:80], at_rest.forces, atol=1e-10 * force)


def test_shapes_that_do_not_fit_are_refused() -> None:
    laws = PointLaws(np.array([0.3]))
    with pytest.raises(ValueError, match="shape"):
        LocalProblem(np.eye(3), np.zeros(2), laws)
    with pytest.raises(ValueError, match="do not fit"):
        LocalProblem(np.eye(5), np.zeros(5), laws)
    with pytest.raises(ValueError, match="known are"):
        LocalProblem(np.eye(2), np.zeros(2), PointLaws(np.ones(1), along=np.array(["glued"])))
