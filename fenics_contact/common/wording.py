"""Words: for what is not known, plain names for what a file labels, texts that cannot do harm."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
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


_LONGEST = 40  # letters of a name
# What CAD kernels write where nobody has given a name.
_NONE = re.compile(
    r"(?:open cascade step translator.*|none|=>.*|"
    r"(?:solid|compound|compsolid|shell|face)[\d\s_.:]*)",
    re.IGNORECASE,
)


# Letters that have no plain one in Unicode's decompositions.
_PLAIN = str.maketrans(
    {"ß": "ss", "ẞ": "SS", "Ø": "O", "ø": "o", "Æ": "AE", "æ": "ae", "Ł": "L", "ł": "l"}
)


def plain_name(text: str) -> str:
    """A text as a name; empty if nothing of it can stand in one, or it is a mere number.

    >>> plain_name("Prüfkörper <1>: 'M8'"), plain_name("Fuß Ø8")
    ('Prufkorper_1_M8', 'Fuss_O8')
    """
    letters = (
        unicodedata.normalize("NFKD", text.translate(_PLAIN)).encode("ascii", "ignore").decode()
    )
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", letters.strip()).strip("_-")[:_LONGEST].strip("_-")
    return "" if name.isdigit() else name


def label_of(path: str) -> str:
    """The name of a part, from its label with those of the assemblies that it is in.

    >>> label_of("Shapes/joint/1/lower plate"), label_of("Shapes/SOLID"), label_of("")
    ('lower_plate', '', '')
    """
    label = path.strip().rpartition("/")[2].strip()
    return "" if _NONE.fullmatch(label) else plain_name(label)


def unique_names(labels: Sequence[str], otherwise: str, taken: Collection[str]) -> list[str]:
    """A name for each label: itself, or with a number where several things have it.

    Args:
        labels: As ``label_of`` gives them, or empty.
        otherwise: What stands before the number of a thing without a label.
        taken: Names that may not be given.

    >>> unique_names(["bolt", "", "bolt", "plate"], "body", {"body"})
    ['bolt_1', 'body_2', 'bolt_2', 'plate']
    """
    several = {label for label, count in Counter(labels).items() if count > 1} | set(taken)
    used = {*several, *labels}
    names: list[str] = []
    for place, label in enumerate(labels, start=1):
        number = place if not label else 1
        name = label if label and label not in several else f"{label or otherwise}_{number}"
        while name in used and name != label:
            number += 1
            name = f"{label or otherwise}_{number}"
        used.add(name)
        names.append(name)
    return names


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
