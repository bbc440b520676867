"""Texts from files, such as names and titles, that cannot steer a terminal."""

from __future__ import annotations

import re

# Characters that move the cursor, clear the screen or turn the direction of writing, and halves of
# characters, which cannot be written at all; all but the end of a line and the tabulator.
_STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
_ENDS = re.compile("[\t\n\u2028\u2029]")


def printable(text: str) -> str:
    r"""A text with what would steer a terminal written out.

    Args:
        text: Perhaps with names from files.

    >>> printable("\x1b[2Jblock")
    '\\x1b[2Jblock'
    """
    return _STEERING.sub(_written_out, text)


def one_line(text: str) -> str:
    r"""The same of what is to stay in its line, such as a title.

    Args:
        text: Perhaps with names from files.

    >>> one_line("block\nAll passed.")
    'block\\nAll passed.'
    """
    return _ENDS.sub(_written_out, printable(text))


def _written_out(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape").decode()
