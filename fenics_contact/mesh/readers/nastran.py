"""Meshes of Nastran (``.bdf``): grid points and elements, in groups by their property numbers.

The readers of meshio and Gmsh pass over what they do not know: elements, other files, and systems
of coordinates, without which a mesh has holes or another shape.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.element_kinds import (
    CORNERS,
    NAMES,
    NOT_GIVEN,
    SIDES,
    as_gmsh,
    dimension_of,
    shape_of,
)
from fenics_contact.mesh.readers.found_mesh import FileLines, FoundMesh, Line
from fenics_contact.mesh.readers.nastran_cards import LARGEST, Card, cards
from fenics_contact.mesh.readers.nastran_systems import GridPoints

_FIRST, _WIDTH = 4, 4  # fields before the sides, and of each: its solid and three of its corners


class ContactSurfaces:
    """Surfaces as they come in."""

    def __init__(self) -> None:
        self._cards: list[Card] = []

    def take(self, card: Card) -> None:
        """Take a surface.

        Args:
            card: ``BSURFS`` or ``BSURF``, whose lines that continue it may still follow.
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
            for kind, of_kind in (numbers.items() if self._named("BSURFS") else ())
            for row, number in enumerate(of_kind)
        }
        found: dict[str, dict[int, list[Integers]]] = {}
        for card in self._named("BSURFS"):
            sides = found.setdefault(f"BSURFS.{card.whole(0)}", {})
            for place in range(_FIRST, len(card.fields), _WIDTH):
                if card.fields[place]:
                    side, nodes = _side(card, place, cells, rows)
                    sides.setdefault(side, []).append(nodes)
        return {
            name: {side: np.array(several) for side, several in sides.items()}
            for name, sides in found.items()
        }

    def of_elements(self, numbers: Mapping[int, Integers]) -> dict[str, dict[int, Integers]]:
        """Rows of elements by Gmsh's type, by name: BSURF, a dot and the surface's number.

        Args:
            numbers: Gmsh's type → the file's number of each.

        Raises:
            RefusedError: A card names no elements of the mesh.
        """
        found: dict[str, dict[int, Integers]] = {}
        for card in self._named("BSURF"):
            rows = {
                kind: np.flatnonzero(
                    np.any(
                        [
                            (every >= ids.start)
                            & (every < ids.stop)
                            & ((every - ids.start) % ids.step == 0)
                            for ids in _listed(card)
                        ],
                        axis=0,
                    )
                )
                for kind, every in numbers.items()
            }
            rows = {kind: mine for kind, mine in rows.items() if len(mine)}
            if not rows:
                raise card.line.error("BSURF names no elements of the mesh")
            found[f"BSURF.{card.whole(0)}"] = rows
        return found

    def _named(self, word: str) -> list[Card]:
        return [card for card in self._cards if card.word == word]


def _listed(card: Card) -> list[range]:
    """Numbers of elements behind the first field, also as FIRST THRU LAST BY STEP."""
    words = [word.upper() for word in card.fields[1:] if word]
    found, place = [], 0
    while place < len(words):
        first, last, step = words[place], words[place], "1"
        if words[place + 1 : place + 2] == ["THRU"]:
            last = (words[place + 2 : place + 3] or [""])[0]
            place += 2
            if words[place + 1 : place + 2] == ["BY"]:
                step = (words[place + 2 : place + 3] or [""])[0]
                place += 2
        if not all(word.isdigit() and 0 < int(word) < LARGEST for word in (first, last, step)):
            raise card.line.error(f"{card.word} wants numbers of elements, also as 1 THRU 9 BY 2")
        found.append(range(int(first), int(last) + 1, int(step)))
        place += 1
    return found


def _side(
    card: Card, place: int, cells: Mapping[int, Integers], rows: Mapping[int, tuple[int, int]]
) -> tuple[int, Integers]:
    """Gmsh's type and the nodes of the side that four fields of a card name."""
    number = card.whole(place)
    corners = {card.whole(place + 1 + n) for n in range(_WIDTH - 1)}
    kind, row = rows.get(number, (0, 0))
    if kind in SIDES and dimension_of(kind) == 3:
        for side, places in SIDES[kind]:
            nodes = cells[kind][row][np.array(places)]
            if corners <= set(nodes.tolist()):
                return side, nodes
    raise card.line.error(
        f"the grid points {', '.join(map(str, sorted(corners)))} are corners of no side of a solid "
        f"{number}"
    )


