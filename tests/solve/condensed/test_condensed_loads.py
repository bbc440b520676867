"""Loads whose condensed ones are combinations of a few: how many are condensed, and how well."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.solve.condensed.condensed_loads import CondensedLoads


class Bulk:
    """A linear map in place of a solve, which counts."""

    comm, count = MPI.COMM_SELF, 7

    def __init__(self):
        self.matrix = np.random.default_rng(3).standard_normal((self.count, 60))
        self.solves = 0

    def condense(self, load):
        self.solves += 1
        return load @ self.matrix.T


@pytest.mark.parametrize("size", [1e3, 1, 1e-3, 1e-6])
def test_what_goes_to_and_fro_about_a_load_takes_two_solves(size):
    """However small beside that load; to round-off of the load."""
    bulk = Bulk()
    loads = CondensedLoads(bulk)
    preload, drive = np.random.default_rng(4).standard_normal((2, 60)) * [[1], [size]]
    for share in (0.0, *np.sin(np.linspace(0.1, 20, 50))):
        load = preload + share * drive
        error = np.abs(loads.condense(load) - bulk.matrix @ load).max()
        assert error < 1e-13 * np.linalg.norm(bulk.matrix) * np.linalg.norm(load)
    assert bulk.solves == 2


def test_many_loads_that_have_nothing_to_do_with_each_other_are_condensed_each():
    bulk = Bulk()
    loads = CondensedLoads(bulk)
    for load in np.random.default_rng(5).standard_normal((20, 60)):
        assert loads.condense(load) == pytest.approx(bulk.matrix @ load, rel=1e-10, abs=1e-10)
    assert bulk.solves == 20
    assert len(loads.known) <= 8
    assert not loads.condense(np.zeros(60)).any()
    assert bulk.solves == 20


def test_loads_that_are_foreseen_take_one_solve_together():
    """Also those that hardly differ from one that was known, and sums with it."""
    bulk = Bulk()
    loads = CondensedLoads(bulk)
    known, *others = np.random.default_rng(6).standard_normal((4, 60))
    loads.condense(known)
    others[0] = known + 1e-6 * others[0]
    loads.precompute(np.array(others))
    assert bulk.solves == 2
    for load in (*others, known + others[1], known - 2 * others[2]):
        assert loads.condense(load) == pytest.approx(bulk.matrix @ load, rel=1e-9, abs=1e-9)
    assert bulk.solves == 2


@pytest.mark.parametrize("size", [1.0, 1e-200])
def test_a_load_of_zero_among_those_foreseen_is_no_part_of_any_other(size):
    """As of a mesh without an error to estimate; nor are loads lost whose squares are too small."""
    bulk = Bulk()
    loads = CondensedLoads(bulk)
    load, other = size * np.random.default_rng(7).standard_normal((2, 60))
    loads.precompute(np.array([np.zeros(60), load, load]))
    for wanted in (load, other, load - 2 * other):
        assert loads.condense(wanted) == pytest.approx(bulk.matrix @ wanted, rel=1e-9)
    assert bulk.solves == 2
    assert len(loads.known) == 2
