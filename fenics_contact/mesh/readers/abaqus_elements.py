"""Elements of an Abaqus file by their numbers, and its element types as Gmsh's."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.mesh.readers.element_kinds import NAMES, dimension_of
from fenics_contact.mesh.readers.found_mesh import Line

#: What messages say that a mesh may have.
KNOWN_TYPES = (
    "C3D4, C3D8, C3D10, C3D20, CPS3, CPS4, CPS6, CPS8, CPE…, CAX…, shells and membranes (S3, M3D4, "
    "…), trusses and beams, with all letters that may follow"
)
_SOLIDS = {4: 4, 5: 7, 6: 6, 8: 5, 10: 11, 13: 19, 15: 18, 20: 17}
_FLAT = {3: 2, 4: 3, 6: 9, 8: 16, 9: 10}
# Nodes and letters that follow say how a type is integrated, which no mesh knows.
_FAMILIES = (
    (re.compile(r"(?:C|AC|DC)3D(\d+)[A-Z]*"), _SOLIDS),
    (re.compile(r"(?:CPS|CPEG?|CG?AX|[AD]C2D|[AD]CAX)(\d)[A-Z]*"), _FLAT),
    (re.compile(r"(?:DS|S|M3D|SFM3D|R3D)(\d)(?:[A-Z]+5?)?"), _FLAT),
    (re.compile(r"STRI(3|6)5?"), _FLAT),
    (re.compile(r"(?:T2D|T3D|R2D|RAX)(2)[A-Z]*"), {2: 1}),
)
# What cells in the plane are made for; those of heat and sound say only whether they are of
# revolution.
_KINEMATICS = {
    "CPEG": "generalised plane strain",
    "CPE": "plane strain",
    "CPS": "plane stress",
    "CAX": "axisymmetric",
    "CGAX": "axisymmetric",
    "DCAX": "axisymmetric",
    "ACAX": "axisymmetric",
}
_SHELLS = re.compile(r"(?:DS|STRI|S|M3D|SFM3D|R3D)\d.*")
# Beams of two nodes by their own numbering, and what is no part of a mesh of cells or facets.
_BEAMS = re.compile(r"B[23][13](?:H|OS|OSH)?|[SM]AX1")
_OTHERS = re.compile(
    r"[TB][23]D?[23][A-Z]*|[SM]AX2|MASS|ROTARYI|SPRING[A12]|DASHPOT[A12]|CONN[23]D2|DCOUP[23]D"
    r"|GAP\w*|HEATCAP"
)


def gmsh_type(name: str) -> int:
    """Gmsh's type of an element type; 0 of one that belongs to no mesh, -1 of one not known.

    Args:
        name: In capitals, such as ``C3D10M``.
    """
    for pattern, kinds in _FAMILIES:
        found = pattern.fullmatch(name)
        if found is not None and int(found[1]) in kinds:
            return kinds[int(found[1])]
    if _BEAMS.fullmatch(name):
        return 1
    return 0 if _OTHERS.fullmatch(name) else -1


def is_shell(name: str) -> bool:
    """Whether the sides of the type are its faces, not its edges."""
    return _SHELLS.fullmatch(name) is not None


def kinematics_of(name: str) -> str:
    """Return the kinematics of a type of plane elements, as in scenes; empty if unknown.

    Args:
        name: In capitals, such as ``CAX4``.
    """
    return next((kind for word, kind in _KINEMATICS.items() if name.startswith(word)), "")


def nodes_of(kind: int) -> int:
    """Nodes of an element of Gmsh's type."""
    return int(NAMES[kind].split()[1])


_NONE: Integers = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements by Gmsh's type.

    Attributes:
        nodes: Of each element, shape (elements, nodes).
        numbers: Of each element.
        are_shells: Whether its sides are its faces.
    """

    nodes: dict[int, Integers]
    numbers: dict[int, Integers]
    are_shells: dict[int, Flags]

    @property
    def dimension(self) -> int:
        """The largest of all."""
        return max(map(dimension_of, self.nodes), default=0)

    def rows(self, numbers: Integers) -> dict[int, Integers]:
        """Gmsh's type → rows of elements by their numbers; types without any are left out."""
        found = {
            kind: np.flatnonzero(np.isin(of_kind, numbers))
            for kind, of_kind in self.numbers.items()
        }
        return {kind: rows for kind, rows in found.items() if len(rows)}


class Blocks:
    """Elements as they come in."""

    def __init__(self) -> None:
        self._blocks: list[tuple[Line, Integers, int, Integers, bool]] = []

    def add(
        self, line: Line, numbers: Sequence[int], kind: int, nodes: Any, are_shells: bool
    ) -> None:
        """Add elements of one type.

        Args:
            line: Of their keyword.
            numbers: Of the elements.
            kind: Gmsh's type; 0 of what is no cell nor facet.
            nodes: Shape (elements, nodes).
            are_shells: Whether their sides are their faces.
        """
        found = np.array(numbers, dtype=np.int64)
        self._blocks.append((line, found, kind, np.asarray(nodes, np.int64), are_shells))

    def numbers(self) -> Integers:
        """Return the numbers of all elements, in order.

        Raises:
            RefusedError: Two elements have the same.
        """
        numbers = np.sort(np.concatenate([_NONE, *(block[1] for block in self._blocks)]))
        doubled = numbers[1:][numbers[1:] == numbers[:-1]]
        for line, found, *_ in self._blocks if len(doubled) else ():
            if np.isin(doubled[0], found):
                raise line.error(f"the element {doubled[0]} is defined twice")
        return numbers

    def joined(self) -> Elements:
        """All cells and facets, by type."""
        nodes, numbers, are_shells = {}, {}, {}
        for kind in dict.fromkeys(block[2] for block in self._blocks if block[2]):
            of_kind = [block for block in self._blocks if block[2] == kind]
            numbers[kind] = np.concatenate([block[1] for block in of_kind])
            nodes[kind] = np.concatenate([block[3] for block in of_kind])
            are_shells[kind] = np.repeat(
                [block[4] for block in of_kind], [len(block[1]) for block in of_kind]
            )
        return Elements(nodes, numbers, are_shells)
