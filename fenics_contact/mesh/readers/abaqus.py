"""Meshes of Abaqus and CalculiX (``.inp``): nodes, elements, sets and surfaces.

meshio's reader of this format knows neither surfaces nor most plane elements, and loses nodes and
sets that come in several blocks. Gmsh reads none.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.abaqus_elements import (
    KNOWN_TYPES,
    Blocks,
    gmsh_type,
    is_shell,
    kinematics_of,
    nodes_of,
)
from fenics_contact.mesh.readers.abaqus_sets import Sets, Surfaces, whole_number
from fenics_contact.mesh.readers.element_kinds import as_gmsh
from fenics_contact.mesh.readers.found_mesh import FileLines, FoundMesh, Line

# They make, move or copy nodes and elements, each in a way of its own.
_MAKERS = frozenset(
    ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL", "IMPORT")
)
_OF_GMSH = re.compile(r"\*+ E L E M E N T S \*+")
_FLATTEN = "export the mesh flat, without parts and instances, and each part as a file of its own"


@dataclass
class _Block:
    """A keyword with its options, and the lines of data that follow."""

    word: str
    options: dict[str, str]
    line: Line
    data: list[Line] = field(default_factory=list)


def read(job: dict[str, Any]) -> FoundMesh:
    """The mesh of a file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    lines = FileLines(f"{job['key']}.file", job["name"], Path(job["file"]))
    reader = _Reader(lines)
    for block in _blocks(_statements(lines, lines.lines())):
        reader.take(block)
    return reader.mesh()


def _statements(lines: FileLines, found: Iterator[Line]) -> Iterator[Line]:
    """Lines that say something, of a file and of those that it includes; a keyword's in one."""
    for line in found:
        text = line.text.strip()
        if not text or text.startswith("**"):
            continue
        if text.startswith("*"):
            while text.endswith(","):
                text += next(found, Line("", line.file, line.number)).text.strip() or " "
            word, options = _keyword(text)
            if word == "INCLUDE":
                yield from _statements(lines, lines.included(line, options.get("INPUT", "")))
                continue
        yield Line(text, line.file, line.number)


def _blocks(statements: Iterator[Line]) -> Iterator[_Block]:
    """Keywords, each with its lines of data."""
    block: _Block | None = None
    for line in statements:
        if line.text.startswith("*"):
            if block is not None:
                yield block
            block = _Block(*_keyword(line.text), line)
        elif block is not None:
            block.data.append(line)
    if block is not None:
        yield block


def _keyword(text: str) -> tuple[str, dict[str, str]]:
    """A keyword and its options, both in capitals; values of options as written."""
    word, *options = text[1:].split(",")
    found = {}
    for option in options:
        name, _, value = option.partition("=")
        found["".join(name.split()).upper()] = value.strip().strip('"')
    return " ".join(word.split()).upper(), found


