"""Boxes, rings and pairs of blocks that cases of verification are made of."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from dolfinx import fem, mesh
from mpi4py import MPI

from fenics_contact import Group
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.scene.values import AxisName, Value
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.case import UntrustedError, note_mesh

COMM = MPI.COMM_WORLD


@dataclass(frozen=True)
class Box:
    """A box, named, from one corner to the opposite one, with cells along each axis."""

    name: str
    low: tuple[float, ...]
    high: tuple[float, ...]
    cells: tuple[int, ...]


def boxes(
    parts: Sequence[Box],
    cell: str = "quadrilateral",
    comm: MPI.Comm = COMM,
    order: int = 1,
    welded: Sequence[Sequence[str]] = (),
    closed: Sequence[str] = (),
) -> Body:
    """Boxes as one mesh; groups such as ``upper`` and ``upper.y0``.

    Args:
        parts: The boxes.
        cell: Kind of their cells.
        comm: Communicator; collective.
        order: Of the cells' geometry.
        welded: Names of boxes that share the nodes that lie in the same place; others are apart.
        closed: Names of boxes whose two ends along the first axis are one: a map of their points
            makes rings of them.
    """
    dimension = len(parts[0].cells)
    points: list[Array] = []
    cells, owner = [], []
    for number, box in enumerate(parts):
        make = mesh.create_rectangle if dimension == 2 else mesh.create_box
        ends = [np.array(box.low), np.array(box.high)]
        made = make(MPI.COMM_SELF, ends, list(box.cells), getattr(mesh.CellType, cell))
        nodes, where = compat.geometry_nodes(made), made.geometry.x
        if order == 2:  # the nodes of such cells are numbered as those of elements are
            space = fem.functionspace(made, ("Lagrange", 2))
            nodes, where = space.dofmap.list, space.tabulate_dof_coordinates()
        cells.append(nodes + sum(len(p) for p in points))
        points.append(where[:, :dimension])
        owner.append(np.full(len(cells[-1]), number + 1, dtype=np.int32))
    places, corners = np.concatenate(points), np.concatenate(cells).astype(np.int64)
    if welded or closed:
        names = [next((n for n in welded if part.name in n), [part.name])[0] for part in parts]
        of_part = [sorted(set(names)).index(name) for name in names]
        body = np.repeat(of_part, [len(part) for part in points])
        keys = np.column_stack([places.round(9), body])
        for part, number in zip(parts, of_part, strict=True):
            if part.name in closed:
                ends = (body == number) & np.isclose(keys[:, 0], part.high[0])
                keys[ends, 0] = round(part.low[0], 9)
        _, kept, new = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        places, corners = places[kept], new.reshape(-1)[corners]
    given = slice(0) if comm.rank else slice(None)
    corners = corners[given]
    whole = compat.create_mesh(comm, cell, order, places[given], corners)
    cell_tags = compat.distributed_tags(whole, dimension, corners, np.concatenate(owner)[given])
    facet_tags, groups = _sides(whole, cell_tags, parts)
    for number, box in enumerate(parts):
        groups[box.name] = Group(dimension, (number + 1,))
    return Body(whole, cell_tags, facet_tags, groups, "boxes")


def _sides(
    whole: mesh.Mesh, cell_tags: mesh.MeshTags, parts: Sequence[Box]
) -> tuple[mesh.MeshTags, dict[str, Group]]:
    """Tags of the boundary facets by box and side, and the groups of these."""
    dimension = whole.topology.dim
    whole.topology.create_entities(dimension - 1)
    whole.topology.create_connectivity(dimension - 1, dimension)
    links = whole.topology.connectivity(dimension - 1, dimension)
    facets = compat.exterior_facets(whole)
    behind = np.array([links.links(facet)[0] for facet in facets], dtype=np.int32)
    owner = np.zeros(cell_tags.indices.max(initial=-1) + 1, dtype=np.int32)
    owner[cell_tags.indices] = cell_tags.values
    centres = mesh.compute_midpoints(whole, dimension - 1, facets)
    tags = np.zeros(len(facets), dtype=np.int32)
    groups: dict[str, Group] = {}
    for number, box in enumerate(parts):
        mine = owner[behind] == number + 1 if len(behind) else np.zeros(0, dtype=bool)
        for axis in range(dimension):
            for end, at in enumerate((box.low[axis], box.high[axis])):
                tag = 1 + 10 * number + 2 * axis + end
                tags[mine & np.isclose(centres[:, axis], at)] = tag
                groups[f"{box.name}.{'xyz'[axis]}{end}"] = Group(dimension - 1, (tag,))
    order = np.argsort(facets)
    return mesh.meshtags(whole, dimension - 1, facets[order], tags[order]), groups


def quarter_rings(
    parts: Sequence[Box], comm: MPI.Comm = COMM, order: int = 2, cell: str = ""
) -> Body:
    """Quarters of rings around z.

    Args:
        parts: Along the radius, along the angle from 0 to 1 (a right angle), and in 3D along z;
            of ``shaft``, say, ``shaft.x1`` is the outer side, ``shaft.y0`` and ``shaft.y1`` lie in
            the planes y = 0 and x = 0.
        comm: Of the mesh.
        order: Of the cells' geometry.
        cell: Their kind; quadrilaterals or hexahedra by default.
    """
    cell = cell or ("quadrilateral" if len(parts[0].cells) == 2 else "hexahedron")
    body = boxes(parts, cell, comm, order)
    places = body.mesh.geometry.x
    radii, angles = places[:, 0].copy(), 0.5 * np.pi * places[:, 1]
    places[:, 0], places[:, 1] = radii * np.cos(angles), radii * np.sin(angles)
    return body


LOWER, UPPER = "lower", "upper"
Cell = Literal["triangle", "quadrilateral", "tetrahedron", "hexahedron"]
CELLS: tuple[Cell, ...] = ("quadrilateral", "triangle", "hexahedron", "tetrahedron")
Slave = Literal["on", "against"]
SLAVES: tuple[Slave, ...] = ("on", "against")

PRESSURE = 5.0
_MODULI = {LOWER: 300.0, UPPER: 1000.0}
RATIOS = {LOWER: 0.2, UPPER: 0.3}


def block(name: str, cells: int, triangles: bool = False, **parameters: float) -> MeshSource:
    """A unit square above or below y = 0, or what the parameters of ``block.geo`` make of it."""
    base = 0 if name == UPPER else -1
    sizes = {"base": base, "cells_along": cells, "cells_across": cells}
    return MeshSource(
        mesh_file("block.geo"),
        cell="triangle" if triangles else "quadrilateral",
        name=name,
        parameters=sizes | parameters,
    )


def _brick(name: str, cells: int, hexahedra: bool) -> MeshSource:
    """A unit cube above or below z = 0."""
    base = 0 if name == UPPER else -1
    parameters = {"base": base, "cells_along": cells, "hexahedra": int(hexahedra)}
    return MeshSource(mesh_file("brick.geo"), name=name, parameters=parameters)


def pair_scene(
    cell: Cell, cells: tuple[int, int], pressed: Value = PRESSURE, epsilon: float = 1e-6
) -> Scene:
    """Two blocks that stand on each other, the lower one held and the upper one pressed down.

    Args:
        cell: Type of the cells.
        cells: Along a side of the lower and of the upper block.
        pressed: Pressure on top (stress).
        epsilon: ε₁ over h/E of the finer mesh and the stiffer block.
    """
    in_space = cell in ("hexahedron", "tetrahedron")
    if in_space:
        meshes = [_brick(n, c, cell == "hexahedron") for n, c in zip(_MODULI, cells, strict=True)]
    else:
        meshes = [block(n, c, cell == "triangle") for n, c in zip(_MODULI, cells, strict=True)]
    sides: dict[str, AxisName] = {"left": "x", "front": "y"} if in_space else {"left": "x"}
    held = [Support(f"{n}.{side}", {axis: 0}) for n in _MODULI for side, axis in sides.items()]
    penalty = epsilon / max(cells) / max(_MODULI.values())
    return Scene(
        kinematics="3D" if in_space else "plane strain",
        mesh=tuple(meshes),
        material=tuple(Material(_MODULI[name], RATIOS[name], on=name) for name in _MODULI),
        support=(Support("lower.bottom", {"z" if in_space else "y": 0}), *held),
        load=(Load("upper.top", pressure=pressed),),
        contact=(Contact("upper.bottom", against="lower.top", penalty_parameter=penalty),),
    )


def with_contact(scene: Scene, **changes: Any) -> Scene:
    """The scene with changes of its only contact."""
    contact = dataclasses.replace(scene.contact[0], **changes)
    return dataclasses.replace(scene, contact=(contact,))


def trusted(scene: Scene, body: Body | None = None) -> tuple[Run, Result]:
    """Solve a scene, keeping its fields; collective.

    Raises:
        UntrustedError: It did not converge, or a check failed.
    """
    run = Run(scene, body=body)
    result = run.solve()
    note_mesh(result.model)
    if not result.passed:
        raise UntrustedError(result.verdict)
    return run, result


def pressures(result: Result) -> Array:
    """Contact pressures at all points, (points,) (stress)."""
    assert result.points is not None
    return result.points.contact_pressure
