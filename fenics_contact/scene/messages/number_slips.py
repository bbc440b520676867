"""Numbers as people and other programs write them, and as TOML does."""

from __future__ import annotations

import re
import tomllib

# What is no part of a longer number or word.
_ALONE = r"(?<![\w.])"
# What is wrong, how it is found, and what stands in its place. Order matters: signs first.
SLIPS = (
    ("a minus sign is -", re.compile("[−–](?=[.\\d])"), "-"),
    (
        "an exponent is written with e",
        re.compile(_ALONE + r"([+-]?[\d.]+)[dD]([+-]?\d+)\b"),
        r"\1e\2",
    ),
    ("a number begins with a digit", re.compile(r"(?<![\w.)\]\"'])([+-]?)\.(?=\d)"), r"\g<1>0."),
    (
        "a digit follows the point of a number",
        re.compile(_ALONE + r"([+-]?\d+)\.(?![\d\w])|" + _ALONE + r"([+-]?\d+)\.(?=[eE][+-]?\d)"),
        r"\1\2.0",
    ),
    ("a number has no zeros in front", re.compile(_ALONE + r"([+-]?)0+(?=\d)"), r"\1"),
)
# A decimal comma is one only where no list can be meant.
COMMA = re.compile(r"^(\s*[+-]?\d+),(\d+(?:[eE][+-]?\d+)?\s*)$")


def meant_number(text: str) -> str:
    """The number that a text was meant to be, as TOML writes it; or nothing.

    >>> meant_number(".3"), meant_number("0,3"), meant_number("2.1D5"), meant_number("top")
    ('0.3', '0.3', '2.1e5', '')
    """
    text = COMMA.sub(r"\1.\2", text.strip())
    for _, pattern, into in SLIPS:
        text = pattern.sub(into, text)
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return ""
    return text if isinstance(value, int | float) and not isinstance(value, bool) else ""
