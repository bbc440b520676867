"""Meshes of Nastran (``.bdf``): grid points and elements, in groups by their property numbers.

The readers of meshio and Gmsh pass over what they do not know: elements, other files, and systems
of coordinates, without which a mesh has holes or another shape.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.mesh.readers.element_kinds import NAMES, as_gmsh
from fenics_contact.mesh.readers.file_lines import FileLines, Line
from fenics_contact.mesh.readers.found_mesh import FoundMesh

# Gmsh's types by card and number of nodes.
_CARDS = {
    "CTETRA": {4: 4, 10: 11},
    "CHEXA": {8: 5, 20: 17},
    "CPENTA": {6: 6, 15: 18},
    "CPYRAM": {5: 7, 13: 19},
    "CTRIA3": {3: 2},
    "CTRIAR": {3: 2},
    "CTRIA6": {6: 9},
    "CQUAD4": {4: 3},
    "CQUADR": {4: 3},
    "CQUAD8": {8: 16},
    "CBAR": {2: 1},
    "CBEAM": {2: 1},
    "CROD": {2: 1},
    "CTUBE": {2: 1},
}
# Other cards of cells and facets, which a mesh would lack.
_UNKNOWN = re.compile(r"C(?:TR|QUAD|TET|HEX|PEN|PY|IHEX|PLST|SHEAR|IFHEX|IFPEN)\w*")
# Nastran lists the edges between base and top of a hexahedron before those of its top.
_HEXAHEDRON = (*range(12), *range(16, 20), *range(12, 16))
_EXPONENT = re.compile(r"(?<=[\d.])(?=[+-]\d+$)")
_LARGEST = 2**53


class _Card:
    """A card: its word, its fields, and its first line."""

    def __init__(self, line: Line) -> None:
        self.line = line
        first, self.fields = _fields(line.text)
        self.word = first.rstrip("*").upper()

    def goes_on(self, line: Line) -> bool:
        """Whether a line continues the card; its fields are taken then."""
        first, fields = _fields(line.text)
        if first and first[0] not in "+*":
            return False
        self.fields += fields
        return True

    def whole(self, place: int) -> int:
        """A field that holds a positive whole number."""
        try:
            value = int(self.fields[place])
        except (IndexError, ValueError):
            value = 0
        if not 0 < value < _LARGEST:
            raise self.line.error(
                f"field {place + 2} of {self.word} must be a positive whole number"
            )
        return value

    def real(self, place: int) -> float:
        """A field that holds a number, such as 1.5-3; zero where it is blank."""
        text = self.fields[place] if place < len(self.fields) else ""
        try:
            return float(_EXPONENT.sub("E", text.upper().replace("D", "E")) if text else 0.0)
        except ValueError:
            raise self.line.error(f"field {place + 2} of {self.word} must be a number") from None


def _fields(text: str) -> tuple[str, list[str]]:
    """The first field of a line, and those of data: 8 of them, or 4 wide ones."""
    if "," in text:
        first, *found = [word.strip() for word in text.split(",")]
        most = 4 if first.endswith("*") else 8
        return first, (found + most * [""])[:most]
    text = text.expandtabs(8)
    first = text[:8].strip()
    width = 16 if first.endswith("*") or first.startswith("*") else 8
    return first, [text[at : at + width].strip() for at in range(8, 72, width)]


def read(job: dict[str, Any]) -> FoundMesh:
    """The mesh of a file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    lines = FileLines(f"{job['key']}.file", job["name"], Path(job["file"]))
    nodes: dict[int, tuple[float, ...]] = {}
    elements: dict[int, list[list[int]]] = {}
    properties: dict[int, list[int]] = {}
    numbers: set[int] = set()
    for card in _cards(_bulk(lines)):
        if card.word == "GRID":
            _take_point(card, nodes)
        elif card.word in _CARDS:
            kind, found = _nodes(card)
            number = card.whole(0)
            if number in numbers:
                raise card.line.error(f"the element {number} is defined twice")
            numbers.add(number)
            elements.setdefault(kind, []).append(found)
            properties.setdefault(kind, []).append(card.whole(1) if card.fields[1] else number)
        elif _UNKNOWN.fullmatch(card.word):
            raise card.line.error(
                f"elements {card.word} are not read; there are: {', '.join(sorted(_CARDS))}"
            )
        elif card.word == "GRDSET" and card.fields[1] not in ("", "0"):
            raise _in_local_system(card, card.fields[1])
    if not nodes or not elements:
        raise lines.error("has no grid points (GRID), or no elements (CTETRA, CHEXA, CQUAD4, …)")
    return FoundMesh(
        np.array(list(nodes), dtype=np.int64),
        np.array(list(nodes.values()), dtype=np.float64),
        {kind: as_gmsh(kind, np.array(found)) for kind, found in elements.items()},
        _sets(properties),
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
        raise lines.error("ends before ENDDATA: is the file truncated?")


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


def _cards(lines: Iterator[Line]) -> Iterator[_Card]:
    """Cards, each with the lines that continue it."""
    card: _Card | None = None
    for line in lines:
        if card is None or not card.goes_on(line):
            if card is not None:
                yield card
            card = _Card(line)
    if card is not None:
        yield card


def _take_point(card: _Card, nodes: dict[int, tuple[float, ...]]) -> None:
    system = card.fields[1]
    if system not in ("", "0"):
        raise _in_local_system(card, system)
    number, point = card.whole(0), (card.real(2), card.real(3), card.real(4))
    if nodes.setdefault(number, point) != point:
        raise card.line.error(f"defines the grid point {number} again, elsewhere")


def _in_local_system(card: _Card, system: str) -> Exception:
    return card.line.error(
        f"{card.word} gives points in the coordinate system {system[:20]}, which is not read; "
        "write them in the basic system"
    )


def _nodes(card: _Card) -> tuple[int, list[int]]:
    """Gmsh's type of an element, and its nodes in the order of most programs."""
    kinds = _CARDS[card.word]
    most = max(kinds)
    given = [bool(word) for word in card.fields[2 : 2 + most]]
    count = next((n for n in sorted(kinds) if sum(given) == n and all(given[:n])), 0)
    if not count:
        wanted = " or ".join(map(str, sorted(kinds)))
        raise card.line.error(f"{card.word} wants {wanted} nodes, but has {sum(given)}")
    found = [card.whole(2 + place) for place in range(count)]
    if NAMES[kinds[count]] == "Hexahedron 20":
        found = [found[place] for place in _HEXAHEDRON]
    return kinds[count], found


def _sets(properties: dict[int, list[int]]) -> dict[str, dict[int, Any]]:
    """Rows of elements by property number, and Gmsh's type."""
    found: dict[int, dict[int, Any]] = {}
    for kind, of_kind in properties.items():
        values, inverse = np.unique(np.array(of_kind), return_inverse=True)
        for place, value in enumerate(values):
            found.setdefault(int(value), {})[kind] = np.flatnonzero(inverse == place)
    return {str(value): found[value] for value in sorted(found)}
