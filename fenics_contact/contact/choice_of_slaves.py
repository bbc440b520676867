"""Which of two surfaces is the slave: for all contacts together, as they may share surfaces.

A node that is the slave of two contacts can have its displacement relative to one master only as
an unknown, so a surface is to be the slave of few contacts. Where that leaves the choice, it is the
surface that the other covers, and not the much finer one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.body.description import CandidateContact
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root, total
from fenics_contact.contact.mortar.pairing import gathered
from fenics_contact.contact.mortar.ray_projection import face, hits
from fenics_contact.contact.rings_of_masters import Meetings, has_ring, without_rings
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
class Surface:
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
    ) -> None:
        self.spaces, self._key = spaces, key
        self._flat_sides, self._walls = flat_sides, walls
        self.wanted = contact.slave
        self.on = self._surface("on", contact.on)
        self.against: Surface | None = None
        if contact.against is not None:
            self.against = self._surface("against", contact.against)

    def _surface(self, side: str, name: str) -> Surface:
        group = self.spaces.body.boundary(name, f"{self._key}.{side}")
        if total(self.spaces.comm, len(self.spaces.facets(group))) == 0:
            raise InputError(
                f"{self._key}.{side} = '{name}': no facet of it is on the boundary of the body"
            )
        return Surface(name, group, Trace(self.spaces, group, self._flat_sides, self._walls))

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
                found = hits(other, one.centres, normals / areas[:, None])
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

    def nodes(self, are_faced: bool) -> tuple[Array, Array]:
        """1 at this rank's own nodes of ``on`` and ``against`` that a slave, or a master, has.

        Collective.

        Args:
            are_faced: Whether only those count that face the other surface.

        Returns:
            Each (2, nodes); of a contact with an obstacle no master has any, and no ``against``.
        """
        slaves, masters = np.zeros((2, 2, self.spaces.owned_nodes))
        if self.against is None:
            slaves[0] = self._on_body(self.on, np.ones(len(self.on.trace.all_nodes)))
            return slaves, masters
        sides = self.on, self.against
        faced = self._faced() if are_faced else None
        for place, side in enumerate(sides):
            numbers = side.trace.surface.numbers
            ones = np.ones(len(numbers))
            slaves[place] = self._on_body(side, ones if faced is None else faced[place][0][numbers])
            masters[place] = self._on_body(
                side, ones if faced is None else faced[place][1][numbers]
            )
        return slaves, masters

    def _on_body(self, side: Surface, values: Array) -> Array:
        found = side.trace.surface.on_body(values)[: self.spaces.owned_nodes]
        return np.asarray(found > 0, dtype=np.float64)

    def _faced(self) -> list[tuple[Array, Array]]:
        """The same of all nodes of each surface, by the surface's numbers; collective."""
        assert self.against is not None
        surfaces = gathered(self.on.trace), gathered(self.against.trace)

        def find() -> list[tuple[Array, Array]]:
            marks = [(np.zeros(len(one.normals)), np.zeros(len(one.normals))) for one in surfaces]
            for place, (slave, master) in enumerate((surfaces, surfaces[::-1])):
                _, found = face(slave.node_positions(), slave.normals, master)
                is_hit = found.facet >= 0
                marks[place][0][is_hit] = 1.0
                marks[1 - place][1][master.nodes[found.facet[is_hit]]] = 1.0
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
    if free and has_ring(choice, _meetings(contacts)):
        # Nodes that do not face the other surface close no ring; to find these takes longer.
        better = without_rings(choice, free, _meetings(contacts, are_faced=True))
        chosen |= {n: (is_on, _NO_RING) for n, is_on in enumerate(better) if is_on != choice[n]}
    return [chosen[number] for number in range(len(contacts))]


def _meetings(contacts: Sequence[NamedSurfaces], are_faced: bool = False) -> Meetings:
    """Find which surfaces share nodes; collective.

    Args:
        contacts: The contacts.
        are_faced: Whether only nodes count that face the other surface.
    """
    spaces = contacts[0].spaces
    slaves = np.zeros((2 * len(contacts), spaces.owned_nodes))
    masters = np.zeros_like(slaves)
    for number, contact in enumerate(contacts):
        rows = slice(2 * number, 2 * number + 2)
        slaves[rows], masters[rows] = contact.nodes(are_faced)
    carried = total(spaces.comm, masters @ slaves.T) > 0
    return Meetings(np.asarray(carried), np.asarray(total(spaces.comm, slaves @ slaves.T) > 0))


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
