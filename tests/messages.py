"""Sentences that the program says to users: tests name them, and ``messages.toml`` has them whole.

There … stands for what varies with the machine, the number of ranks or a library, and {key} for
what the test gives by that keyword. ``python -m pytest --write-messages FILES`` writes sentences
that are new, or said in another way now.
"""

from __future__ import annotations

import difflib
import functools
import json
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from fenics_contact import InputError

FILE = Path(__file__).with_name("messages.toml")
ROOT = FILE.parent.parent
SENTENCES: dict[str, str] = tomllib.loads(FILE.read_text(encoding="utf-8"))
#: Sentences that this process has met, where it writes them.
WRITTEN: dict[str, str] | None = None


class refused:  # noqa: N801 (read as a verb, as pytest.raises)
    """Context of a statement that is refused by an error with this message.

    The error is its ``value`` afterwards.
    """

    def __init__(self, name: str, kind: Any = InputError, /, **values: object) -> None:
        self._name, self._kind, self._values = name, kind, values

    def __enter__(self) -> refused:
        return self

    def __exit__(self, kind: Any, error: Any, traceback: Any) -> bool:
        __tracebackhide__ = True
        if error is None:
            pytest.fail(f"nothing is refused, and expected is {self._name}")
        if not isinstance(error, self._kind):
            return False
        _require(self._name, [str(error)], self._values, is_said)
        self.value = error
        return True


def says(name: str, text: str, /, **values: object) -> None:
    """Assert that a line of a text, such as what a command writes, ends with this message."""
    __tracebackhide__ = True
    lines = [line.removeprefix("fenics-contact: ") for line in text.splitlines()]
    _require(name, lines or [""], values, ends_with)


def _require(name: str, lines: Sequence[str], values: dict[str, object], fits: Any) -> None:
    """Assert that a line fits the sentence of a name, or write the line that is most like it."""
    __tracebackhide__ = True
    known = SENTENCES if WRITTEN is None else SENTENCES | WRITTEN
    sentence = known.get(name)
    if sentence is None or not any(fits(sentence, line, values) for line in lines):
        line = difflib.get_close_matches(sentence, lines, 1, 0.0)[0] if sentence else lines[-1]
        found = with_holes(line, values)
        if WRITTEN is None or name in WRITTEN:
            expected = sentence or "no such message: --write-messages writes it"
            pytest.fail(f"{name}:\n" + "\n".join(difflib.ndiff([expected], [found])))
        sentence = found
    if WRITTEN is not None:
        WRITTEN[name] = sentence


def is_said(sentence: str, text: str, values: dict[str, object]) -> bool:
    """Whether a text is a sentence."""
    return re.fullmatch(_pattern(sentence, values), text) is not None


def ends_with(sentence: str, text: str, values: dict[str, object]) -> bool:
    """Whether a text ends with a sentence."""
    return re.search(rf"{_pattern(sentence, values)}\Z", text) is not None


def _pattern(sentence: str, values: dict[str, object]) -> str:
    """Regular expression of a sentence; what … stands for ends before a semicolon or a line."""
    for key, value in values.items():
        sentence = sentence.replace(f"{{{key}}}", str(value))
    return _escaped(sentence)


@functools.cache
def _escaped(sentence: str) -> str:
    return r"[^;\n]+?".join(map(re.escape, sentence.split("…")))


def with_holes(text: str, values: dict[str, object]) -> str:
    """A text without values of the test, and without the folders of test and repository."""
    for key, value in values.items():
        text = text.replace(str(value), f"{{{key}}}")
    return re.sub(r"/[^\s'\"]*/pytest-\d+/(?:popen-\w+/)?[^/\s'\":;]+", "…", text).replace(
        str(ROOT), "…"
    )


def write() -> None:
    """Write the file anew with what this process has met, sorted by name."""
    sentences = sorted((SENTENCES | (WRITTEN or {})).items())
    lines = [f"{name} = {json.dumps(said, ensure_ascii=False)}\n" for name, said in sentences]
    FILE.write_text("".join(lines), encoding="utf-8")
