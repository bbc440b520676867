"""Labels of the faces of a STEP file, which Gmsh does not read: found in the file's text.

Gmsh numbers the faces of a solid in the order of the file. That they are the same is not taken for
granted: kinds and distances of corners of all faces of a solid must agree, or none gets a label.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import gmsh
import numpy as np

from fenics_contact.common.wording import label_of

_TEXT = r"'((?:[^']|'')*+)'"  # possessive: no text makes the search slow
_ENTITY = re.compile(rf"#(\d+)\s*=\s*([A-Z0-9_]+)\s*\(((?:[^';]|{_TEXT})*+);")
_REFERENCE = re.compile(r"#(\d+)")
_LABELLED = re.compile(rb"ADVANCED_FACE\s*\(\s*'(?!'|NONE')")
_KINDS = {
    "PLANE": "Plane",
    "CYLINDRICAL_SURFACE": "Cylinder",
    "CONICAL_SURFACE": "Cone",
    "SPHERICAL_SURFACE": "Sphere",
    "TOROIDAL_SURFACE": "Torus",
}
_SAME = 1e-6  # of distances, over the largest
_WIDE = re.compile(r"\\X2\\((?:[0-9A-Fa-f]{4})+)\\X0\\")
# From a face to its corners, by the entities in between.
_TO_CORNERS = ("FACE_OUTER_BOUND", "FACE_BOUND", "EDGE_LOOP", "ORIENTED_EDGE", "EDGE_CURVE")


def face_labels(path: str, solids: Sequence[int]) -> dict[int, list[tuple[int, str]]]:
    """Gmsh's numbers of labelled faces of solids, with their labels as names.

    Args:
        path: The STEP file, which Gmsh has open.
        solids: Gmsh's numbers, in order.
    """
    content = Path(path).read_bytes()
    if _LABELLED.search(content) is None:
        return {}
    file = _File(content.decode("latin-1"))
    shells = file.shells()
    if len(shells) != len(solids):  # a solid stands at several places
        return {}
    found = {}
    for solid, shell in zip(solids, shells, strict=True):
        faces = sorted(gmsh.model.getAdjacencies(3, solid)[1].tolist())
        if len(faces) == len(shell) and all(map(file.is_same, shell, faces)):
            labels = [label_of(file.label(entity)) for entity in shell]
            named = [(face, label) for face, label in zip(faces, labels, strict=True) if label]
            found[solid] = named
    return found


class _File:
    """The entities of a STEP file by their numbers."""

    def __init__(self, text: str) -> None:
        self._entities: Mapping[str, tuple[str, str]] = {
            number: (kind, arguments) for number, kind, arguments, _ in _ENTITY.findall(text)
        }

    def shells(self) -> list[list[str]]:
        """Faces of each solid, in the order of the file."""
        return [
            self._references(shell)
            for number, (kind, _) in self._entities.items()
            if kind == "MANIFOLD_SOLID_BREP"
            for shell in self._references(number)
        ]

    def label(self, face: str) -> str:
        """Return the name of a face."""
        found = re.match(rf"\s*{_TEXT}", self._entities[face][1])
        text = found[1].replace("''", "'") if found else ""
        return _WIDE.sub(lambda m: bytes.fromhex(m[1]).decode("utf-16-be", "replace"), text)

    def is_same(self, face: str, surface: int) -> bool:
        """Whether a face of the file and a surface of Gmsh have the same kind and corners."""
        if face not in self._entities:
            return False
        kinds = {self._entities.get(r, ("",))[0] for r in self._references(face)}
        kind = gmsh.model.getType(2, surface)
        if not kinds & {name for name, gmsh_kind in _KINDS.items() if gmsh_kind == kind}:
            return kind not in _KINDS.values() and not kinds & set(_KINDS)
        corners = gmsh.model.getBoundary([(2, surface)], recursive=True)
        theirs = _distances([gmsh.model.getValue(0, corner, []) for _, corner in corners])
        ours = _distances(self._corners(face))
        return len(ours) == len(theirs) and bool(
            np.allclose(ours, theirs, rtol=0, atol=_SAME * ours.max(initial=1e-300))
        )

    def _corners(self, face: str) -> list[list[float]]:
        """Coordinates of the corners of a face."""
        waiting, seen, places = [face], set(), []
        while waiting:
            for number in self._references(waiting.pop()):
                kind, arguments = self._entities.get(number, ("", ""))
                if number in seen:
                    continue
                seen.add(number)
                if kind in _TO_CORNERS:
                    waiting.append(number)
                elif kind == "VERTEX_POINT":
                    (point,) = _REFERENCE.findall(arguments)
                    numbers = self._entities[point][1].rpartition("(")[2].strip(") \n\r")
                    places.append([float(value) for value in numbers.split(",")])
        return places

    def _references(self, number: str) -> list[str]:
        """Numbers of the entities that one refers to."""
        return _REFERENCE.findall(re.sub(_TEXT, "", self._entities.get(number, ("", ""))[1]))


def _distances(points: Sequence[Sequence[float]]) -> np.ndarray:
    """Between all of some points, ascending: the same wherever they have been moved to."""
    places = np.array(points).reshape(-1, 3)
    first, second = np.triu_indices(len(places), k=1)
    return np.sort(np.linalg.norm(places[first] - places[second], axis=1))
