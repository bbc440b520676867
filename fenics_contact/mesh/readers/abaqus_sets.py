"""Sets and surfaces of an Abaqus file: numbers, ranges, sides of elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.abaqus_elements import Elements
from fenics_contact.mesh.readers.element_kinds import SIDES, dimension_of
from fenics_contact.mesh.readers.found_mesh import Line, outer_sides

LARGEST = 2**53  # a number of a node or of an element, at the most


def whole_number(line: Line, text: str) -> int:
    """A number of a node or of an element."""
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


# Labels of elements that are sides themselves, and of shells, by Abaqus and by CalculiX: both of
# their faces are the same side of the solid.
_LABELS = {False: ("", "SPOS", "SNEG"), True: ("", "SPOS", "SNEG", "S1", "S2")}
#: Numbers of a set, by kind (``NSET``, ``ELSET``), scope, name and the line that names it.
Members = Callable[[str, str, str, Line], Integers]
Facets = dict[int, Integers]


@dataclass
class _Surface:
    """A surface's name, where it stands, and what it is made of."""

    name: str
    scope: str
    kind: str
    data: list[Line]


class Surfaces:
    """Surfaces as they come in."""

    def __init__(self) -> None:
        self._surfaces: list[_Surface] = []

    def take(
        self, line: Line, options: Mapping[str, str], data: Sequence[Line], scope: str
    ) -> None:
        """Take a surface; those of other kinds, such as rigid ones, belong to no mesh.

        Args:
            line: Of the keyword.
            options: Of the keyword.
            data: Lines that follow.
            scope: ``part`` or ``assembly``.
        """
        kinds = {"ELEMENT": "ELSET", "NODE": "NSET"}
        kind = kinds.get(options.get("TYPE", "ELEMENT").upper())
        if kind is None or {"COMBINE", "CROP"} & set(options):
            return
        if not options.get("NAME"):
            raise line.error("*SURFACE wants a name: NAME=…")
        self._surfaces.append(_Surface(options["NAME"], scope, kind, list(data)))

    def of_sides(self, elements: Elements, members: Members) -> dict[str, Facets]:
        """Surfaces of sides by name: their nodes, by Gmsh's type."""
        found: dict[str, Facets] = {}
        for surface in self._surfaces:
            for line in surface.data if surface.kind == "ELSET" else ():
                numbers, label = _numbers(surface, line, members)
                facets = found.setdefault(surface.name, {})
                for kind, rows in elements.rows(numbers).items():
                    for side, nodes in _sides(line, elements, kind, rows, label).items():
                        facets[side] = np.concatenate([facets.get(side, nodes[:0]), nodes])
        return found

    def of_nodes(self, members: Members) -> dict[str, Integers]:
        """Surfaces of nodes by name: the nodes' numbers."""
        return {
            surface.name: np.concatenate(
                [_numbers(surface, line, members)[0] for line in surface.data]
            )
            for surface in self._surfaces
            if surface.kind == "NSET" and surface.data
        }


def _numbers(surface: _Surface, line: Line, members: Members) -> tuple[Integers, str]:
    """Return the elements that a line of a surface names, and the label that follows."""
    target, label = ([word.strip() for word in line.text.split(",")] + [""])[:2]
    if target.isdigit():
        return np.array([whole_number(line, target)]), label.upper()
    return members(surface.kind, surface.scope, target.strip('"'), line), label.upper()


def _sides(line: Line, elements: Elements, kind: int, rows: Integers, label: str) -> Facets:
    """Sides of some elements of one type: those of a number, all outer ones, or themselves."""
    nodes, dimension = elements.nodes[kind][rows], dimension_of(kind)
    is_shell = elements.are_shells[kind][rows].any()
    if dimension == elements.dimension - 1 and label in _LABELS[bool(is_shell)]:
        return {kind: nodes}
    if dimension == elements.dimension and not is_shell:
        if kind not in SIDES:  # no cell that is read: what it is, is said of the mesh as a whole
            return {}
        if not label:
            return outer_sides(elements.nodes, {kind: nodes}, dimension)
        if label in [f"S{number}" for number in range(1, len(SIDES[kind]) + 1)]:
            side, places = SIDES[kind][int(label[1:]) - 1]
            return {side: nodes[:, np.array(places)]}
    raise line.error(f"'{label}' names no side of these elements{_instead(elements, kind, rows)}")


def _instead(elements: Elements, kind: int, rows: Integers) -> str:
    """Return the labels in place of one that names no side, to follow the message."""
    dimension = dimension_of(kind)
    if elements.are_shells[kind][rows].any():
        if dimension == elements.dimension:
            return (
                ": they are shells, whose sides are their faces; cells of a plane model are of "
                "the types CPS…, CPE… or CAX…"
            )
        return ", which are shells; there are SPOS and SNEG, or S1 and S2"
    if dimension == elements.dimension:
        return f"; there are S1 to S{len(SIDES[kind])}"
    return ", which are no cells; a surface of these elements themselves has no label"
