"""Fields of other programs: values at places, and what they are in between.

From the nodes of a mesh with a field (``.vtu``, ``.xdmf``, ``.med``, read by meshio), or a table
(``.csv``). Between places a field is linear, on simplices that have these as corners (Delaunay).
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import FenicsContactError, InputError
from fenics_contact.common.parallel import largest, on_root, raise_together
from fenics_contact.mesh.geometry.process_room import RefusedError
from fenics_contact.mesh.readers.found_mesh import require_whole
from fenics_contact.mesh.readers.vtk_xml import mesh_of_vtu, mesh_of_xdmf

FORMATS = (".vtu", ".xdmf", ".med", ".csv")
# Of the extent of the places: beyond that a body is not inside them.
_BEYOND = 0.02
# Of the largest extent: places that spread less than that lie in a plane, or on a line.
_FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class ScatteredField:
    """Values at places, linear in between.

    Attributes:
        places: (places, 3) (length).
        values: (places,).
        words: What messages call it.
    """

    places: Array
    values: Array
    words: str

    def at(self, places: Array, dimension: int, comm: MPI.Comm) -> Array:
        """Values at other places; collective.

        A field whose places lie in a plane, or on a line, does not change across that.

        Args:
            places: (points, 3) (length).
            dimension: Of the body: 2 for places that have no z.
            comm: Of the ranks.

        Raises:
            InputError: On every rank; the body reaches beyond the places.
        """
        middle = self.places.mean(axis=0)
        known = (self.places - middle)[:, :dimension]
        extents, axes = np.linalg.svd(known, full_matrices=False)[1:]
        axes = axes[extents > _FLAT * extents.max(initial=0.0)]
        asked = (places - middle)[:, :dimension]
        known, asked = known @ axes.T, asked @ axes.T
        size = float(np.ptp(known, axis=0).max(initial=0.0))
        found, beyond = _interpolated(known, self.values, asked, _BEYOND * size)
        farthest = largest(comm, beyond)
        error: FenicsContactError | None = None
        if farthest > _BEYOND * size:
            error = InputError(
                f"{self.words}: the body reaches {farthest:.3g} beyond its places; they must be "
                "all around the body"
            )
        raise_together(comm, error)
        return found


def _interpolated(known: Array, values: Array, asked: Array, near: float) -> tuple[Array, Array]:
    """Values at places, and how far these are from the nearest that is known where outside."""
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import KDTree

    none = np.zeros(len(asked))
    if known.shape[1] == 0:  # one place: the same value everywhere
        return np.full(len(asked), values.mean()), none
    if known.shape[1] == 1:
        order = np.argsort(known[:, 0])
        line = known[order, 0]
        outside = np.maximum(line[0] - asked[:, 0], asked[:, 0] - line[-1]).clip(0.0)
        return np.interp(asked[:, 0], line, values[order]), outside
    found = LinearNDInterpolator(known, values)(asked).reshape(-1)
    outside, beyond = np.isnan(found), none
    if outside.any():
        distance, nearest = KDTree(known).query(asked[outside])
        found[outside] = values[nearest]
        # Just outside, as beside a curved side, the nearest place may be as far as they are apart.
        spacing = KDTree(known).query(known[np.unique(nearest)], k=2)[0][:, 1].max(initial=0.0)
        beyond[outside] = (distance - spacing).clip(0.0)
    return found, beyond


def load_field(file: str, name: str | None, key: str, comm: MPI.Comm) -> ScatteredField:
    """The field of a file; collective.

    Args:
        file: Path of the file.
        name: Of the field; None for the only one.
        key: Where the scene names it, such as ``temperature[0]``.
        comm: Of the ranks.

    Raises:
        InputError: On every rank, in one sentence.
    """

    def read() -> ScatteredField:
        where = f"{key}.file = '{file}'"
        path = Path(file)
        if path.suffix.lower() not in FORMATS:
            raise InputError(f"{where}: it must be one of {', '.join(FORMATS)}")
        if not os.path.isfile(path):
            raise InputError(f"{where}: there is no such file")
        try:
            places, values = _read(path, name, file, key)
        except RefusedError as error:
            raise InputError(str(error)) from None
        except InputError:
            raise
        except Exception as caught:  # whatever a damaged file makes of a reader
            said = " ".join(str(caught).split())
            raise InputError(f"{where}: cannot be read: {type(caught).__name__}: {said}") from None
        if len(places) == 0 or not (np.isfinite(places).all() and np.isfinite(values).all()):
            raise InputError(f"{where}: its places and values must be finite numbers")
        return ScatteredField(places, values, where)

    return on_root(comm, read)


def _read(path: Path, name: str | None, file: str, key: str) -> tuple[Array, Array]:
    """Places and values of a file."""
    where = f"{key}.file = '{file}'"
    if path.suffix.lower() == ".csv":
        if name is not None:
            raise InputError(f"{key}.field = '{name}': a table has none; leave it out")
        return _table(path, where)
    mesh = _mesh(path, where)
    fields = {
        found: np.asarray(values, dtype=np.float64).reshape(len(mesh.points), -1)
        for found, values in mesh.point_data.items()
    }
    scalars = {found: values[:, 0] for found, values in fields.items() if values.shape[1] == 1}
    return _in_space(np.asarray(mesh.points)), _chosen(scalars, name, key, where)


def _chosen(fields: Mapping[str, Array], name: str | None, key: str, where: str) -> Array:
    """The field of a name, or the only one."""
    known = ", ".join(f"'{found}'" for found in fields) or "none"
    if name is not None and name not in fields:
        raise InputError(
            f"{key}.field = '{name}': there is no such field of one value a node; there is {known}"
        )
    if name is None and len(fields) != 1:
        raise InputError(
            f"{where}: say which field of one value a node is meant, by field; there is {known}"
        )
    return fields[name] if name is not None else next(iter(fields.values()))


def _mesh(path: Path, where: str) -> Any:
    """What meshio finds in a file, of which nothing outside its folder is read."""
    if path.suffix.lower() == ".med":
        require_whole(where, path)
        from meshio.med import read

        return read(path)
    return mesh_of_vtu(where, path) if path.suffix.lower() == ".vtu" else mesh_of_xdmf(where, path)


def _table(path: Path, where: str) -> tuple[Array, Array]:
    """Rows of x, y, z (or x, y) and a value, below a line of names or none."""
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        rows = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    if rows and not _is_number(rows[0][0]):
        rows = rows[1:]
    if not rows or len(rows[0]) not in (3, 4) or any(len(row) != len(rows[0]) for row in rows):
        raise InputError(f"{where}: its rows must be x, y, z and a value (in the plane x, y)")
    try:
        numbers = np.array([[float(cell) for cell in row] for row in rows])
    except ValueError as error:
        raise InputError(f"{where}: {error}; its rows must be numbers") from None
    return _in_space(numbers[:, :-1]), numbers[:, -1]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _in_space(places: Array) -> Array:
    """Places with a z, (places, 3)."""
    found = np.zeros((len(places), 3))
    found[:, : places.shape[1]] = places
    return found
