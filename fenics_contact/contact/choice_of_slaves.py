"""The choice of which of two surfaces is the slave, for all contacts together, without rings.

Contacts may share surfaces. A node that is the slave of two contacts can have its displacement
relative to one master only as an unknown, so a surface is to be the slave of few contacts. Where
that leaves the choice, it is the surface that the other covers, and not the much finer one.

Masters must not follow each other in a ring, where that is possible. A contact
is carried by another one if its master has nodes of the other's slave: the slave of the one
follows a surface that itself follows a third. In a ring none of them can be solved for last, which
the iterative solver cannot do without, and the condensed one does at a cost.

On bodies there always is such a choice: put the bodies in an order, and let every contact have its
slave on the earlier one. So contacts are decided one after the other, and of the two slaves that
each may have, one at least closes no ring with those before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.description import CandidateContact
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root, total
from fenics_contact.contact.mortar.pairing import gathered
from fenics_contact.contact.mortar.ray_projection import face, hits
from fenics_contact.contact.mortar.turned_copies import TurnedCopies
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.mesh.tagged_mesh import Group

# A surface is covered whose facets, but for this share, have the other before their middle.
_UNCOVERED = 1e-6
# Of two surfaces that are both covered, or both not, one that is finer by this is no slave.
_MUCH_FINER = 0.5
_MORE_COVERED = 0.05
# Why a surface is the slave that would not be otherwise.
_NO_RING = "so masters do not follow each other in a ring"


@dataclass(frozen=True, eq=False)
class NamedSurface:
    """A surface that a contact names.

    Attributes:
        name: Of its group.
        group: Its facets.
        trace: Its contact points.
    """

    name: str
    group: Group
    trace: Trace


class NamedSurfaces:
    """The surfaces of a contact as the scene names them; collective.

    Attributes:
        on: What its ``on`` names.
        against: The surface opposite, None where there is none.
        wanted: The slave that the scene asks for: ``auto``, ``on`` or ``against``.
        spaces: Those of the body.

    Args:
        contact: Its groups.
        key: Where the scene names them, for messages.
        spaces: Those of the body.
        flat_sides: Axis and coordinate of planes of symmetry.
        walls: The same of flat sides that supports hold.
        cut: The cut faces of a sector, in which surfaces go on.

    Raises:
        InputError: A surface is not on the boundary.
    """

    def __init__(
        self,
        contact: CandidateContact,
        key: str,
        spaces: Spaces,
        flat_sides: list[tuple[int, float]],
        walls: list[tuple[int, float]],
        cut: CutFaces | None = None,
    ) -> None:
        self.spaces, self._key, self._cut = spaces, key, cut
        self._sides = flat_sides, walls, cut
        self.wanted = contact.slave
        self.on = self._surface("on", contact.on)
        self.against: NamedSurface | None = None
        if contact.against is not None:
            self.against = self._surface("against", contact.against)

    def _surface(self, side: str, name: str) -> NamedSurface:
        group = self.spaces.body.boundary(name, f"{self._key}.{side}")
        if total(self.spaces.comm, len(self.spaces.facets(group))) == 0:
            raise InputError(
                f"{self._key}.{side} = '{name}': no facet of it is on the boundary of the body"
            )
        return NamedSurface(name, group, Trace(self.spaces, group, *self._sides))

    def compare(self) -> tuple[bool, str]:
        """Whether ``on`` is the better slave, by what covers what and by sizes of facets, and why.

        Collective.
        """
        assert self.against is not None
        surfaces = gathered(self.on.trace), gathered(self.against.trace)

        def find() -> tuple[list[float], list[float]]:
            shares, sizes = [], []
            for one, other in (surfaces, surfaces[::-1]):
                normals = one.normals_at_centres()
                areas = np.linalg.norm(normals, axis=1)
                whole = TurnedCopies.facing(one.centres, other, self._cut).of_surface(other)
                found = hits(whole, one.centres, normals / areas[:, None])
                faced = np.isfinite(found.distance)
                shares.append(float(areas[faced].sum() / areas.sum()))
                sizes.append(float(areas.mean()) ** (1 / (one.dimension - 1)))
            return shares, sizes

        shares, sizes = on_root(self.spaces.comm, find)
        covered = [share > 1 - _UNCOVERED for share in shares]
        if covered[0] != covered[1]:
            return covered[0], "the other covers it"
        if not covered[0] and abs(shares[0] - shares[1]) > _MORE_COVERED:
            return shares[0] > shares[1], "the other covers more of it"
        if sizes[0] < _MUCH_FINER * sizes[1]:
            return False, "it is not the much finer one"
        return True, "it comes first"

    def nodes(self, are_faced: bool) -> Array:
        """1 at this rank's own nodes of ``on`` and ``against``, which is empty of an obstacle.

        Collective.

        Args:
            are_faced: Whether only those count that face the other surface, or have a facet in
                common with one that does: their displacements too are in the contact's jumps.

        Returns:
            (2, nodes).
        """
        found = np.zeros((2, self.spaces.owned_nodes))
        faced = self._faced() if are_faced and self.against is not None else None
        sides = [side for side in (self.on, self.against) if side is not None]
        for place, side in enumerate(sides):
            surface = side.trace.surface
            ones = np.ones(len(surface.numbers))
            values = ones if faced is None else faced[place][surface.numbers]
            found[place] = surface.on_body(values)[: self.spaces.owned_nodes] > 0
        return found

    def _faced(self) -> list[Array]:
        """1 at the nodes of ``on`` and of ``against`` on facets that face the other surface."""
        assert self.against is not None
        surfaces = gathered(self.on.trace), gathered(self.against.trace)

        def find() -> list[Array]:
            marks = [np.zeros(len(one.normals)) for one in surfaces]
            for place, (one, other) in enumerate((surfaces, surfaces[::-1])):
                copies = TurnedCopies.facing(one.centres, other, self._cut)
                whole = copies.of_surface(other)
                _, found = face(one.node_positions(), one.normals, whole)
                is_hit = found.facet >= 0
                marks[place][is_hit] = 1.0
                marks[1 - place][copies.own(whole.nodes[found.facet[is_hit]])] = 1.0
            for mark, one in zip(marks, surfaces, strict=True):
                mark[one.nodes[mark[one.nodes].any(axis=1)]] = 1.0
            return marks

        return on_root(self.spaces.comm, find)


def choose_slaves(contacts: Sequence[NamedSurfaces]) -> list[tuple[bool, str]]:
    """Decide for every contact whether ``on`` is its slave, and say why; collective.

    Surfaces in the fewest contacts become slaves first, which leaves the others to be masters: so
    none is the slave of two contacts, if that is possible. Where masters would then follow each
    other in a ring, some contacts have the other slave.
    """
    chosen: dict[int, tuple[bool, str]] = {}
    for number, contact in enumerate(contacts):
        if contact.against is None:
            chosen[number] = True, ""
        elif contact.wanted != "auto":
            chosen[number] = contact.wanted == "on", "as the scene says"
    left = [number for number in range(len(contacts)) if number not in chosen]
    beside = _sharing(contacts)

    def cost(number: int, is_on: bool) -> tuple[int, int, int]:
        """Contacts with this surface, too: as their slave, still to be decided, and all."""
        others = beside[number, is_on]
        slaves = sum(other in chosen and chosen[other][0] == on for other, on in others)
        return slaves, sum(other in left for other, _ in others), len(others)

    while left:
        number = min(left, key=lambda number: min(cost(number, True), cost(number, False)))
        costs = cost(number, True), cost(number, False)
        if costs[0] == costs[1]:
            chosen[number] = contacts[number].compare()
        else:
            is_alone = min(costs)[2] == 0
            chosen[number] = (
                costs[0] < costs[1],
                "the other is in several contacts"
                if is_alone
                else "so few surfaces are slaves of several contacts",
            )
        left.remove(number)
    choice = [chosen[number][0] for number in range(len(contacts))]
    free = [n for n, one in enumerate(contacts) if one.against is not None and one.wanted == "auto"]
    if free and has_ring(choice, _shared_nodes(contacts)):
        # Nodes that do not face the other surface close no ring; to find these takes longer.
        better = without_rings(choice, free, _shared_nodes(contacts, are_faced=True))
        chosen |= {n: (is_on, _NO_RING) for n, is_on in enumerate(better) if is_on != choice[n]}
    return [chosen[number] for number in range(len(contacts))]


def _shared_nodes(contacts: Sequence[NamedSurfaces], are_faced: bool = False) -> Flags:
    """Find which surfaces share nodes, (2 contacts, 2 contacts); collective.

    Of each contact the rows are those of ``on`` and ``against``.

    Args:
        contacts: The contacts.
        are_faced: Whether only nodes count that face the other surface.
    """
    nodes = np.concatenate([contact.nodes(are_faced) for contact in contacts])
    return np.asarray(total(contacts[0].spaces.comm, nodes @ nodes.T) > 0)


def _sharing(
    contacts: Sequence[NamedSurfaces],
) -> dict[tuple[int, bool], list[tuple[int, bool]]]:
    """Find, for every surface, those of other contacts that have facets of it.

    A surface is the number of its contact, and whether it is ``on``.
    """
    surfaces = {
        (number, is_on): set(surface.group.tags)
        for number, contact in enumerate(contacts)
        for is_on, surface in ((True, contact.on), (False, contact.against))
        if surface is not None
    }
    return {
        one: [other for other, its in surfaces.items() if other[0] != one[0] and tags & its]
        for one, tags in surfaces.items()
    }


def without_rings(choice: Sequence[bool], free: Sequence[int], shared: Flags) -> list[bool]:
    """Choices of slaves, changed where that avoids a ring of masters.

    Where something is changed, slaves that are shared and carried are avoided as well.

    Args:
        choice: The same as it is chosen otherwise; it is kept where it has no ring.
        free: Numbers of the contacts that may have the other slave.
        shared: Which surfaces share nodes, two rows and columns a contact: ``on`` and ``against``.

    Four bodies around a point, each in contact with the next, and the slave of that contact:

    >>> nodes = np.array([[0], [1], [1], [2], [2], [3], [3], [0]])
    >>> without_rings([True] * 4, range(4), nodes == nodes.T)
    [True, False, True, False]
    """
    every = list(range(len(choice)))
    found = list(choice)
    if not has_ring(found, shared):
        return found
    decided = [number for number in every if number not in free]
    for number in free:
        decided.append(number)
        _turn(found, [number], shared, decided)
    while any(_faults(found, shared, every)[:2]) and _turn(found, free, shared, every):
        pass
    return found


def has_ring(choice: Sequence[bool], shared: Flags) -> bool:
    """Whether masters follow each other in a ring.

    Args:
        choice: Of every contact whether ``on`` is its slave.
        shared: Which surfaces share nodes, two rows and columns a contact: ``on`` and ``against``.
    """
    return _faults(choice, shared, range(len(choice)))[0] > 0


def _turn(choice: list[bool], numbers: Sequence[int], shared: Flags, among: Sequence[int]) -> bool:
    """Give that contact its other slave which lessens the faults most; whether there is one."""

    def turned(number: int) -> list[bool]:
        return [is_on != (other == number) for other, is_on in enumerate(choice)]

    best = min(numbers, key=lambda number: _faults(turned(number), shared, among))
    if _faults(turned(best), shared, among) >= _faults(choice, shared, among):
        return False
    choice[best] = not choice[best]
    return True


def _faults(choice: Sequence[bool], shared: Flags, among: Sequence[int]) -> tuple[int, int, int]:
    """How many contacts follow a ring; are carried and share their slave; and are carried."""
    slaves = np.array([2 * number + (not choice[number]) for number in among])
    masters = slaves ^ 1
    others = ~np.eye(len(among), dtype=bool)
    carries = shared[np.ix_(masters, slaves)] & others
    is_carried = carries.any(axis=1)
    follows = is_carried
    while (more := (carries & follows).any(axis=1)).sum() < follows.sum():
        follows = more
    shares = (shared[np.ix_(slaves, slaves)] & others).any(axis=1)
    twice = is_carried & ~follows & shares
    return int(follows.sum()), int(twice.sum()), int(is_carried.sum())
