"""Meshes that are made once and read by all processes of a sweep."""

from __future__ import annotations

import fcntl
import hashlib
import pickle
from pathlib import Path

from mpi4py import MPI

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.from_gmsh import MeshArrays
from fenics_contact.mesh.loading import load_arrays, load_body
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene


class SharedMeshes:
    """Meshes in a folder that only the processes of a sweep read and write.

    Args:
        folder: The folder, which its processes have for themselves.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def body(self, scene: Scene, key: str) -> Body:
        """The mesh that a scene names, on this process.

        The first process that needs it makes it, while the others wait. If it dies, the lock is
        free again, and the next one makes it.

        Args:
            scene: The scene.
            key: What its mesh follows from.

        Raises:
            InputError: It cannot be used, which the next process need not find out again.
        """
        file = self._folder / hashlib.sha256(key.encode()).hexdigest()
        with file.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not file.exists():
                replace_file(file, pickle.dumps(_made(scene)))
        found = pickle.loads(file.read_bytes())
        if isinstance(found, InputError):
            raise found
        comm = MPI.COMM_SELF
        return load_body(scene.mesh, scene.dimension, comm, preloads=scene.preload, arrays=found)


def _made(scene: Scene) -> MeshArrays | InputError:
    """The mesh, or why it cannot be used."""
    if not scene.mesh:
        return InputError("mesh: the scene names no mesh")
    try:
        return load_arrays(scene.mesh, scene.dimension, scene.preload)
    except InputError as error:
        return error
