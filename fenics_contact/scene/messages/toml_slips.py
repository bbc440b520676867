"""Messages on wrong TOML, by the line: slips of the pen, tables and keys that stand twice.

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
_EXAMINED = 2**18  # characters of a file whose lines are; a scene has a hundredth of it
_WIDEST = 1000  # characters of a line that is examined; the time grows with their square
_HEADER = re.compile(r"\s*(\[{1,2})\s*([\w.\"'-]+)\s*\]{1,2}\s*(?:#.*)?")
_KEY = re.compile(r"\s*([\w.\"'-]+)\s*=")
_SUM, _OPERATOR = re.compile(r"[-+(\d][-+*/^() \d.eE]*"), re.compile(r"[\d)] *[-+*/^] *[\d(]")
_QUOTED = re.compile(r"\"(?:\\.|[^\"\\])*\"|'[^']*'|#.*")


@dataclass(frozen=True)
class Slip:
    """One kind of slip.

    Attributes:
        words: What is wrong; with a '.' at the end, the repair is not what is to be written.
        repaired: The line as it should be; the same where the slip is not in it.
    """

    words: str
    repaired: Callable[[str], str]


def what_is_wrong(text: str, error: tomllib.TOMLDecodeError) -> str:
    """In one sentence: the line, what is wrong with it, and if known what to write.

    Args:
        text: Of the file.
        error: Of tomllib.
    """
    lines = text.split("\n")
    number = _line_of(error)
    said = ""
    place = min(number or len(lines), len(lines)) - 1
    if len(text) <= _EXAMINED and len(lines[place]) <= _WIDEST:
        if number is not None and number <= len(lines):
            said = _given_twice(lines, number) or (
                _unfinished(lines, number) if _begins(lines[number - 1]) else ""
            )
            said = said or _explained(lines, number) or _of_value(lines, number)
        else:
            said = _unfinished(lines, len(lines) + 1) or _last_quote(lines)
            said = said or _explained(lines, len(lines))
    return said or str(error)


def _explained(lines: list[str], number: int) -> str:
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
        if repaired != line and _is_sound([*before, repaired]):
            return [words], repaired
    together, said = line, list[str]()
    for slip in SLIPS:
        repaired = slip.repaired(together)
        if repaired != together:
            together, said = repaired, [*said, slip.words]
            if _is_sound([*before, together]):
                return said, together
    return [], line


def _is_sound(lines: list[str]) -> bool:
    """Whether TOML goes on beyond the last of these lines."""
    try:
        tomllib.loads("\n".join([*lines, ""]))
    except tomllib.TOMLDecodeError as error:
        place = _line_of(error)
        return place is None or place > len(lines)
    except (ValueError, RecursionError):
        return False
    return True


def _line_of(error: tomllib.TOMLDecodeError) -> int | None:
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


def _closed_quotes(line: str) -> str:
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
        _outside(
            r"(?<==)(\s*[+-]?[1-9]\d{0,2}(?:,\d{3})+\s*(?=$|[,}]))",
            lambda found: found[0].replace(",", ""),
        ),
    )
    yield (
        "the decimal sign is a point",
        _outside(r"(=\s*[+-]?\d+),(?=\d+(?:[eE][+-]?\d+)?\s*(?:$|[,}]))", r"\1."),
    )
    yield (
        "yes and no are written true and false",
        _outside(
            r"(?i)(=\s*)(true|false|yes|no|on|off)\b",
            lambda found: found[1] + _TRUTH[found[2].lower()],
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
    yield "a quotation mark is missing", Slip("", _closed_quotes)
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


SLIPS = tuple(Slip(words, slip.repaired) for words, slip in _slips())


def _given_twice(lines: list[str], number: int) -> str:
    """A table, or a key of a table, that is there already."""
    here = _HEADER.fullmatch(lines[number - 1])
    if here is not None:
        earlier = next(
            (n for n in range(1, number) if _is_header(lines[n - 1], here[2], here[1])), None
        )
        if earlier is None or _is_sound(lines[:number]):
            return ""
        where = f"lines {earlier} and {number}: [{here[2]}] is there twice"
        if here[2] in _lists():
            return f"{where}; of several each is [[{here[2]}]], the first one, too"
        return f"{where}; put its keys into one"
    key = _KEY.match(lines[number - 1])
    if key is None or _is_sound(lines[:number]):
        return ""
    for earlier in range(number - 1, 0, -1):
        if _HEADER.fullmatch(lines[earlier - 1]):
            return ""
        other = _KEY.match(lines[earlier - 1])
        if other is not None and other[1] == key[1]:
            rest = [*lines[: earlier - 1], "", *lines[earlier:number]]
            if _is_sound(rest):
                return f"lines {earlier} and {number}: {key[1]} is given twice; keep one of them"
    return ""


def _begins(line: str) -> bool:
    """Whether a line begins a table or gives a key a value."""
    return bool(_HEADER.fullmatch(line) or _KEY.match(line))


def _is_header(line: str, name: str, brackets: str) -> bool:
    """Whether a line begins a table of a name, with which another of these brackets is at odds."""
    found = _HEADER.fullmatch(line)
    return found is not None and found[2] == name and (found[1], brackets) != ("[[", "[[")


def _lists() -> list[str]:
    """Tables of which there may be several."""
    from fenics_contact.scene.reference import keys_of
    from fenics_contact.scene.scene import Scene

    return [key.name for key in keys_of(Scene) if key.is_list and key.tables]


def _unfinished(lines: list[str], number: int) -> str:
    """A list or an inline table that an earlier line begins, and none ends."""
    for earlier in range(min(number, len(lines)), 0, -1):
        line = lines[earlier - 1]
        if not _KEY.match(line):
            continue
        bare = _QUOTED.sub("", line)
        for (opening, closing), what in (("[]", "list"), ("{}", "table in braces")):
            if bare.count(opening) > bare.count(closing):
                return _ending(lines, earlier, opening + closing, what)
        if earlier < number:
            return ""
    return ""


def _ending(lines: list[str], number: int, brackets: str, what: str) -> str:
    """Return how to end a list or table that a line begins, if the text is then valid."""
    line = _QUOTED.sub(lambda found: "" if found[0][0] == "#" else found[0], lines[number - 1])
    mended = line.rstrip().rstrip(",") + brackets[1]
    if brackets == "{}" and _goes_on(line):
        return f"line {number}: a table in braces stands in one line"
    if not _is_sound([*lines[: number - 1], mended]):
        return ""
    return f"line {number}: the {what} has no end; write: {mended.strip()}"


def _goes_on(line: str) -> bool:
    """Whether an inline table goes on in the next line, which TOML does not allow."""
    return line.rstrip().endswith(("{", ","))


def _last_quote(lines: list[str]) -> str:
    """A text that goes to the end of the file."""
    for number, line in enumerate(lines, start=1):
        mended = _closed_quotes(line)
        if mended != line and _is_sound([*lines[: number - 1], mended]):
            return f"line {number}: a quotation mark is missing; write: {mended.strip()}"
    return ""


def _of_value(lines: list[str], number: int) -> str:
    """A value that is missing, that is to be worked out, or that has two keys of one name."""
    line = lines[number - 1]
    found = re.fullmatch(r"(\s*[\w.-]+\s*=)\s*(.*)", line)
    if found is None:
        return ""
    value = found[2].strip()
    if not value:
        return f"line {number}: the value is missing"
    if _SUM.fullmatch(value) and _OPERATOR.search(value):
        return f"line {number}: '{value}' is no number; TOML does not calculate"
    keys = re.findall(r"(?:[{,]|^)\s*([\w-]+)\s*=", _QUOTED.sub("", value))
    twice = [key for place, key in enumerate(keys) if key in keys[:place]]
    return f"line {number}: {twice[0]} is given twice; keep one of them" if twice else ""
