"""Sets of nodes and of elements as an Abaqus file defines them: numbers, ranges, other sets."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.file_lines import Line

LARGEST = 2**53  # a number of a node or of an element, at the most


def whole_number(line: Line, text: str) -> int:
    """A number of a node or of an element.

    Args:
        line: For messages.
        text: That number.
    """
    try:
        value = int(text)
    except ValueError:
        value = 0
    if not 0 < value < LARGEST:
        raise line.error(f"'{text.strip()[:40]}' must be a positive whole number")
    return value


@dataclass
class _Rule:
    """Rule of a set: each line's numbers, ranges (first, last, step) and names of sets."""

    name: str
    line: Line
    is_internal: bool = True
    numbers: list[tuple[Line, list[int]]] = field(default_factory=list)
    ranges: list[tuple[int, int, int]] = field(default_factory=list)
    names: list[tuple[Line, str]] = field(default_factory=list)

    def define(self, is_internal: bool) -> None:
        """Take note of a definition: a set is internal if all of its definitions are."""
        self.is_internal &= is_internal


class Sets:
    """All sets of nodes, or all of elements. Capital and small letters are the same in names.

    The part and the assembly may each have a set of the same name.

    Args:
        kind: What messages call its members: ``node`` or ``element``.
    """

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self._rules: dict[tuple[str, str], _Rule] = {}
        self._found: dict[tuple[str, str], Integers] = {}
        self._open: set[tuple[str, str]] = set()

    def begin(self, line: Line, scope: str, name: str, is_internal: bool = False) -> _Rule:
        """The set of a name, to which more may be added.

        Args:
            line: Of the keyword.
            scope: ``part`` or ``assembly``.
            name: As written.
            is_internal: Made by a program for its own use, and no group.
        """
        rule = self._rules.setdefault((scope, name.upper()), _Rule(name, line))
        rule.define(is_internal)
        return rule

    def read(self, rule: _Rule, lines: Iterable[Line], generate: bool, numbered: bool) -> None:
        """Add the lines that follow ``*NSET`` or ``*ELSET``.

        Args:
            rule: Of the set.
            lines: Of data.
            generate: Whether each line is a range.
            numbered: Whether numbers are those of the mesh, not of an assembly's own nodes.
        """
        for line in lines:
            words = [word.strip() for word in line.text.split(",")]
            words = [word for word in words if word]
            if generate:
                first, last, *step = (whole_number(line, word) for word in words[:3])
                if len(words) not in (2, 3):
                    raise line.error("GENERATE wants first, last and step")
                if numbered:
                    rule.ranges.append((first, last, *(step or [1])))  # type: ignore[arg-type]
                continue
            is_number = [word.lstrip("-").isdigit() for word in words]
            rule.names.extend(
                (line, word.strip('"'))
                for word, is_it in zip(words, is_number, strict=True)
                if not is_it
            )
            found = [
                whole_number(line, word)
                for word, is_it in zip(words, is_number, strict=True)
                if is_it
            ]
            if found and numbered:
                rule.numbers.append((line, found))

    def groups(self, part: str) -> list[tuple[str, str, str, Line]]:
        """Scope, name, name of the group and place of all sets that are not internal.

        Args:
            part: Name of the part, which distinguishes its sets from those of the assembly.
        """
        found = []
        for (scope, upper), rule in self._rules.items():
            doubled = scope == "part" and ("assembly", upper) in self._rules
            if not rule.is_internal:
                group = f"{part}.{rule.name}" if doubled else rule.name
                found.append((scope, rule.name, group, rule.line))
        return found

    def members(self, scope: str, name: str, known: Integers, line: Line) -> Integers:
        """Numbers of a set, in order.

        Args:
            scope: Where it is named.
            name: Its name, or that of an instance, a dot and its name.
            known: Numbers that the mesh has, in order.
            line: Which names it, for messages.
        """
        key = self._key(scope, name)
        if key not in self._found:
            if key not in self._rules or key in self._open:
                reason = "holds itself" if key in self._open else "is not defined"
                raise line.error(f"the set of {self._kind}s '{name}' {reason}")
            self._open.add(key)
            self._found[key] = self._resolved(key[0], self._rules[key], known)
            self._open.remove(key)
        return self._found[key]

    def _key(self, scope: str, name: str) -> tuple[str, str]:
        upper = name.upper()
        if (scope, upper) in self._rules:
            return scope, upper
        return "part", upper if ("part", upper) in self._rules else upper.rpartition(".")[2]

    def _resolved(self, scope: str, rule: _Rule, known: Integers) -> Integers:
        pieces = [self.members(scope, name, known, line) for line, name in rule.names]
        for first, last, step in rule.ranges:
            within = known[np.searchsorted(known, first) : np.searchsorted(known, last, "right")]
            pieces.append(within[(within - first) % step == 0])
        numbers = np.array([n for _, several in rule.numbers for n in several], dtype=np.int64)
        missing = set(np.setdiff1d(numbers, known).tolist())
        for line, several in rule.numbers if missing else ():
            for number in missing.intersection(several):
                raise line.error(
                    f"the set '{rule.name}' has the {self._kind} {number}, which is not defined"
                )
        return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), numbers, *pieces]))
