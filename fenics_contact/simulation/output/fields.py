"""Fields for ParaView: nodal values of a solution, in VTK's binary XML files."""

from __future__ import annotations

import base64
import html
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from dolfinx import plot
from numpy.typing import NDArray

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, in_3d
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import MachineError
from fenics_contact.common.parallel import on_root, raise_together
from fenics_contact.contact.state import OPEN, STICK
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.stress_at_places import NodalStress
from fenics_contact.evaluate.temperatures import NodalTemperatures
from fenics_contact.problem.problem import Problem
from fenics_contact.results.contact_points import BODY_OF_CELLS, facet_flags
from fenics_contact.solve.systems.solution import Solution

_ORDER = {"little": "LittleEndian", "big": "BigEndian"}[sys.byteorder]
# Before 2.1 the nodes of hexahedra of degree 2 had another order.
_VERSION = "2.2"
_TYPES = {"float64": "Float64", "int64": "Int64", "int16": "Int16", "uint8": "UInt8"}


def write_grid(
    folder: Path,
    stem: str,
    number: int,
    space: Any,
    fields: Mapping[str, Array],
    of_cells: Mapping[str, NDArray[Any]],
) -> str:
    """Write a grid with its fields, in one piece a rank; collective.

    Args:
        folder: Where to.
        stem: With which the names of the files begin.
        number: With which they end.
        space: Lagrange space whose nodes are the grid's points.
        fields: Values at the nodes of this rank, (nodes,) or (nodes, components).
        of_cells: Values of the cells that this rank owns, (cells,).

    Returns:
        The name of the file that holds the pieces together.

    Raises:
        MachineError: A file could not be written; on every rank.
    """
    comm = space.mesh.comm
    pieces = [f"{stem}_p{rank}_{number:06d}.vtu" for rank in range(comm.size)]
    cells, kinds, points = plot.vtk_mesh(space)
    # Cells that this rank owns, and only the nodes that these have.
    width = space.dofmap.dof_layout.num_dofs
    used, cells = np.unique(cells.reshape(-1, width + 1)[:, 1:], return_inverse=True)
    ends = (np.arange(len(kinds)) + 1) * width
    topology = {
        "connectivity": cells.reshape(-1).astype(np.int64),
        "offsets": ends.astype(np.int64),
        "types": np.asarray(kinds, dtype=np.uint8),
    }
    body = (
        f'<Piece NumberOfPoints="{len(used)}" NumberOfCells="{len(kinds)}">\n'
        + _block("Points", {"points": points[used]})
        + _block("Cells", topology)
        + _block("PointData", {name: values[used] for name, values in fields.items()})
        + _block("CellData", of_cells)
        + "</Piece>\n"
    )
    error: MachineError | None = None
    try:
        _write(folder / pieces[comm.rank], "UnstructuredGrid", body)
    except MachineError as caught:
        error = caught
    raise_together(comm, error)  # they are held together when all are written
    whole = f"{stem}{number:06d}.pvtu"
    on_root(comm, lambda: _write_whole(folder / whole, pieces, fields, of_cells))
    return whole


def _write_whole(
    path: Path,
    pieces: list[str],
    fields: Mapping[str, Array],
    of_cells: Mapping[str, NDArray[Any]],
) -> None:
    """The file that names the pieces of a grid."""
    names = "".join(f'<Piece Source="{piece}"/>\n' for piece in pieces)
    empty = {name: values[:0] for name, values in fields.items()}
    kinds = _block("PPoints", {"points": np.zeros((0, 3))}) + _block("PPointData", empty)
    kinds += _block("PCellData", of_cells)
    _write(path, "PUnstructuredGrid", kinds + names)


def write_collection(path: Path, grids: Mapping[str, float]) -> None:
    """Write a ``.pvd``, in one move: which grid is of which pseudo-time.

    Args:
        path: Of the file.
        grids: Names of the grids' files beside it → pseudo-time.
    """
    entries = (
        f'<DataSet timestep="{time!r}" part="0" file="{name}"/>\n' for name, time in grids.items()
    )
    _write(path, "Collection", "".join(entries))


