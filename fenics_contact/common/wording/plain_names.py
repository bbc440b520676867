"""Names for what a file labels: of letters, digits, ``_`` and ``-`` only, and each once."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Sequence

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
