"""Derivatives of answers: beside differences, beside small ε, and at edges between statuses."""

from dataclasses import replace

import numpy as np
import pytest

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import LocalProblem, PointLaws, solve
from fenics_contact.solve.exact.derivatives import Linearisation
from tests.solve.exact.problems import half_plane, half_space, pressed
from tests.solve.exact.test_laws import ellipses
from tests.solve.exact.test_singular import Body

STEP = 1e-6


def mixed(body, side: int) -> LocalProblem:
    """Points of several laws, some of which stick and some of which slip."""
    compliance, places = body(side)
    count, size = len(places), len(compliance) // len(places)
    across = np.where(np.arange(count) % 5 == 1, "given", "unilateral")
    laws = PointLaws(
        np.full(count, 0.4),
        across=across,
        given_force=np.full(count, 0.05),
        elastic_slip=np.where(np.arange(count) % 3 == 0, 3e-3, 0.0),
        series_compliance=np.full(count, 1e-3),
        metric=ellipses(count) if size == 3 else None,
        fixed_bound=np.where(np.arange(count) % 7 == 3, 0.02, np.nan),
    )
    return pressed(compliance, places, 0.04, [0.006, -0.003][: size - 1], laws)


def weights(problem: LocalProblem) -> tuple[Array, Array]:
    """A quantity that is linear in forces and gaps."""
    random = np.random.default_rng(1)
    return random.normal(size=(2, len(problem.free)))


def quantity(problem: LocalProblem, start: Array) -> float:
    of_forces, of_gaps = weights(problem)
    answer = solve(problem, start)
    return float(of_forces @ answer.forces + of_gaps @ answer.gaps)


BODIES = pytest.mark.parametrize(("body", "side"), [(half_plane, 20), (half_space, 5)])


@BODIES
def test_the_gradient_is_that_of_differences(body, side: int) -> None:
    problem = mixed(body, side)
    answer = solve(problem)
    assert {"OPEN", "STICK", "SLIP"} == set(answer.statuses)
    found = Linearisation(answer)
    assert found.at_edges == 0
    gradient = found.gradient(*weights(problem))
    random, laws, count = np.random.default_rng(3), problem.laws, problem.points
    by_point, by_row = random.uniform(0, 1, count), random.normal(size=len(problem.free))
    matrix = random.normal(size=problem.compliance.shape) * np.abs(problem.compliance).max()
    elastic = by_point * (laws.elastic_slip > 0)
    given = by_point * (laws.across == "given")
    fixed = by_point * ~np.isnan(laws.fixed_bound)
    across = answer.forces[:: problem.dimension]
    follows = np.isnan(laws.fixed_bound) * np.maximum(across, 0)

    def moved(size: float) -> dict[str, LocalProblem]:
        laws_of = {
            "coefficient": replace(laws, coefficient=laws.coefficient + size * by_point),
            "given": replace(laws, given_force=laws.given_force + size * given),
            "elastic": replace(laws, elastic_slip=laws.elastic_slip + size * elastic),
            "fixed": replace(laws, fixed_bound=laws.fixed_bound + size * fixed),
        }
        found = {name: problem.with_laws(one) for name, one in laws_of.items()}
        found["free"] = problem.with_free(problem.free + 0.01 * size * by_row)
        changed = problem.compliance + size * matrix
        found["compliance"] = LocalProblem(changed, problem.free, laws)
        return found

    expected = {
        "free": 0.01 * gradient.free @ by_row,
        "compliance": gradient.free @ matrix @ answer.forces,
        "coefficient": (gradient.bound * follows) @ by_point,
        "given": gradient.given_force @ by_point,
        "elastic": gradient.elastic_slip @ elastic,
        "fixed": gradient.bound @ fixed,
    }
    up, down = moved(STEP), moved(-STEP)
    for name, value in expected.items():
        difference = quantity(up[name], answer.forces) - quantity(down[name], answer.forces)
        assert value != 0
        assert value == pytest.approx(difference / (2 * STEP), rel=2e-5), name


@BODIES
def test_the_derivative_along_a_change_is_that_of_the_gradient(body, side: int) -> None:
    problem = mixed(body, side)
    found = Linearisation(solve(problem))
    of_forces, _ = weights(problem)
    change = np.random.default_rng(4).normal(size=len(problem.free))
    assert of_forces @ found.along(change) == pytest.approx(
        found.gradient(of_forces).free @ change, rel=1e-9
    )


def test_derivatives_of_small_elastic_slips_approach_it() -> None:
    compliance, places = half_plane(20)
    laws = PointLaws(np.full(20, 0.4))
    problem = pressed(compliance, places, 0.04, 0.006, laws)
    answer = solve(problem)
    exact = Linearisation(answer).gradient(*weights(problem))
    apart = []
    for epsilon in (1e-5, 1e-6, 1e-7):
        smooth = problem.with_laws(replace(laws, elastic_slip=np.full(20, epsilon)))
        gradient = Linearisation(solve(smooth, answer.forces)).gradient(*weights(problem))
        apart.append(np.abs(gradient.free - exact.free).max() / np.abs(exact.free).max())
    assert apart[-1] < 1e-3
    assert np.allclose(-np.diff(np.log10(apart)), 1.0, atol=0.1)


def test_where_w_is_singular_they_are_those_of_differences() -> None:
    body = Body()
    problem = body.problem(0.3)
    answer = solve(problem)
    rows = np.stack([body.across, body.along], axis=1).reshape(len(problem.free), -1)
    change = rows @ np.linalg.solve(body.stiffness, np.arange(8.0))  # by a load of the body
    found = Linearisation(answer)
    along = found.along(change)
    up, down = (solve(problem.with_free(problem.free + s * STEP * change)) for s in (1, -1))
    difference = (up.forces - down.forces) / (2 * STEP)
    assert np.allclose(along, difference, atol=1e-5 * np.abs(difference).max())
    of_forces, _ = weights(problem)
    assert found.gradient(of_forces).free @ change == pytest.approx(of_forces @ along, rel=1e-5)


@pytest.mark.parametrize(
    ("free", "toward", "derivative"),
    [
        # Just touching: pressed in by 1 it has the force 1, drawn back none.
        ((0.0, 0.0), (-1.0, 0.0), (1.0, 0.0)),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 0.0)),
        # Just about to slip, by a slip −.5 without forces under a bound of .5.
        ((-1.0, -0.5), (0.0, -1.0), (0.0, 0.0)),
        ((-1.0, -0.5), (0.0, 1.0), (0.0, -1.0)),
    ],
)
def test_at_an_edge_they_are_one_sided(free, toward, derivative) -> None:
    problem = LocalProblem(np.eye(2), np.array(free), PointLaws(np.array([0.5])))
    answer = solve(problem)
    found = Linearisation(answer, np.array(toward))
    assert found.at_edges == 1
    assert np.allclose(found.along(np.array(toward)), derivative)
    ahead = solve(problem.with_free(problem.free + STEP * np.array(toward)))
    assert np.allclose((ahead.forces - answer.forces) / STEP, derivative, atol=1e-8)
