"""Bodies and scenes that several hard cases use."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.exact import ExactAnswer, turned

Move = Callable[[Array], Array]
Condition = Callable[[Array], Flags]

_SIDES = {2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom")}
_NAMES_3D = (*_SIDES[3], "top")


def box(
    cells: tuple[int, ...],
    size: tuple[float, ...] = (1.0, 1.0, 1.0),
    move: Move | None = None,
    parts: Mapping[str, Condition] | None = None,
    patches: Mapping[str, tuple[str, Condition]] | None = None,
    simplices: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> Body:
    """A rectangle or a box with its corner at the origin; collective.

    Its sides are called left and right (x), bottom and top (the last axis), and in space front and
    back (y); all of it is called body.

    Args:
        cells: Along each axis; two or three.
        size: Along each axis (length).
        move: From where nodes are, (nodes, dimension), to where they go.
        parts: Name → which cells it has, by their midpoints before they are moved; the others are
            called ``rest``.
        patches: Name → a side, and which of its facets it has, likewise.
        simplices: Triangles or tetrahedra in place of quadrilaterals or hexahedra.
        comm: Communicator.
    """
    dimension = len(cells)
    made = _grid(cells, size, simplices, comm)
    groups: dict[str, Group] = {"body": Group(dimension, (0,))}
    cell_tags = _tagged_cells(made, parts or {}, groups)
    facet_tags = _tagged_facets(made, size[:dimension], patches or {}, groups)
    if move is not None:
        nodes = made.geometry.x
        nodes[:, :dimension] = move(nodes[:, :dimension].copy())
    return Body(made, cell_tags, facet_tags, groups, "a box")


def _grid(
    cells: tuple[int, ...], size: tuple[float, ...], simplices: bool, comm: MPI.Comm
) -> mesh.Mesh:
    dimension = len(cells)
    corners = [np.zeros(dimension), np.array(size[:dimension], dtype=float)]
    if dimension == 3:
        kind = mesh.CellType.tetrahedron if simplices else mesh.CellType.hexahedron
        return mesh.create_box(comm, corners, list(cells), kind)
    kind = mesh.CellType.triangle if simplices else mesh.CellType.quadrilateral
    return mesh.create_rectangle(comm, corners, list(cells), kind)


def _tagged_cells(
    made: mesh.Mesh, parts: Mapping[str, Condition], groups: dict[str, Group]
) -> mesh.MeshTags:
    dimension = made.topology.dim
    index_map = made.topology.index_map(dimension)
    numbers = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
    values = np.zeros(len(numbers), dtype=np.int32)
    midpoints = mesh.compute_midpoints(made, dimension, numbers)
    for tag, (name, condition) in enumerate(parts.items(), 1):
        values[condition(midpoints)] = tag
        groups[name] = Group(dimension, (tag,))
    groups["body"] = Group(dimension, tuple(range(len(parts) + 1)))
    groups["rest"] = Group(dimension, (0,))
    return mesh.meshtags(made, dimension, numbers, values)


def _tagged_facets(
    made: mesh.Mesh,
    size: tuple[float, ...],
    patches: Mapping[str, tuple[str, Condition]],
    groups: dict[str, Group],
) -> mesh.MeshTags:
    dimension = made.topology.dim
    names = _SIDES[2] if dimension == 2 else _NAMES_3D
    facets, values = [], []
    for number, name in enumerate(names):
        axis, end = divmod(number, 2)
        place = end * size[axis]
        found = mesh.locate_entities_boundary(
            made,
            dimension - 1,
            lambda x, axis=axis, place=place: np.abs(x[axis] - place) < 1e-9 * size[axis],
        )
        tags = np.full(len(found), 1 + number, dtype=np.int32)
        midpoints = mesh.compute_midpoints(made, dimension - 1, found)
        own = [1 + number]
        for count, (patch, (side, condition)) in enumerate(patches.items()):
            if side == name:
                tags[condition(midpoints)] = 100 + count
                groups[patch] = Group(dimension - 1, (100 + count,))
                own.append(100 + count)
        groups[name] = Group(dimension - 1, tuple(own))
        facets.append(found)
        values.append(tags)
    numbers = np.concatenate(facets)
    order = np.argsort(numbers)
    return mesh.meshtags(made, dimension - 1, numbers[order], np.concatenate(values)[order])


SPECIFICATION = "the project's specification, Section 5, values of a separate prototype"
EXACT = "active-set solution of the exact inequalities, no penalty, no regularisation"
STATICS = "statics of a rigid body"

E, NU = 1000.0, 0.3
CLAMPED = Support("bottom", {"x": 0, "y": 0})
ROLLER = Support("bottom", {"y": 0})
ASIDE = Support("left", {"x": 0})


def plane_scene(
    contact: Contact | Sequence[Contact],
    support: Sequence[Support] = (),
    load: Sequence[Load] = (),
    **keys: Any,
) -> Scene:
    """A body in plane strain, E = 1000 and ν = .3 unless said otherwise."""
    return Scene(
        kinematics=keys.pop("kinematics", "plane strain"),
        material=keys.pop("material", (Material(E, NU),)),
        support=tuple(support),
        load=tuple(load),
        contact=(contact,) if isinstance(contact, Contact) else tuple(contact),
        **keys,
    )


def driven_scene(coefficient: float, aside: float, down: float, **contact: Any) -> Scene:
    """The specification's block on a rough floor, its top moved by (aside, down)."""
    return plane_scene(
        Contact("bottom", friction_coefficient=coefficient, **contact),
        (Support("top", {"x": aside, "y": down}),),
    )


