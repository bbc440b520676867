"""Contact surfaces of a Nastran file: sides of solids, each by three of its corners (BSURFS)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.element_kinds import SIDES, dimension_of
from fenics_contact.mesh.readers.nastran_cards import Card

_FIRST, _WIDTH = 4, 4  # fields before the sides, and of each: its solid and three of its corners


class ContactSurfaces:
    """Surfaces as they come in."""

    def __init__(self) -> None:
        self._cards: list[Card] = []

    def take(self, card: Card) -> None:
        """Take a surface.

        Args:
            card: ``BSURFS``, whose lines that continue it may still follow.
        """
        self._cards.append(card)

    def of_sides(
        self, cells: Mapping[int, Integers], numbers: Mapping[int, Integers]
    ) -> dict[str, dict[int, Integers]]:
        """Nodes of the sides by Gmsh's type, by name: BSURFS, a dot and the surface's number.

        Args:
            cells: Gmsh's type → nodes of all elements, in Gmsh's order.
            numbers: Gmsh's type → the file's number of each.

        Raises:
            RefusedError: A card names what is no side of a solid.
        """
        rows = {
            int(number): (kind, row)
            for kind, of_kind in (numbers.items() if self._cards else ())
            for row, number in enumerate(of_kind)
        }
        found: dict[str, dict[int, list[Integers]]] = {}
        for card in self._cards:
            sides = found.setdefault(f"BSURFS.{card.whole(0)}", {})
            for place in range(_FIRST, len(card.fields), _WIDTH):
                if card.fields[place]:
                    side, nodes = _side(card, place, cells, rows)
                    sides.setdefault(side, []).append(nodes)
        return {
            name: {side: np.array(several) for side, several in sides.items()}
            for name, sides in found.items()
        }


def _side(
    card: Card, place: int, cells: Mapping[int, Integers], rows: Mapping[int, tuple[int, int]]
) -> tuple[int, Integers]:
    """Gmsh's type and the nodes of the side that four fields of a card name."""
    number = card.whole(place)
    corners = {card.whole(place + 1 + n) for n in range(_WIDTH - 1)}
    kind, row = rows.get(number, (0, 0))
    if kind in SIDES and dimension_of(kind) == 3:
        side, places = SIDES[kind]
        for nodes in cells[kind][row][np.array(places)]:
            if corners <= set(nodes.tolist()):
                return side, nodes
    raise card.line.error(
        f"the grid points {', '.join(map(str, sorted(corners)))} are corners of no side of a solid "
        f"{number}"
    )