def read_collection(path: Path) -> dict[str, float]:
    """Grids of a ``.pvd`` and their pseudo-times; none where there is no such file."""
    if not path.exists():
        return {}
    found = ElementTree.parse(path).getroot().iter("DataSet")
    return {entry.attrib["file"]: float(entry.attrib["timestep"]) for entry in found}


def _write(path: Path, kind: str, content: str) -> None:
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="{_VERSION}" byte_order="{_ORDER}" '
        f'header_type="UInt64">\n<{kind}>\n{content}</{kind}>\n</VTKFile>\n'
    )
    replace_file(path, text.encode("ascii"))


def _block(name: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    """A block of arrays; those whose name begins with P only announce them."""
    tag = "PDataArray" if name.startswith("PP") else "DataArray"
    lines = [f"<{name}>\n"]
    for key, values in arrays.items():
        width = values.shape[1] if values.ndim == 2 else 1
        kind = f'type="{_TYPES[values.dtype.name]}" Name={_quoted(key)}'
        kind += f' NumberOfComponents="{width}"'
        content = "" if tag.startswith("P") else _encoded(values)
        lines.append(f'<{tag} {kind} format="binary">{content}</{tag}>\n')
    return "".join([*lines, f"</{name}>\n"])


def _quoted(text: str) -> str:
    """Any text as an attribute of ASCII letters."""
    kept = html.escape(text).translate({ord(c): f"&#{ord(c)};" for c in "\t\n\r"})
    return '"' + kept.encode("ascii", "xmlcharrefreplace").decode("ascii") + '"'


def _encoded(values: NDArray[Any]) -> str:
    """An array's bytes behind their number, as VTK's binary arrays are."""
    raw = np.ascontiguousarray(values).tobytes()
    return base64.b64encode(np.uint64(len(raw)).tobytes() + raw).decode("ascii")


# Values of the field `status`.
NO_CONTACT, FIELD_OPEN, FIELD_STICK, FIELD_SLIP = -1.0, 0.0, 1.0, 2.0

# Of a time series. A node has 23 to 24 numbers, each 8 bytes in 4/3 characters, and its cells.
_MOST_STEPS, _MOST_BYTES, _BYTES_OF_A_NODE = 200, 2e9, 350


class FieldSeries:
    """``fields.pvd``, a time series of fields.

    Point data: displacement, stress (3 × 3), temperature where the scene gives such,
    contact_pressure, friction_traction, status (−1 off the contacts, 0 OPEN, 1 STICK, 2 SLIP),
    slip and gap (not a number where nothing stands opposite), what laws keep of their own (these,
    as pressure and traction, 0 off the contacts) and, where a contact is not prescribed,
    reaction_pressure, which knows nothing of the penalty.
    Cell data: body, the number of the connected part, in the order of `model.bodies`; and of each
    contact the facets that carry it, see ``facet_flags``.

    Args:
        problem: The model.
        folder: Where to.
        resumed: Pseudo-time up to which the series that is there is kept; None to begin anew.

    Attributes:
        most: How many steps it should hold: these 200, or fewer where they would fill the disk.
        last: Pseudo-time of the last fields, None before there are any.
    """

    def __init__(self, problem: Problem, folder: Path, resumed: float | None = None) -> None:
        self._problem, self._path = problem, folder / "fields.pvd"
        self._grids: dict[str, float] = {}
        if resumed is not None:
            found = on_root(problem.comm, lambda: read_collection(self._path))
            self._grids = {name: time for name, time in found.items() if time <= resumed}
        self.last = max(self._grids.values(), default=None)
        self._stress = NodalStress(problem)
        self._cells = _cell_fields(problem)
        given = problem.scene.has_temperatures
        self._temperatures = NodalTemperatures(problem) if given else None
        nodes = problem.spaces.displacement_space.dofmap.index_map.size_global
        self.most = int(np.clip(_MOST_BYTES // (_BYTES_OF_A_NODE * nodes), 2, _MOST_STEPS))

    def write(self, forces: BulkForces, time: float, number: int) -> None:
        """Write the fields of a step that was just solved; collective.

        Args:
            forces: Of its solution.
            time: Its pseudo-time.
            number: Of the step, from 1.
        """
        problem, solution = self._problem, forces.solution
        fields = {
            "displacement": in_3d(solution.displacement),
            "stress": self._stress.at_nodes().reshape(-1, 9),
            **_contact_fields(problem, solution),
            **_reaction_pressure(forces),
        }
        if self._temperatures is not None:
            fields["temperature"] = self._temperatures.values()
        folder, space = self._path.parent, problem.spaces.displacement_space
        name = write_grid(folder, self._path.stem, number, space, fields, self._cells)
        self._grids[name] = time
        on_root(problem.comm, lambda: write_collection(self._path, self._grids))
        self.last = time


def _contact_fields(problem: Problem, solution: Solution) -> dict[str, Array]:
    """Return the fields at the contacts' nodes, with the state variables of their laws.

    At a node of two contacts the later one's values stand.
    """
    count = len(problem.spaces.coordinates)
    pressure, status = np.zeros(count), np.full(count, NO_CONTACT)
    traction, slip, gap = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    own = {
        array.name: np.zeros((count, 3) if array.is_vector else count)
        for array in problem.own_arrays
    }
    for contact, at_points in zip(problem.contacts, solution.states, strict=True):
        trace, found = contact.trace, at_points.status
        numbers = np.select([found == OPEN, found == STICK], [FIELD_OPEN, FIELD_STICK], FIELD_SLIP)
        apart = np.where(np.isfinite(at_points.gap), at_points.gap, np.nan)
        _set(trace, pressure, at_points.contact_pressure)
        _set(trace, status, numbers)
        _set(trace, gap, apart)
        _set(trace, traction, at_points.friction_traction)
        _set(trace, slip, at_points.slip)
        for name, values in at_points.own.items():
            _set(trace, own[name], values)
    fields = {"contact_pressure": pressure, "friction_traction": traction, "status": status}
    return fields | {"slip": slip, "gap": gap} | own


def _set(trace: Trace, nodal: Array, values: Array) -> None:
    """Put values at the points of a contact, scalars or vectors, into an array of the nodes."""
    if values.ndim == 2:
        nodal[trace.nodes] = in_3d(values[: len(trace.nodes)])
    else:
        nodal[trace.all_nodes] = trace.at_every_node(values)


def body_of_cells(spaces: Spaces) -> dict[str, NDArray[Any]]:
    """Return the connected part of each cell that this rank owns."""
    topology = spaces.body.mesh.topology
    count = topology.index_map(topology.dim).size_local
    of_node = spaces.parts.of_node[spaces.displacement_space.dofmap.list[:count, 0]]
    return {BODY_OF_CELLS: of_node.astype(np.int16)}


def _cell_fields(problem: Problem) -> dict[str, NDArray[Any]]:
    """Return for each cell that this rank owns its body, and its facets of each contact."""
    fields = body_of_cells(problem.spaces)
    count = len(fields[BODY_OF_CELLS])
    for contact in problem.contacts:
        flags = np.zeros(count, dtype=np.uint8)
        cells, facets = contact.trace.surface.parents.T
        np.bitwise_or.at(flags, cells, (1 << facets).astype(np.uint8))
        fields[facet_flags(contact.label)] = flags
    return fields


def _reaction_pressure(forces: BulkForces) -> dict[str, Array]:
    """Pressure from the bulk's nodal forces on the contacts that push, if there are any."""
    contacts = forces.problem.contacts
    pushing = [i for i, contact in enumerate(contacts) if not contact.normal.pressure_is_known]
    if not pushing:
        return {}
    nodal = np.zeros(len(forces.problem.spaces.coordinates))
    for number in pushing:
        nodal += contacts[number].trace.surface.on_body(forces.pressure(number))
    return {"reaction_pressure": nodal}
