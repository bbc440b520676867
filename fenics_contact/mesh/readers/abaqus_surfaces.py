"""Surfaces of an Abaqus file: the sides of elements, or nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.readers.abaqus_elements import Elements
from fenics_contact.mesh.readers.abaqus_sets import whole_number
from fenics_contact.mesh.readers.element_kinds import SIDES, dimension_of
from fenics_contact.mesh.readers.file_lines import Line
from fenics_contact.mesh.readers.found_mesh import outer_sides

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
        """Surfaces of sides by name: their nodes, by Gmsh's type.

        Args:
            elements: All of the mesh.
            members: Of sets.
        """
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
        """Surfaces of nodes by name: the nodes' numbers.

        Args:
            members: Of sets.
        """
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
        side, places = SIDES[kind]
        if label in [f"S{number}" for number in range(1, len(places) + 1)]:
            return {side: nodes[:, np.array(places[int(label[1:]) - 1])]}
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
        return f"; there are S1 to S{len(SIDES[kind][1])}"
    return ", which are no cells; a surface of these elements themselves has no label"
