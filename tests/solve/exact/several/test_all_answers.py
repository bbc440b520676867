"""All answers of small problems: beside a search through all statuses, without any pruning."""

import itertools

import numpy as np
import pytest

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import LocalProblem, PointLaws
from fenics_contact.solve.exact.several.all_answers import all_answers
from fenics_contact.solve.exact.several.uniqueness import surely_unique_up_to
from tests.solve.exact.problems import half_plane, half_space, one_point, pressed, violation

NEAR = 1e-10


def by_all_statuses(problem: LocalProblem) -> list[Array]:
    """Answers in the plane, from all combinations of open, stick and slip both ways."""
    found: list[Array] = []
    for ways in itertools.product(range(4), repeat=problem.points):
        forces = with_statuses(problem, ways)
        known = forces is None or any(np.abs(one - forces).max() < 1e-8 for one in found)
        if not known:
            found.append(forces)
    return found


def with_statuses(problem: LocalProblem, ways: tuple[int, ...]) -> Array | None:
    """Forces of an answer with given statuses; None where there is none."""
    compliance, free, coefficient = problem.compliance, problem.free, problem.laws.coefficient
    matrix, right = np.eye(len(free)), np.zeros(len(free))
    for point, way in enumerate(ways):
        across, along = 2 * point, 2 * point + 1
        if way > 0:
            matrix[across], right[across] = compliance[across], -free[across]
        if way == 1:
            matrix[along], right[along] = compliance[along], -free[along]
        if way > 1:  # slips by a positive slip (2) or a negative one (3)
            matrix[along, across] = coefficient[point] * (1 if way == 2 else -1)
    if np.linalg.cond(matrix) > 1e12:
        return None
    forces = np.linalg.solve(matrix, right)
    left = compliance @ forces + free
    bound = coefficient * forces[::2]
    signs = np.array([{2: 1.0, 3: -1.0}.get(way, 0.0) for way in ways])
    holds = min(forces[::2].min(), left[::2].min(), (signs * left[1::2]).min())
    within = (bound - np.abs(forces[1::2])).min()
    return forces if min(holds, within) > -NEAR else None


def at_random(points: int, number: int, seed: int, size: int = 2) -> list[LocalProblem]:
    """Positive definite W, and coefficients so large that some have several answers."""
    random, found = np.random.default_rng(seed), []
    for _ in range(number):
        root = random.normal(size=(size * points, size * points + 1))
        laws = PointLaws(random.uniform(0.5, 5, points))
        free = random.normal(size=size * points)
        found.append(LocalProblem(root @ root.T, free, laws))
    return found


@pytest.mark.parametrize(("points", "seed"), [(1, 22), (2, 21), (3, 20)])
def test_in_the_plane_none_is_missed(points: int, seed: int) -> None:
    counts = set()
    for problem in at_random(points, 12, seed):
        expected = by_all_statuses(problem)
        found = all_answers(problem)
        assert found.complete
        assert len(found.answers) == len(expected)
        for answer in found.answers:
            assert answer.converged
            assert violation(answer) < 1e-9
            assert min(np.abs(answer.forces - one).max() for one in expected) < 1e-8
        counts.add(len(expected))
        if surely_unique_up_to(problem) > 1:
            assert len(expected) == 1
    assert counts == {1, 3}


@pytest.mark.parametrize(("coefficient", "number"), [(0.9, 1), (0.99, 1), (1.1, 1), (1.5, 3)])
def test_of_one_point(coefficient: float, number: int) -> None:
    """One answer is sure for μ |K_nt| < K_tt, that is, μ < 1, and there are three for 1.5."""
    problem = one_point(coefficient)
    found = all_answers(problem)
    assert found.complete
    assert len(found.answers) == number
    forces = sorted(answer.forces[0] for answer in found.answers)
    assert np.allclose(forces, [0.0, 0.2, 0.5][:number])
    assert coefficient * surely_unique_up_to(problem) == pytest.approx(1.0, abs=1e-3)


def test_of_many_points_the_energy_rules_out_most() -> None:
    """20 points of which 6 touch: 8 may, and one answer is all there is."""
    compliance, places = half_plane(20)
    problem = pressed(compliance, places, 0.04, 0.004, PointLaws(np.full(20, 0.6)))
    found = all_answers(problem)
    assert found.complete
    assert "points that may touch" in found.way
    assert len(found.answers) == 1
    assert surely_unique_up_to(problem) < 1


def test_one_answer_is_sure_at_small_coefficients() -> None:
    compliance, places = half_space(5)
    problem = pressed(compliance, places, 0.04, [0.004, 0.002], PointLaws(np.full(25, 0.1)))
    assert surely_unique_up_to(problem) > 1
    found = all_answers(problem)
    assert found.complete
    assert len(found.answers) == 1
    frictionless = problem.with_laws(PointLaws(np.zeros(25)))
    assert surely_unique_up_to(frictionless) == np.inf


def test_in_space_there_may_be_others() -> None:
    """The point with three answers, beside a direction of slip that nothing acts in."""
    plane = one_point(1.5)
    compliance = np.eye(3)
    compliance[:2, :2] = plane.compliance
    problem = LocalProblem(compliance, np.append(plane.free, 0.0), plane.laws)
    found = all_answers(problem)
    assert not found.complete
    assert "there may be others" in found.way
    assert np.allclose(sorted(one.forces[0] for one in found.answers), [0.0, 0.2, 0.5])


def test_of_too_many_points_starts_are_tried() -> None:
    """40 points that are not in the plane of the obstacle, under a bound that is no line."""
    compliance, places = half_plane(40)
    laws = PointLaws(np.full(40, 0.6), bound=lambda r: (0.6 * r / (1 + r), 0.6 / (1 + r) ** 2))
    found = all_answers(pressed(compliance, places, 0.02, 0.004, laws))
    assert not found.complete
    assert "24 starts" in found.way
    assert len(found.answers) == 1
