"""Suggestions for unknown words; the one place that decides them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path


def nearest(word: str, known: Iterable[str], most: int = 1) -> list[str]:
    """The known words that a word resembles, whatever its capitals, blanks, '-' and '_'.

    Args:
        word: As it was given.
        known: What is accepted.
        most: How many to name at most.

    >>> nearest("Plane-Strain", ["plane stress", "plane strain"])
    ['plane strain']
    """
    import difflib  # when something is wrong; every command would load it

    plain: dict[str, str] = {}
    for name in known:
        plain.setdefault(_plain(name), name)
    wanted = _plain(word)
    if wanted in plain and most == 1:
        return [plain[wanted]]
    return [plain[found] for found in difflib.get_close_matches(wanted, plain, n=most)]


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The end of a sentence that says that a word is not known; empty if none resembles it.

    Args:
        word: As it was given.
        known: What is accepted.
    """
    near = nearest(word, known, most=2)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def question(word: str, known: Iterable[str]) -> str:
    """Return a suggestion in brackets, for a sentence that goes on.

    Args:
        word: As it was given.
        known: What is accepted.
    """
    near = nearest(word, known)
    return f" (did you mean '{near[0]}'?)" if near else ""


def nearest_file(path: Path) -> str:
    """Return a suggestion for a missing file, among files of its kind in the folder.

    Args:
        path: Of the file.
    """
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return ""
    same = {
        Path(name).stem: name for name in names if Path(name).suffix.lower() == path.suffix.lower()
    }
    if not same:
        return question(path.name, names)
    near = nearest(path.stem, same)  # a common ending makes no two names alike
    return f" (did you mean '{same[near[0]]}'?)" if near else ""


def _plain(word: str) -> str:
    return "".join(" " if letter in "-_" else letter for letter in word.casefold()).strip()
