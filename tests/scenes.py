"""Scenes and bodies that several tests use."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    Load,
    Material,
    MeshSource,
    Scene,
    Support,
)

ROOT = Path(__file__).resolve().parent.parent
SLAB = str(ROOT / "meshes" / "slab.geo")

# A block on a rough pad (its side z0), held at its top and pulled obliquely.
PULLED_BLOCK = Scene(
    kinematics="3D",
    material=Material(1000, 0.3),
    support=(Support("z1", {"x": 0, "y": 0, "z": 0}),),
    load=(Load("x0", traction=(30, 10, 0)),),
    contact=(Contact("z0", pressure=20, friction_coefficient=0.5),),
)


def slab(
    end_load: float = 300.0,
    cells: tuple[int, int] = (16, 1),
    degree: int = 2,
    cell: str = "quadrilateral",
    order: int = 1,
    held: bool = True,
    coefficient: object = 0.3,
    pressure: object = 300.0,
    epsilon: object = "auto",
) -> Scene:
    """Example 1 of the paper; ``held`` is its support on the left."""
    supports = (Support("bottom", {"y": 0}), Support("left", {"x": 0}))
    return Scene(
        kinematics="plane stress",
        mesh=MeshSource(
            SLAB,
            parameters={"cells_along": cells[0], "cells_across": cells[1]},
            cell=cell,
            order=order,
        ),
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=supports if held else supports[:1],
        load=(Load("right", traction=(-end_load, 0)),),
        contact=(
            Contact(
                "top",
                pressure=pressure,
                friction_coefficient=coefficient,
                regularisation_parameter=epsilon,
            ),
        ),
    )


def with_solver(scene: Scene, **settings: object) -> Scene:
    """The scene with other solver settings."""
    return dataclasses.replace(scene, solver=dataclasses.replace(scene.solver, **settings))


def box_body(
    cells: tuple[int, ...],
    size: tuple[float, ...] = (1, 1, 0.5),
    cell: mesh.CellType | None = None,
    comm: MPI.Comm = MPI.COMM_WORLD,
    patches: dict | None = None,
) -> Body:
    """A box with its sides named x0, x1, y0, … and all of it named body.

    ``patches`` adds groups of facets: name → (side, condition on the midpoints).
    """
    dimension = len(cells)
    if cell is None:
        cell = mesh.CellType.hexahedron if dimension == 3 else mesh.CellType.quadrilateral
    corners = [np.zeros(dimension), np.array(size[:dimension], dtype=float)]
    make = mesh.create_box if dimension == 3 else mesh.create_rectangle
    made = make(comm, corners, list(cells), cell)
    facets, values, groups = [], [], {}
    for axis in range(dimension):
        for end in (0, 1):
            name, tag = f"{'xyz'[axis]}{end}", 1 + 2 * axis + end
            found = mesh.locate_entities_boundary(
                made,
                dimension - 1,
                lambda x, axis=axis, end=end: np.isclose(x[axis], corners[end][axis]),
            )
            tags = np.full(len(found), tag, dtype=np.int32)
            midpoints = mesh.compute_midpoints(made, dimension - 1, found)
            groups[name] = [tag]
            for number, (patch, (side, condition)) in enumerate((patches or {}).items()):
                if side == name:
                    tags[condition(midpoints.T)] = 100 + number
                    groups[patch] = [100 + number]
                    groups[name].append(100 + number)
            facets.append(found)
            values.append(tags)
    order = np.argsort(np.concatenate(facets))
    facet_tags = mesh.meshtags(
        made, dimension - 1, np.concatenate(facets)[order], np.concatenate(values)[order]
    )
    index_map = made.topology.index_map(dimension)
    count = index_map.size_local + index_map.num_ghosts
    cell_tags = mesh.meshtags(
        made, dimension, np.arange(count, dtype=np.int32), np.ones(count, dtype=np.int32)
    )
    named = {name: Group(dimension - 1, tuple(tags)) for name, tags in groups.items()}
    named["body"] = Group(dimension, (1,))
    return Body(made, cell_tags, facet_tags, named, "a box")
