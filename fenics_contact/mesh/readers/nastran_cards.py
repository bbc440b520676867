"""Cards of Nastran's bulk data: their fields, and the lines that continue them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from fenics_contact.mesh.readers.found_mesh import Line

_EXPONENT = re.compile(r"(?<=[\d.])(?=[+-]\d+$)")
#: From which on no number of a card is a whole one that is sure.
LARGEST = 2**53


class Card:
    """A card of the bulk data.

    Attributes:
        line: Its first line.
        word: Its name, such as ``GRID``.
        fields: What follows the name, as texts.

    Args:
        line: Its first line.
    """

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
        """A field that holds a positive whole number.

        Args:
            place: Of the field, counted from 0 behind the name.
        """
        try:
            value = int(self.fields[place])
        except (IndexError, ValueError):
            value = 0
        if not 0 < value < LARGEST:
            raise self.line.error(
                f"field {place + 2} of {self.word} must be a positive whole number"
            )
        return value

    def real(self, place: int) -> float:
        """A field that holds a number, such as 1.5-3; zero where it is blank.

        Args:
            place: Of the field, counted from 0 behind the name.
        """
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


def cards(lines: Iterator[Line]) -> Iterator[Card]:
    """Cards, each with the lines that continue it."""
    card: Card | None = None
    for line in lines:
        if card is None or not card.goes_on(line):
            if card is not None:
                yield card
            card = Card(line)
    if card is not None:
        yield card