def driven_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    """Its mesh, 2 × 1, of 16 × 8 cells."""
    return box((16, 8), (2, 1), comm=comm)


def pressed_scene(depth: float = 0.02, coefficient: float = 0.0, **contact: Any) -> Scene:
    """A clamped block 2 × 1 with a parabola, off its middle, pressed into its top."""
    obstacle = Obstacle("parabola", radius=2, position=(0.9, 1), indentation=depth)
    return plane_scene(
        Contact("top", obstacle=obstacle, friction_coefficient=coefficient, **contact), (CLAMPED,)
    )


def with_contact(scene: Scene, **changes: Any) -> Scene:
    """The scene with changes of its first contact."""
    contact = dataclasses.replace(scene.contact[0], **changes)
    return dataclasses.replace(scene, contact=(contact, *scene.contact[1:]))


def friction_along(result: Result) -> Array:
    """Friction at the points of a plane model, along the normal turned by a right angle."""
    points = result.points
    assert points is not None
    along = np.einsum("ij,ij->i", points.friction_traction, turned(points.normals))
    return np.asarray(along)


def compared(result: Result, exact: ExactAnswer, limit: float) -> list[Finding]:
    """Forces, and pressure and friction at all points, against those of the inequalities.

    Args:
        result: Of the program.
        exact: Of the same mesh.
        limit: Of the forces over the larger of both, and ten times that at points over the peak.
    """
    points = result.points
    assert points is not None
    pressure, friction = points.contact_pressure, friction_along(result)
    size = max(abs(exact.normal_force), abs(exact.friction_force)) or 1.0
    peak = max(np.abs(exact.pressure).max(), np.abs(exact.friction).max()) or 1.0
    normal, along = (float(points.weights @ values) for values in (pressure, friction))
    largest = max(
        float(np.abs(pressure - exact.pressure).max()),
        float(np.abs(friction - exact.friction).max()),
    )
    return [
        Finding("normal force / larger", normal / size, exact.normal_force / size, limit, True),
        Finding("friction force / larger", along / size, exact.friction_force / size, limit, True),
        Finding("error at points / peak", largest / peak, 0.0, 10 * limit, absolute=True),
    ]
