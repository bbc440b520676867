"""Which process solves which points."""

import pytest

from fenics_contact.simulation.sweeps.leader import Shares
from fenics_contact.simulation.sweeps.points import PointGroup


def groups(*sizes, meshes=None):
    found, first = [], 0
    for number, size in enumerate(sizes):
        mesh = meshes[number] if meshes else f"m{number}"
        found.append(PointGroup(mesh, tuple(range(first, first + size))))
        first += size
    return found


def solve(shares, jobs, slow=()):
    """Each process in turn takes a point; a slow one takes one in three turns."""
    taken = {number: [] for number in range(jobs)}
    for turn in range(1000):
        if not shares.left:
            break
        for number in range(jobs):
            if number not in slow or turn % 3 == 0:
                point = shares.next(number)
                taken[number] += [] if point is None else [point]
    return taken


@pytest.mark.parametrize("jobs", [1, 2, 3, 7])
@pytest.mark.parametrize("sizes", [(10,), (4, 4), (1, 9), (3, 3, 3, 3, 3), (1,)])
def test_every_point_is_solved_once(sizes, jobs):
    taken = solve(Shares(groups(*sizes), jobs), jobs)
    assert sorted(p for points in taken.values() for p in points) == list(range(sum(sizes)))


def bodies(taken, every):
    """How often a body is made."""
    return sum(
        len({n for n, group in enumerate(every) if set(group.points) & set(points)})
        for points in taken.values()
    )


def test_where_there_are_enough_bodies_each_is_made_once():
    every = groups(3, 3, 3, 3, 3)
    assert bodies(solve(Shares(every, 2), 2, slow=[1]), every) == 5


def test_one_body_is_shared_in_stretches_of_neighbours():
    taken = solve(Shares(groups(10), 2), 2)
    assert taken == {0: [0, 1, 2, 3, 4], 1: [5, 6, 7, 8, 9]}


def test_who_is_done_takes_half_of_what_another_one_has_left_of_the_same_body():
    taken = solve(Shares(groups(12), 2), 2, slow=[1])
    assert len(taken[0]) > 7
    assert sorted(taken[0] + taken[1]) == list(range(12))


def test_a_body_is_not_made_again_only_to_help():
    every = groups(1, 9)
    taken = solve(Shares(every, 2), 2)
    assert bodies(taken, every) == 2


def test_bodies_of_one_mesh_go_to_one_process():
    every = groups(2, 2, 2, 2, meshes=["a", "b", "a", "b"])
    taken = solve(Shares(every, 2), 2)
    assert taken == {0: [0, 1, 4, 5], 1: [2, 3, 6, 7]}


def test_what_a_dead_process_had_waits_again():
    shares = Shares(groups(4), 1)
    assert shares.next(0) == 0
    shares.give_back(0)
    assert shares.left == 3
    assert [shares.next(1) for _ in range(4)] == [1, 2, 3, None]
