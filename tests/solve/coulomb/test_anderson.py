"""Anderson's acceleration on affine maps: finite termination, ranks, numbers ≥ 0."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.common.parallel import largest
from fenics_contact.solve.coulomb.alternating_loop import Anderson

COMM = MPI.COMM_WORLD
RATES = np.array([0.9, -0.6, 0.5, 0.2, 0.7])


def affine(dimension):
    """A contraction x → A x + b with its fixed point, positive; the same on every rank."""
    random = np.random.default_rng(dimension)
    basis = np.linalg.qr(random.normal(size=(dimension, dimension)))[0]
    matrix = basis @ np.diag(RATES[:dimension]) @ basis.T
    fixed = random.uniform(5, 6, dimension)
    return lambda x: fixed + matrix @ (x - fixed), fixed


def iterates(comm, image, starts, counted, steps):
    """Arrays before each step and after the last; ``image`` maps and returns lists of arrays."""
    accelerator = Anderson(comm, counted)
    arrays = [starts]
    for _ in range(steps):
        arrays.append(accelerator.next(arrays[-1], image(arrays[-1])))
    return arrays


@pytest.mark.parametrize("dimension", [1, 2, 3, 4, 5])
def test_affine_map_ends_after_as_many_steps_as_unknowns_and_one(dimension):
    """As GMRES, with which it is equivalent (Walker and Ni 2011, Theorem 2.2)."""
    image, fixed = affine(dimension)
    everywhere = [np.ones(dimension, dtype=bool)]
    found = iterates(
        MPI.COMM_SELF, lambda x: [image(x[0])], [fixed + 1.0], everywhere, dimension + 1
    )
    assert np.abs(found[-1][0] - fixed).max() < 1e-7
    plain = fixed + 1.0
    for _ in range(dimension + 1):
        plain = image(plain)
    assert np.abs(plain - fixed).max() > 1e-3  # without acceleration


def test_first_step_is_the_map_itself():
    (found,) = Anderson(MPI.COMM_SELF, [np.ones(2, dtype=bool)]).next(
        [np.array([1.0, 2.0])], [np.array([3.0, 4.0])]
    )
    assert found.tolist() == [3.0, 4.0]


def test_spread_over_ranks_it_makes_the_same_iterates():
    """Each rank holds its share and a copy of its neighbour's first entry, not counted."""
    size = 12
    random = np.random.default_rng(1)
    matrix = random.normal(size=(size, size))
    matrix *= 0.8 / np.linalg.norm(matrix, 2)
    fixed, start = random.uniform(5, 6, size), random.uniform(5, 6, size)

    def image(x):
        return fixed + matrix @ (x - fixed)

    alone = iterates(
        MPI.COMM_SELF, lambda x: [image(x[0])], [start], [np.ones(size, dtype=bool)], 6
    )
    shares = np.array_split(np.arange(size), COMM.size)
    mine = shares[COMM.rank]
    held = np.append(mine, shares[(COMM.rank + 1) % COMM.size][:1])
    counted = [np.arange(len(held)) < len(mine)]

    def spread(x):
        whole = np.concatenate(COMM.allgather(x[0][: len(mine)]))
        return [image(whole)[held]]

    together = iterates(COMM, spread, [start[held]], counted, 6)
    for first, second in zip(alone, together, strict=True):
        assert largest(COMM, np.abs(first[0][held] - second[0])) < 1e-9
    assert np.abs(alone[-1][0] - fixed).max() < 0.1 * np.abs(start - fixed).max()


def test_ranks_without_any_entry_take_part():
    first = COMM.rank == 0
    image, fixed = affine(3)
    count = 3 if first else 0
    found = iterates(
        COMM,
        lambda x: [image(x[0]) if first else x[0]],
        [fixed[:count] + 1.0],
        [np.ones(count, dtype=bool)],
        4,
    )
    assert largest(COMM, np.abs(found[-1][0] - fixed[:count])) < 1e-7


def test_several_arrays_are_accelerated_as_one():
    image, fixed = affine(5)

    def split(x):
        return np.split(image(np.concatenate(x)), [2])

    counted = [np.ones(2, dtype=bool), np.ones(3, dtype=bool)]
    found = iterates(MPI.COMM_SELF, split, np.split(fixed + 1.0, [2]), counted, 6)[-1]
    assert [len(array) for array in found] == [2, 3]
    assert np.abs(np.concatenate(found) - fixed).max() < 1e-7


def test_numbers_stay_positive_where_extrapolation_would_not():
    """x → .9 x − 1 goes to −10; extrapolated it would be there at once."""
    found = iterates(
        MPI.COMM_SELF, lambda x: [0.9 * x[0] - 1], [np.array([5.0])], [np.ones(1, dtype=bool)], 3
    )
    assert found[1][0][0] == pytest.approx(3.5)
    assert found[2][0].tolist() == [0.0]
    assert found[3][0].tolist() == [0.0]


def test_steps_that_depend_on_each_other_do_no_harm():
    """A map that is constant gives the same residual differences again and again."""
    goal = np.array([1.0, 2.0, 3.0])
    accelerator = Anderson(MPI.COMM_SELF, [np.ones(3, dtype=bool)])
    arrays = [np.zeros(3)]
    for _ in range(10):
        arrays = accelerator.next(arrays, [goal])
        assert arrays[0] == pytest.approx(goal, rel=1e-12)