class _Reader:
    """Puts a mesh together from keywords in the order of the file.

    Args:
        lines: Of the file, for messages.
    """

    def __init__(self, lines: FileLines) -> None:
        self._lines = lines
        self._scope = "part"
        self._part = ""
        self._seen: dict[str, Line] = {}
        self._nodes: dict[int, tuple[float, ...]] = {}
        self._blocks = Blocks()
        self._sets = {"NSET": Sets("node"), "ELSET": Sets("element")}
        self._surfaces = Surfaces()
        self._kinematics: dict[str, str] = {}
        self._takers: dict[str, Callable[[_Block], None]] = {
            "PART": self._begin_part,
            "ASSEMBLY": self._change_scope,
            "INSTANCE": self._begin_instance,
            "END INSTANCE": self._change_scope,
            "NODE": self._take_nodes,
            "ELEMENT": self._take_elements,
            "NSET": self._take_set,
            "ELSET": self._take_set,
            "SURFACE": self._take_surface,
        }

    def take(self, block: _Block) -> None:
        """Take what belongs to the mesh; pass over the rest."""
        if block.word in _MAKERS:
            raise block.line.error(
                f"*{block.word} is not read; write all nodes and elements out, in the global system"
            )
        if block.word in self._takers:
            if block.options.get("INPUT"):
                inputs = self._lines.included(block.line, block.options["INPUT"])
                block.data.extend(_statements(self._lines, inputs))
            self._takers[block.word](block)

    def mesh(self) -> FoundMesh:
        """All that was taken."""
        elements, numbers = self._blocks.joined(), self._blocks.numbers()
        if not self._nodes or not elements.nodes:
            raise self._lines.error("has no nodes (*NODE), or no elements (*ELEMENT)")
        nodes = np.array(list(self._nodes), dtype=np.int64)
        points = np.array(list(self._nodes.values()), dtype=np.float64)
        known = {"NSET": np.sort(nodes), "ELSET": numbers}

        def members(kind: str, scope: str, name: str, line: Line) -> Integers:
            return self._sets[kind].members(scope, name, known[kind], line)

        groups = {
            kind: {
                group: sets.members(scope, name, known[kind], line)
                for scope, name, group, line in sets.groups(self._part)
            }
            for kind, sets in self._sets.items()
        }
        return FoundMesh(
            nodes,
            points,
            elements.nodes,
            elements.numbers,
            {name: elements.rows(found) for name, found in groups["ELSET"].items()},
            self._surfaces.of_sides(elements, members),
            self._surfaces.of_nodes(members) | groups["NSET"],
            {} if self._is_of_gmsh() else self._kinematics,
        )

    def _is_of_gmsh(self) -> bool:
        """Whether Gmsh wrote the file: it calls all plane elements CPS, whatever they are for."""
        said = set(self._kinematics) == {"plane stress"}
        return said and any(_OF_GMSH.match(line.text) for line in self._lines.lines())

    def _begin_part(self, block: _Block) -> None:
        self._once(block)
        self._scope, self._part = "part", block.options.get("NAME", "")

    def _begin_instance(self, block: _Block) -> None:
        self._once(block)
        if block.data:
            raise block.data[0].error(f"the instance is moved, which is not read; {_FLATTEN}")
        self._scope = "part"

    def _once(self, block: _Block) -> None:
        if self._seen.setdefault(block.word, block.line) is not block.line:
            raise block.line.error(f"is a second *{block.word}, where one is read; {_FLATTEN}")

    def _change_scope(self, block: _Block) -> None:
        self._scope = "assembly"

    def _take_nodes(self, block: _Block) -> None:
        if self._scope == "assembly":  # reference points, which are numbered anew
            return
        if block.options.get("SYSTEM", "R").upper() != "R":
            raise block.line.error("*NODE wants coordinates in the global system, without SYSTEM")
        taken = []
        for line in block.data:
            number, *words = line.text.split(",")
            taken.append(whole_number(line, number))
            try:
                point = tuple(float(word) for word in words[:3] if word.strip())
            except ValueError:
                point = ()
            if not point:
                raise line.error("a node wants its number and its coordinates, such as 7, 0.5, 1.0")
            point = (*point, 0.0, 0.0)[:3]
            if self._nodes.setdefault(taken[-1], point) != point:
                raise line.error(f"defines the node {taken[-1]} again, elsewhere")
        self._add_to_set("NSET", block, taken)

    def _take_elements(self, block: _Block) -> None:
        name = block.options.get("TYPE", "").upper()
        kind = gmsh_type(name)
        if kind < 0:
            raise block.line.error(
                f"elements of TYPE = '{name}' are not known; there are: {KNOWN_TYPES}"
            )
        if kind == 0:
            numbers = [whole_number(line, line.text.split(",")[0]) for line in block.data]
            self._blocks.add(block.line, numbers, kind, np.zeros((len(numbers), 0)), False)
        else:
            rows = _rows(block, name, kind)
            numbers = rows[:, 0].tolist()
            nodes = as_gmsh(kind, rows[:, 1:])
            self._blocks.add(block.line, numbers, kind, nodes, is_shell(name))
            if said := kinematics_of(name):
                self._kinematics.setdefault(said, name)
        self._add_to_set("ELSET", block, numbers)

    def _add_to_set(self, kind: str, block: _Block, numbers: list[int]) -> None:
        """Add the entries under a keyword to the set that the keyword names."""
        if block.options.get(kind):
            rule = self._sets[kind].begin(block.line, self._scope, block.options[kind])
            rule.numbers.append((block.line, numbers))

    def _take_set(self, block: _Block) -> None:
        options, kind = block.options, block.word
        if not options.get(kind):
            raise block.line.error(f"*{kind} wants a name: {kind}=…")
        rule = self._sets[kind].begin(block.line, self._scope, options[kind], "INTERNAL" in options)
        numbered = self._scope == "part" or "INSTANCE" in options
        self._sets[kind].read(rule, block.data, "GENERATE" in options, numbered)
        if kind == "NSET" and options.get("ELSET"):
            raise block.line.error("*NSET of an ELSET is not read; list its nodes")

    def _take_surface(self, block: _Block) -> None:
        self._surfaces.take(block.line, block.options, block.data, self._scope)


def _rows(block: _Block, name: str, kind: int) -> Integers:
    """Numbers of elements and their nodes, which may go over several lines."""
    width = 1 + nodes_of(kind)
    try:
        words = [int(w) for line in block.data for w in line.text.split(",") if w.strip()]
        found = np.array(words, dtype=np.int64)
    except (ValueError, OverflowError):
        found = np.zeros(1, dtype=np.int64)
    if (found <= 0).any():
        for line in block.data:
            for word in line.text.split(","):
                if word.strip():
                    whole_number(line, word)
    if len(found) % width:
        raise block.line.error(
            f"elements of TYPE = '{name}' want a number and {width - 1} nodes each; those that "
            "follow have more or fewer"
        )
    return found.reshape(-1, width)
