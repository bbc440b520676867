"""Slaves chosen so that masters do not follow each other in a ring, where that is possible.

A contact is carried by another one if its master has nodes of the other's slave: the slave of the
one follows a surface that itself follows a third. In a ring none of them can be solved for last,
which the iterative solver cannot do without, and the condensed one does at a cost.

On bodies there always is such a choice: put the bodies in an order, and let every contact have its
slave on the earlier one. So contacts are decided one after the other, and of the two slaves that
each may have, one at least closes no ring with those before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Flags


@dataclass(frozen=True, eq=False)
class Meetings:
    """Which surfaces of contacts share nodes: of each contact ``on``, and then ``against``.

    Attributes:
        carried: Whether a surface (row), if it is a master, is carried by another one (column), if
            that is a slave, (2 contacts, 2 contacts).
        shared: Whether two surfaces share nodes if both are slaves, (2 contacts, 2 contacts).
    """

    carried: Flags
    shared: Flags


def without_rings(choice: Sequence[bool], free: Sequence[int], meet: Meetings) -> list[bool]:
    """Choices of slaves, changed where that avoids a ring of masters.

    Where something is changed, slaves that are shared and carried are avoided as well.

    Args:
        choice: The same as it is chosen otherwise; it is kept where it has no ring.
        free: Numbers of the contacts that may have the other slave.
        meet: Which surfaces share nodes.

    Four bodies around a point, each in contact with the next, and the slave of that contact:

    >>> nodes = np.array([[0], [1], [1], [2], [2], [3], [3], [0]])
    >>> without_rings([True] * 4, range(4), Meetings(nodes == nodes.T, nodes == nodes.T))
    [True, False, True, False]
    """
    every = list(range(len(choice)))
    found = list(choice)
    if not has_ring(found, meet):
        return found
    decided = [number for number in every if number not in free]
    for number in free:
        decided.append(number)
        _turn(found, [number], meet, decided)
    while any(_faults(found, meet, every)[:2]) and _turn(found, free, meet, every):
        pass
    return found


def has_ring(choice: Sequence[bool], meet: Meetings) -> bool:
    """Whether masters follow each other in a ring.

    Args:
        choice: Of every contact whether ``on`` is its slave.
        meet: Which surfaces share nodes.
    """
    return _faults(choice, meet, range(len(choice)))[0] > 0


def _turn(choice: list[bool], numbers: Sequence[int], meet: Meetings, among: Sequence[int]) -> bool:
    """Give that contact its other slave which lessens the faults most; whether there is one."""

    def turned(number: int) -> list[bool]:
        return [is_on != (other == number) for other, is_on in enumerate(choice)]

    best = min(numbers, key=lambda number: _faults(turned(number), meet, among))
    if _faults(turned(best), meet, among) >= _faults(choice, meet, among):
        return False
    choice[best] = not choice[best]
    return True


def _faults(choice: Sequence[bool], meet: Meetings, among: Sequence[int]) -> tuple[int, int, int]:
    """How many contacts follow a ring; are carried and share their slave; and are carried."""
    slaves = np.array([2 * number + (not choice[number]) for number in among])
    masters = slaves ^ 1
    others = ~np.eye(len(among), dtype=bool)
    carries = meet.carried[np.ix_(masters, slaves)] & others
    is_carried = carries.any(axis=1)
    follows = is_carried
    while (more := (carries & follows).any(axis=1)).sum() < follows.sum():
        follows = more
    shares = (meet.shared[np.ix_(slaves, slaves)] & others).any(axis=1)
    twice = is_carried & ~follows & shares
    return int(follows.sum()), int(twice.sum()), int(is_carried.sum())
