"""Messages on wrong TOML, by the line: slips in it, and tables and keys that stand twice."""

from __future__ import annotations

import re
import tomllib

from fenics_contact.scene.messages.toml_slips import closed_quotes, explained, is_sound, line_of

_LONGEST = 2**18  # characters of a file whose lines are examined; a scene has a hundredth of it
_WIDEST = 1000  # characters of a line that is examined; the time grows with their square
_HEADER = re.compile(r"\s*(\[{1,2})\s*([\w.\"'-]+)\s*\]{1,2}\s*(?:#.*)?")
_KEY = re.compile(r"\s*([\w.\"'-]+)\s*=")
_SUM, _OPERATOR = re.compile(r"[-+(\d][-+*/^() \d.eE]*"), re.compile(r"[\d)] *[-+*/^] *[\d(]")
_QUOTED = re.compile(r"\"(?:\\.|[^\"\\])*\"|'[^']*'|#.*")


def what_is_wrong(text: str, error: tomllib.TOMLDecodeError) -> str:
    """In one sentence: the line, what is wrong with it, and if known what to write.

    Args:
        text: Of the file.
        error: Of tomllib.
    """
    lines = text.split("\n")
    number = line_of(error)
    said = ""
    place = min(number or len(lines), len(lines)) - 1
    if len(text) <= _LONGEST and len(lines[place]) <= _WIDEST:
        if number is not None and number <= len(lines):
            said = _given_twice(lines, number) or (
                _unfinished(lines, number) if _begins(lines[number - 1]) else ""
            )
            said = said or explained(lines, number) or _of_value(lines, number)
        else:
            said = _unfinished(lines, len(lines) + 1) or _last_quote(lines)
            said = said or explained(lines, len(lines))
    return said or str(error)


def _given_twice(lines: list[str], number: int) -> str:
    """A table, or a key of a table, that is there already."""
    here = _HEADER.fullmatch(lines[number - 1])
    if here is not None:
        earlier = next(
            (n for n in range(1, number) if _is_header(lines[n - 1], here[2], here[1])), None
        )
        if earlier is None or is_sound(lines[:number]):
            return ""
        where = f"lines {earlier} and {number}: [{here[2]}] is there twice"
        if here[2] in _lists():
            return f"{where}; of several each is [[{here[2]}]], the first one, too"
        return f"{where}; put its keys into one"
    key = _KEY.match(lines[number - 1])
    if key is None or is_sound(lines[:number]):
        return ""
    for earlier in range(number - 1, 0, -1):
        if _HEADER.fullmatch(lines[earlier - 1]):
            return ""
        other = _KEY.match(lines[earlier - 1])
        if other is not None and other[1] == key[1]:
            rest = [*lines[: earlier - 1], "", *lines[earlier:number]]
            if is_sound(rest):
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
    if not is_sound([*lines[: number - 1], mended]):
        return ""
    return f"line {number}: the {what} has no end; write: {mended.strip()}"


def _goes_on(line: str) -> bool:
    """Whether an inline table goes on in the next line, which TOML does not allow."""
    return line.rstrip().endswith(("{", ","))


def _last_quote(lines: list[str]) -> str:
    """A text that goes to the end of the file."""
    for number, line in enumerate(lines, start=1):
        mended = closed_quotes(line)
        if mended != line and is_sound([*lines[: number - 1], mended]):
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
