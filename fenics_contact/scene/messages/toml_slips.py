"""Slips of the pen in one line of TOML: what is wrong, and the line as it should be.

A repair is only proposed where the line then is what TOML takes, so none can be misleading.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from fenics_contact.scene.messages.usual_names import NUMBER_SLIPS, key_of_symbol

# Texts in quotes and comments, in which nothing is repaired.
_KEPT = re.compile(r'("(?:\\.|[^"\\])*"|\'[^\']*\'|#.*)')
_LONGEST = 100  # characters of a line that a message repeats
_TYPOGRAPHY = str.maketrans(dict.fromkeys("“”„‟«»", '"') | dict.fromkeys("‘’‚‛", "'"))
_BLANKS = re.compile("[\u00a0\u2000-\u200b\u202f\u3000\ufeff]")
_WORD = (
    r"(?!(?:true|false|inf|nan)\b)"
    r"(?:\.{0,2}[A-Za-z_/~\\][^\"'=,\[\]{}#()*;]*?|[23][dD])"
)
_TRUTH = {"true": "true", "yes": "true", "on": "true", "false": "false", "no": "false"}
_TRUTH["off"] = "false"


@dataclass(frozen=True)
class Slip:
    """One kind of slip.

    Attributes:
        words: What is wrong; with a '.' at the end, the repair is not what is to be written.
        repaired: The line as it should be; the same where the slip is not in it.
    """

    words: str
    repaired: Callable[[str], str]


def explained(lines: list[str], number: int) -> str:
    """Return what is wrong with a line, and how it should be; empty if it is no known slip.

    Args:
        lines: Of the file.
        number: Of the line at which TOML stops, from 1.
    """
    line = lines[number - 1]
    words, repaired = _repair(lines[: number - 1], line)
    if not words:
        return ""
    shown = repaired.strip()
    is_shown = 0 < len(shown) <= _LONGEST and not any(said.endswith(".") for said in words)
    said = " and ".join(words).removesuffix(".")
    return f"line {number}: {said}{f'; write: {shown}' if is_shown else ''}"


def _repair(before: list[str], line: str) -> tuple[list[str], str]:
    """The first slip whose repair makes a line one of TOML, else all those that do together."""
    found = [(slip.words, slip.repaired(line)) for slip in SLIPS]
    for words, repaired in found:
        if repaired != line and is_sound([*before, repaired]):
            return [words], repaired
    together, said = line, list[str]()
    for slip in SLIPS:
        repaired = slip.repaired(together)
        if repaired != together:
            together, said = repaired, [*said, slip.words]
            if is_sound([*before, together]):
                return said, together
    return [], line


def is_sound(lines: list[str]) -> bool:
    """Whether TOML goes on beyond the last of these lines."""
    try:
        tomllib.loads("\n".join([*lines, ""]))
    except tomllib.TOMLDecodeError as error:
        place = line_of(error)
        return place is None or place > len(lines)
    except (ValueError, RecursionError):
        return False
    return True


def line_of(error: tomllib.TOMLDecodeError) -> int | None:
    """The line at which TOML stops, from 1; None at the end of the file."""
    found = re.search(r"\(at line (\d+), column \d+\)$", str(error))
    return int(found[1]) if found else None


def _outside(pattern: str | re.Pattern[str], into: str | Callable[[re.Match[str]], str]) -> Slip:
    """A repair of what stands neither in quotes nor in a comment; its words are added later."""
    compiled = re.compile(pattern)

    def repaired(line: str) -> str:
        parts = _KEPT.split(line)
        parts[::2] = [compiled.sub(into, part) for part in parts[::2]]
        return "".join(parts)

    return Slip("", repaired)


def _whole(pattern: str, into: str | Callable[[re.Match[str]], str]) -> Slip:
    return Slip("", lambda line: re.sub(pattern, into, line))


def _quoted(found: re.Match[str]) -> str:
    """A text in quotes; in single ones where a backslash is to stay one."""
    quote = "'" if "\\" in found["word"] else '"'
    return f"{found['before']}{quote}{found['word'].strip()}{quote}{found['after']}"


def _with_slashes(line: str) -> str:
    return re.sub(r'"[^"]*"', lambda found: found[0].replace("\\", "/"), line)


def _without_symbols(line: str) -> str:
    """A line whose key is a letter that TOML refuses, under the name that a scene has for it."""
    key, equals, value = line.partition("=")
    name = key_of_symbol(key.strip())
    return f"{name} ={value}" if name and equals and not key.strip().isascii() else line


def _header(line: str) -> str:
    found = re.fullmatch(r"\s*(\[{1,2})\s*([\w.-]+)\s*(\]{0,2})\s*(#.*)?", line)
    if found is None or len(found[1]) == len(found[3]):
        return line
    double = max(len(found[1]), len(found[3]))
    return f"{'[' * double}{found[2]}{']' * double}"


def closed_quotes(line: str) -> str:
    """A line whose last quotation mark is missing, with it; any other as it is."""
    bare = re.sub(r"\\.", "", line)
    for quote in "\"'":
        if bare.count(quote) % 2:
            head, comma, tail = line.rstrip().partition(f" {'}'}")
            return f"{head}{quote}{comma}{tail}"
    return line


def _slips() -> Iterator[tuple[str, Slip]]:
    """All of them; those that say more precisely what is wrong come first."""
    for words, pattern, into in NUMBER_SLIPS:
        yield words, _outside(pattern, into)
    yield (
        "a number has no comma: the decimal sign is a point, and thousands have none.",
        _outside(r"(?<==)(\s*[+-]?[1-9]\d{0,2}(?:,\d{3})+\s*(?=$|[,}]))", _without_commas),
    )
    yield (
        "the decimal sign is a point",
        _outside(r"(=\s*[+-]?\d+),(?=\d+(?:[eE][+-]?\d+)?\s*(?:$|[,}]))", r"\1."),
    )
    yield (
        "yes and no are written true and false",
        _outside(
            r"(?i)(=\s*)(true|false|yes|no|on|off)\b", lambda found: found[1] + _truth(found[2])
        ),
    )
    yield (
        "nothing has a value of that name: leave the key out",
        _outside(r"^\s*[\w.-]+\s*=\s*(?:None|none|null|nil|NULL)\s*$", ""),
    )
    yield "quotation marks are straight", Slip("", lambda line: line.translate(_TYPOGRAPHY))
    yield "a blank is a special character", Slip("", lambda line: _BLANKS.sub(" ", line))
    yield "the key has another name", Slip("", _without_symbols)
    yield "the brackets do not match", Slip("", _header)
    yield "a comma separates the entries of a list", _outside(r"(?<=[\d.])\s*;\s*(?=[-+.\d])", ", ")
    yield "a comment begins with #", _outside(r"\s*(?://|%|!|;(?=\s*\S)|--).*$", "")
    yield "nothing may follow a value", _outside(r"[;,]\s*$", "")
    yield "there is one = between key and value", _outside(r"\s*(?:==+|:=|=>)\s*", " = ")
    yield "= stands between key and value", _outside(r"^(\s*[\w.-]+)\s*:\s*(?=\S|$)", r"\1 = ")
    yield (
        "= is missing",
        _whole(r"^(\s*[\w.-]+)\s+(?=[\d+.\"'\[{-]|true\b|false\b)(?![^\"'#]*=)", r"\1 = "),
    )
    yield "a list needs square brackets", _outside(r"\(([^()]*)\)", r"[\1]")
    yield "a number has no blanks", _outside(r"(=\s*[+-]?\d{1,3})[ _'](?=\d{3}\b)", r"\1")
    yield "a comma is missing", _outside(r"(?<=[\w\]])\s+(?=[-+]?\d)(?=[^{}]*\])", ", ")
    yield "a comma is missing", _whole(r"(?<=[\w\]\"'])\s+(?=[\w.]+\s*=[^=]*\})", ", ")
    yield "a comma is missing", _whole(r"(?<=[\"'])\s+(?=[\"'])", ", ")
    yield "there is a comma too many", _outside(r",(\s*,)+", ",")
    yield (
        "a text needs quotes",
        _outside(
            rf"(?P<before>(?:(?<=\S)\s*\[|[=,])\s*)(?P<word>{_WORD})(?P<after>\s*(?=$|[,\]}}]))",
            _quoted,
        ),
    )
    yield "a quotation mark is missing", Slip("", closed_quotes)
    yield (
        "a backslash means something else in quotes, paths are written with /",
        Slip("", _with_slashes),
    )
    yield (
        "a number has no unit beside it",
        _outside(
            r"(=\s*[+-]?\d[\d.]*(?:[eE][+-]?\d+)?)\s*[A-Za-z%°µμ][\w/^²³*.%°]*\s*(?=$|[,}])", r"\1"
        ),
    )
    yield (
        "a key has no blanks",
        _outside(r"^\s*[A-Za-z]\w*(?:\s+\w+)+(?=\s*=)", lambda found: "_".join(found[0].split())),
    )


def _truth(word: str) -> str:
    return _TRUTH[word.lower()]


def _without_commas(found: re.Match[str]) -> str:
    return found[0].replace(",", "")


SLIPS = tuple(Slip(words, slip.repaired) for words, slip in _slips())
