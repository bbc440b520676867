"""The mesh that a scene names."""

from __future__ import annotations

from mpi4py import MPI

from fenics_contact.common.errors import InputError
from fenics_contact.common.timings import Timings
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene


def mesh_of(scene: Scene, comm: MPI.Comm, timings: Timings) -> Body:
    """The mesh that a scene names; collective.

    Raises:
        InputError: It names none, or one that cannot be used.
    """
    if not scene.mesh:
        raise InputError("mesh: the scene names no mesh and no body was passed")
    with timings.phase("mesh"):
        curved = scene.accuracy is not None and scene.discretisation.degree > 1
        return load_body(scene.mesh, scene.dimension, comm, curved=curved, preloads=scene.preload)
