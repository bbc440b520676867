"""Meshes that are fine enough to see what touches: where adaptive meshes begin, and how they go on.

Estimated errors say nothing of an obstacle between two points of the surface. Where there is one,
or where it touches in too few points, the next mesh is the last one with smaller cells there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.kinematics.between_points import TooCoarseError
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.adaptive.next_mesh import MeshDensity, hindrance, next_mesh
from fenics_contact.simulation.scene_run import Run
from fenics_contact.trust.convergence.hidden_obstacles import hidden_obstacles

# Meshes before the first one that is solved, at the most.
_MOST = 8


@dataclass(frozen=True, eq=False)
class _Meshed:
    """A mesh of a scene, as ``next_mesh`` takes one."""

    body: Body
    spaces: Spaces
    comm: MPI.Comm


def first_run(scene: Scene, comm: MPI.Comm, body: Body | None = None) -> Run:
    """A scene made ready; if it asks for an accuracy, on a mesh that shows its obstacles.

    Collective.

    Args:
        scene: What to solve.
        comm: Communicator.
        body: The mesh, if not the one the scene names.

    Raises:
        InputError: As ``Run``.
        MachineError: As ``Run``.
    """
    is_own, meshes = body is not None, 0
    while True:
        try:
            run = Run(scene, comm, body, own_mesh=is_own)
        except TooCoarseError as error:
            mesh, rows = error.spaces, error.finer
            if not _may_be_finer(scene, mesh.body, is_own) or meshes == _MOST:
                raise
        else:
            if not _may_be_finer(scene, run.problem.body, is_own) or meshes == _MOST:
                return run
            mesh, rows = run.problem.spaces, _of_hidden(run)
            if total(comm, len(rows)) == 0:
                return run
        body = finer_there(scene, mesh, rows, is_own)
        meshes += 1


def finer_there(scene: Scene, spaces: Spaces, rows: Array, is_own: bool) -> Body:
    """A mesh as the last one, with smaller cells at some places; collective.

    Args:
        scene: With its meshes.
        spaces: On the last mesh.
        rows: Of x, y, z and a size that cells there are not to exceed, of this rank (length).
        is_own: Whether the first mesh was passed in place of the scene's.

    Raises:
        InputError: Gmsh cannot make it, or it is unsound.
    """
    body, comm = spaces.body, spaces.comm
    cells = body.mesh.topology.index_map(body.dimension)
    alike = np.ones(cells.size_local)
    density = MeshDensity(float(cells.size_global), alike / cells.size_global, rows)
    return next_mesh(scene, _Meshed(body, spaces, comm), density, is_own)


def _may_be_finer(scene: Scene, body: Body, is_own: bool) -> bool:
    return scene.accuracy is not None and not hindrance(scene, body, is_own)


def _of_hidden(run: Run) -> Array:
    """Rows for ``finer_there``, of rank 0."""
    rows = [[*one.place, one.wanted] for one in hidden_obstacles(run.problem)]
    mine = rows if run.problem.comm.rank == 0 else []
    return np.array(mine, dtype=np.float64).reshape(-1, 4)
