"""Texts from files, such as names and titles, that cannot steer a terminal or a page."""

from __future__ import annotations

import re

# Characters that move the cursor, clear the screen, turn the direction of writing or show nothing,
# and halves of characters, which cannot be written at all. Not the end of a line and the tabulator,
# nor what joins letters and keeps them apart (U+200C, U+200D), which some languages need.
_STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b\u200e\u200f\u202a-\u202e\u2060-\u206f"
    "\ud800-\udfff\ufeff\ufff9-\ufffb\U000e0000-\U000e007f]"
)
_ENDS = re.compile("[\t\n\u2028\u2029]")


def printable(text: str) -> str:
    r"""A text with what would steer a terminal or a page written out.

    Args:
        text: Perhaps with names from files.

    >>> printable("\x1b[2Jblock")
    '\\x1b[2Jblock'
    """
    return _STEERING.sub(_written_out, text)


def one_line(text: str) -> str:
    r"""Return a text, such as a title, with ends of lines written out, too.

    Args:
        text: Perhaps with names from files.

    >>> one_line("block\nAll passed.")
    'block\\nAll passed.'
    """
    return _ENDS.sub(_written_out, printable(text))


def _written_out(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape").decode()
