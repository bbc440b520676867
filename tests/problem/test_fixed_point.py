"""The way to a fixed point, on maps whose fixed points are known."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.problem.conduction.fixed_point import FixedPoint

COMM = MPI.COMM_WORLD
SIZE = 8


def fixed_point(value, start, most=60, **options):
    """The fixed point of F; each rank has a part of x.

    Args:
        value: F, of all entries.
        start: The first x, all entries.
        most: Evaluations.
        **options: Arguments of ``FixedPoint``.
    """
    mine = np.arange(SIZE) % COMM.size == COMM.rank
    way = FixedPoint(COMM, mine, np.full(SIZE, np.inf), **options)
    at = np.array(start, dtype=float)
    for _ in range(most):
        found = value(at)
        if np.abs(found - at).max() <= 1e-10:
            return at
        at = way.next(at, found)
        assert np.all(at >= 0)
    raise AssertionError(f"{np.abs(found - at).max():.2g} is left")


def spread(eigenvalues):
    """A symmetric matrix with given eigenvalues, whose vectors mix all entries."""
    vectors = np.linalg.qr(np.random.default_rng(1).normal(size=(SIZE, SIZE)))[0]
    return vectors @ np.diag(eigenvalues) @ vectors.T


def test_a_linear_map_of_large_negative_slopes():
    """F that by itself leads away by factors of up to 40."""
    matrix, exact = spread(-np.geomspace(0.1, 40, SIZE)), np.linspace(1, 2, SIZE)
    found = fixed_point(lambda x: exact + matrix @ (x - exact), exact + 0.1)
    assert found == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("steep", [1.0, 30.0, 1000.0])
def test_a_map_that_falls_steeply_at_first(steep):
    """F = 1/(1 + s x): from 0 it leads far beyond its fixed point, where it tells nothing."""
    scales = np.linspace(1, 3, SIZE) * steep
    found = fixed_point(lambda x: 1 / (1 + scales * x), np.zeros(SIZE))
    assert found == pytest.approx((np.sqrt(1 + 4 * scales) - 1) / (2 * scales), rel=1e-8)


def test_of_several_answers_one_that_the_map_leaves_is_found_where_it_is_wanted():
    """F = x + x (1 − x) (x − 4) / 8 has 0, 1 and 4: from beyond 1 it goes away to 4, or back."""

    def value(x):
        return x + x * (1 - x) * (x - 4) / 8

    grown = fixed_point(value, np.full(SIZE, 1.01))
    assert grown == pytest.approx(np.full(SIZE, 4.0), rel=1e-8)
    nearest = fixed_point(value, np.full(SIZE, 1.01), finds_nearest=True)
    assert nearest == pytest.approx(np.ones(SIZE), rel=1e-8)


def test_an_answer_at_the_bounds():
    """Entries that F would take beyond a bound stay at it, and the others settle beside them."""
    exact = np.linspace(-1, 2, SIZE)
    mine = np.arange(SIZE) % COMM.size == COMM.rank
    way = FixedPoint(COMM, mine, np.full(SIZE, 1.0))
    at = np.full(SIZE, 0.5)
    for _ in range(30):
        at = way.next(at, exact - 3 * (at - exact))
    assert at == pytest.approx(np.clip(exact, 0, 1), abs=1e-8)