# Gmsh's types by card and number of nodes.
_CARDS = {
    "CTETRA": {4: 4, 10: 11},
    "CHEXA": {8: 5, 20: 17},
    "CPENTA": {6: 6, 15: 18},
    "CPYRAM": {5: 7, 13: 19},
    "CTRIA3": {3: 2},
    "CTRIAR": {3: 2},
    "CTRIA6": {3: 2, 6: 9},
    "CQUAD4": {4: 3},
    "CQUADR": {4: 3},
    "CQUAD8": {4: 3, 8: 16},
    "CBAR": {2: 1},
    "CBEAM": {2: 1},
    "CROD": {2: 1},
    "CTUBE": {2: 1},
}
# Other cards of cells and facets, which a mesh would lack.
_UNKNOWN = re.compile(r"C(?:TR|QUAD|TET|HEX|PEN|PY|IHEX|PLST|SHEAR|IFHEX|IFPEN)\w*")
# Nastran lists the edges between base and top before those of the top: places of its nodes.
_ORDERS = {
    "Hexahedron 20": (*range(12), *range(16, 20), *range(12, 16)),
    "Prism 15": (*range(9), *range(12, 15), *range(9, 12)),
}


def read(job: dict[str, Any]) -> FoundMesh:
    """The mesh of a file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    lines = FileLines(f"{job['key']}.file", job["name"], Path(job["file"]))
    points = GridPoints()
    elements: dict[int, list[list[int]]] = {}
    properties: dict[int, list[int]] = {}
    numbers: dict[int, list[int]] = {}
    taken: set[int] = set()
    contacts = ContactSurfaces()
    for card in cards(_bulk(lines)):
        if points.take(card):
            continue
        if card.word in _CARDS:
            kind, found = _nodes(card)
            number = card.whole(0)
            if number in taken:
                raise card.line.error(f"the element {number} is defined twice")
            taken.add(number)
            numbers.setdefault(kind, []).append(number)
            elements.setdefault(kind, []).append(found)
            properties.setdefault(kind, []).append(card.whole(1) if card.fields[1] else number)
        elif card.word in ("BSURF", "BSURFS"):
            contacts.take(card)
        elif _UNKNOWN.fullmatch(card.word):
            raise card.line.error(
                f"elements {card.word} are not read; there are: {', '.join(sorted(_CARDS))}"
            )
    if not points.numbers() or not elements:
        raise lines.error("has no grid points (GRID), or no elements (CTETRA, CHEXA, CQUAD4, …)")
    cells = {kind: as_gmsh(kind, np.array(found)) for kind, found in elements.items()}
    numbered = {kind: np.array(found) for kind, found in numbers.items()}
    return FoundMesh(
        np.array(points.numbers(), dtype=np.int64),
        points.places(),
        cells,
        numbered,
        _sets(properties) | contacts.of_elements(numbered),
        contacts.of_sides(cells, numbered),
    )


def _bulk(lines: FileLines) -> Iterator[Line]:
    """Lines of the bulk data."""
    found = list(_statements(lines, lines.lines()))
    begins = [n for n, line in enumerate(found) if re.match(r"\s*BEGIN\s+BULK", line.text, re.I)]
    start = begins[-1] + 1 if begins else 0
    for line in found[start:]:
        if line.text.split(",")[0].strip().upper().startswith("ENDDATA"):
            return
        yield line
    if begins:
        raise lines.error(
            "ends before ENDDATA; if it is not truncated, add ENDDATA as its last line"
        )


def _statements(lines: FileLines, found: Iterator[Line]) -> Iterator[Line]:
    """Lines that say something, of a file and of those that it includes."""
    for line in found:
        text = line.text.partition("$")[0].rstrip()
        if not text:
            continue
        include = re.match(r"""\s*INCLUDE\s*['"]?([^'"]*)(['"]?)""", text, re.I)
        if include is not None:
            yield from _statements(lines, lines.included(line, include[1].strip()))
        else:
            yield Line(text, line.file, line.number)


def _nodes(card: Card) -> tuple[int, list[int]]:
    """Gmsh's type of an element, and its nodes in the order of most programs."""
    kinds = _CARDS[card.word]
    most = max(kinds)
    words = (card.fields[2 : 2 + most] + most * [""])[:most]
    given = [word not in ("", "0") for word in words]
    corners = CORNERS[shape_of(kinds[most])]
    count = most if any(given[corners:]) else corners
    if not all(given[:corners]) or count not in kinds:
        wanted = " or ".join(map(str, sorted(kinds)))
        raise card.line.error(f"{card.word} wants {wanted} nodes, but has {sum(given)}")
    found = [card.whole(2 + place) if given[place] else NOT_GIVEN for place in range(count)]
    if NAMES[kinds[count]] in _ORDERS:
        found = [found[place] for place in _ORDERS[NAMES[kinds[count]]]]
    return kinds[count], found


def _sets(properties: dict[int, list[int]]) -> dict[str, dict[int, Any]]:
    """Rows of elements by property number, and Gmsh's type."""
    found: dict[int, dict[int, Any]] = {}
    for kind, of_kind in properties.items():
        values, inverse = np.unique(np.array(of_kind), return_inverse=True)
        for place, value in enumerate(values):
            found.setdefault(int(value), {})[kind] = np.flatnonzero(inverse == place)
    return {str(value): found[value] for value in sorted(found)}
