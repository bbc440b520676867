"""Each law of the points: answers satisfy it, beside neighbours with Coulomb's law."""

from collections.abc import Callable

import numpy as np
import pytest

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact import PointLaws, solve
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.sweeps import Sweeps
from tests.solve.exact.problems import half_plane, half_space, pressed, violation

COEFFICIENT = 0.4


def half(points: int, first: str, second: str) -> Array:
    """One word for every second point, another one for the others."""
    return np.where(np.arange(points) % 2 == 0, first, second)


def saturating(force: Array) -> tuple[Array, Array]:
    """A bound that does not grow beyond .1, and its slope."""
    return COEFFICIENT * force / (1 + 4 * force), COEFFICIENT / (1 + 4 * force) ** 2


def ellipses(points: int) -> Array:
    """M with a ratio of 2, turned from point to point."""
    angles = np.linspace(0, np.pi, points)
    turn = np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]])
    turn = turn.transpose(2, 0, 1)
    return np.einsum("pij,j,pkj->pik", turn, [1.0, 0.5], turn)


LAWS: dict[str, Callable[[int], dict]] = {
    "no friction": lambda n: {"along": half(n, "none", "coulomb")},
    "bonded": lambda n: {
        "across": half(n, "bonded", "unilateral"),
        "along": half(n, "bonded", "none"),
    },
    "bonded along": lambda n: {"along": half(n, "bonded", "coulomb")},
    "given forces": lambda n: {
        "across": half(n, "given", "unilateral"),
        "given_force": np.linspace(0.01, 0.1, n),
    },
    "fixed bounds": lambda n: {"fixed_bound": np.where(np.arange(n) % 2 == 0, 0.01, np.nan)},
    "layer": lambda n: {"series_compliance": np.where(np.arange(n) % 2 == 0, 0.1, 0.0)},
    "elastic slip": lambda n: {"elastic_slip": np.where(np.arange(n) % 2 == 0, 2e-3, 0.0)},
    "bound by a rule": lambda n: {"bound": saturating},
}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("body", "side"), [(half_plane, 24), (half_space, 6)])
def test_answers_satisfy_the_law(name: str, body: Callable, side: int) -> None:
    compliance, places = body(side)
    laws = PointLaws(np.full(len(places), COEFFICIENT), **LAWS[name](len(places)))
    size = len(compliance) // len(places)
    problem = pressed(compliance, places, 0.04, [0.006, -0.003][: size - 1], laws)
    answer = solve(problem)
    assert answer.converged
    assert violation(answer) < 1e-10
    # Coulomb's law alone has another answer, which violates this one.
    usual = solve(problem.with_laws(PointLaws(np.full(len(places), COEFFICIENT))))
    usual.__dict__["problem"] = problem
    assert violation(usual) > 1e-4


def test_orthotropic_friction() -> None:
    compliance, places = half_space(6)
    count = len(places)
    laws = PointLaws(np.full(count, COEFFICIENT), metric=ellipses(count))
    problem = pressed(compliance, places, 0.04, [0.006, -0.003], laws)
    answer = solve(problem)
    assert answer.converged
    assert {"STICK", "SLIP"} <= set(answer.statuses)
    assert violation(answer) < 1e-10
    usual = solve(problem.with_laws(PointLaws(np.full(count, COEFFICIENT))))
    usual.__dict__["problem"] = problem
    assert violation(usual) > 1e-3


def test_a_direction_in_which_a_point_is_held_takes_no_force() -> None:
    """As in a plane of symmetry: its row of W is 0."""
    compliance, places = half_space(6)
    held = [3 * number + 2 for number in range(0, 36, 6)]
    compliance[held] = compliance[:, held] = 0.0
    problem = pressed(compliance, places, 0.04, [0.006, 0.0], PointLaws(np.full(36, 0.4)))
    answer = solve(problem)
    assert answer.converged
    assert violation(answer) < 1e-10
    assert not answer.forces[held].any()


@pytest.mark.parametrize("name", [*LAWS, "Coulomb"])
@pytest.mark.parametrize(("body", "side"), [(half_plane, 8), (half_space, 3)])
def test_sweeps_come_to_the_same_answer(name: str, body: Callable, side: int) -> None:
    compliance, places = body(side)
    count, size = len(places), len(compliance) // len(places)
    laws = PointLaws(np.full(count, COEFFICIENT), **LAWS.get(name, lambda n: {})(count))
    problem = pressed(compliance, places, 0.04, [0.006, -0.003][: size - 1], laws)
    equations = NaturalMap(problem)
    forces = Sweeps(equations).run(np.zeros(len(problem.free)), 100)
    state = equations.at(forces)
    assert state.error < 1e-6 * equations.scale(state)
    expected = solve(problem).state.forces
    assert np.allclose(forces, expected, atol=1e-5 * np.abs(expected).max())
