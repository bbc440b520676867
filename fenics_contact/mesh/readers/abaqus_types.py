"""Element types of Abaqus and CalculiX as Gmsh's, by their families and numbers of nodes."""

from __future__ import annotations

import re

from fenics_contact.mesh.readers.element_kinds import NAMES

#: What messages say that a mesh may have.
KNOWN = (
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
