"""Surfaces of rigid obstacles from files: triangles of an STL file, or a mesh of a CAD file.

Rank 0 has Gmsh read or mesh the file, in a process of its own as for bodies.
"""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root
from fenics_contact.mesh.geometry import gmsh_call
from fenics_contact.mesh.geometry.file_kinds import prepared, surface_file
from fenics_contact.mesh.loading import unit_of

_TIME_LIMIT = 300.0  # seconds that Gmsh may take
_NO_AREA = 1e-12  # of the square of the longest side
_MOST = 200_000  # triangles, all of which are looked at from every contact point
# Elements around a full turn, and in the largest side of the box around the obstacle.
_CURVATURE, _ACROSS = 60, 12


@dataclass(frozen=True, eq=False)
class RigidSurface:
    """Triangles of a surface, whose normals by their numbering point out of the obstacle.

    Attributes:
        points: All nodes, (points, 3) (length).
        triangles: Numbers of the nodes, corners first, then the middles of the sides 12, 02 and
            01 where they are curved, (triangles, 3 or 6).
    """

    points: Array
    triangles: AnyIntegers

    @property
    def order(self) -> int:
        """Order of the triangles' geometry, 1 or 2."""
        return 1 if self.triangles.shape[1] == 3 else 2


def load_surface(file: str, key: str, comm: MPI.Comm) -> RigidSurface:
    """The surface of an obstacle; collective.

    Args:
        file: Path of an ``.stl``, ``.step``, ``.stp`` or ``.brep`` file.
        key: Where the scene names it, such as ``contact[0].obstacle.file``.
        comm: Of the ranks.

    Raises:
        InputError: On every rank, in one sentence.
    """

    def read() -> RigidSurface:
        path = surface_file(key, file).path
        found = os.stat(path)
        return _read(file, key, found.st_mtime_ns, found.st_size)

    return on_root(comm, read)


@lru_cache(maxsize=8)
def _read(file: str, key: str, changed: int, size: int) -> RigidSurface:
    """The surface of a file as it is at present; meshed once, as further problems need it, too."""
    source = surface_file(key, file)
    job = {"key": key, "name": file, "kind": source.kind, "format": source.form, "surface": True}
    job |= {"curvature": _CURVATURE, "across": _ACROSS, "unit": unit_of(source)}
    limits = gmsh_call.Limits(key.removesuffix(".file"), _TIME_LIMIT, is_fixed=True)
    with tempfile.TemporaryDirectory(prefix="fenics_contact_") as folder:
        ready = prepared(source, Path(folder))
        job |= {"file": str(ready.path), "folder": folder}
        _, arrays = gmsh_call.call(ready, job, b"", limits)
    points, triangles = arrays["points"], arrays["triangles"].astype(np.int64)
    outward = _outward(points, triangles[_have_areas(points, triangles)])
    if not 0 < len(outward) <= _MOST:
        what = "has no surface" if len(outward) == 0 else f"has {len(outward)} triangles"
        raise InputError(f"{key} = '{file}': {what}; an obstacle has 1 to {_MOST} of them")
    return RigidSurface(points, outward)


def _have_areas(points: Array, triangles: AnyIntegers) -> Flags:
    """Flags of triangles whose area is more than round-off, (triangles,)."""
    corners = points[triangles[:, :3]]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    lengths = np.linalg.norm(sides, axis=2).max(axis=1, initial=0.0)
    return np.asarray(areas > _NO_AREA * lengths**2)


def _outward(points: Array, triangles: AnyIntegers) -> AnyIntegers:
    """Turn the triangles of a closed surface whose normals point inwards, by its volume."""
    corners = triangles[:, :3]
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]))
    _, counts = np.unique(edges, axis=0, return_counts=True)
    a, b, c = points[corners].transpose(1, 0, 2)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
    if len(triangles) == 0 or (counts != 2).any() or volume > 0:
        return triangles
    other_way = [0, 2, 1] if triangles.shape[1] == 3 else [0, 2, 1, 3, 5, 4]
    return triangles[:, other_way]
