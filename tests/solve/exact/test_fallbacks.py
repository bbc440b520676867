"""What helps where Newton's method fails from the adhesive start."""

import numpy as np
import pytest

from fenics_contact.solve.exact import LocalProblem, PointLaws, solve
from fenics_contact.solve.exact.continuation import adhesion_first, follow, no_friction_first
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.newton import newton
from tests.solve.exact.problems import half_plane, pressed, violation


def at_random(points: int, size: int, seed: int) -> LocalProblem:
    random = np.random.default_rng(seed)
    root = random.normal(size=(size * points, size * points + 2))
    laws = PointLaws(np.full(points, 10 ** random.uniform(-2, 0.8)))
    return LocalProblem(root @ root.T, random.normal(size=size * points), laws)


@pytest.mark.parametrize(("points", "size"), [(20, 2), (10, 3)])
def test_strongly_coupled_points_have_answers(points: int, size: int) -> None:
    answers = [solve(at_random(points, size, seed)) for seed in range(40)]
    assert all(answer.converged for answer in answers)
    assert max(map(violation, answers)) < 1e-9
    assert any("adhesive" not in answer.way for answer in answers)


@pytest.mark.parametrize("factor", [no_friction_first, adhesion_first])
def test_a_path_leads_to_the_answer(factor) -> None:
    compliance, places = half_plane(30)
    problem = pressed(compliance, places, 0.02, 0.005, PointLaws(np.full(30, 0.4)))
    equations = NaturalMap(problem)
    run, steps = follow(equations, factor, newton)
    assert run is not None and run.converged
    assert steps > run.steps
    expected = solve(problem).state.forces
    assert np.allclose(run.state.forces, expected, atol=1e-10 * expected.max())


def test_without_an_answer_the_best_state_is_told() -> None:
    """A force that draws the obstacle away cannot be balanced by contact."""
    compliance, places = half_plane(6)
    laws = PointLaws(np.full(6, 0.4))
    problem = pressed(compliance, places, 0.0, 0.0, laws)
    whole = np.zeros((13, 13))
    whole[:12, :12] = compliance
    whole[:12:2, 12] = whole[12, :12:2] = -1.0
    answer = solve(LocalProblem(whole, np.append(problem.free, -1.0), laws, scalars=1))
    assert not answer.converged
    assert answer.residual > 1e-3
