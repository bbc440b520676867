"""The room for readers of other programs' meshes: a program of its own, which reads one file.

``gmsh_call`` starts it as it does ``gmsh_process``. It imports nothing that would start MPI.
"""

import json
import sys
from importlib import import_module
from typing import Any

from fenics_contact.mesh.geometry import process_room as room
from fenics_contact.mesh.geometry.process_room import Arrays, Job

# Modules of ``mesh.readers``, and their functions; each imports libraries that others do without.
_READERS = {
    "inp": ("abaqus", "read"),
    "bdf": ("nastran", "read"),
    "med": ("salome", "read"),
    "vtu": ("vtk_xml", "read_vtu"),
    "xdmf": ("vtk_xml", "read_xdmf"),
}


def main() -> None:
    """Do the job and write the answer, which holds either a mesh or an error."""
    module, function = _READERS[json.loads(sys.argv[1])["kind"]]
    # Before the room is closed: Gmsh may start a program to find its library.
    read = getattr(import_module(f"fenics_contact.mesh.readers.{module}"), function)

    def work(job: Job) -> tuple[dict[str, Any], Arrays]:
        return read(job).answer()  # type: ignore[no-any-return]

    room.answer(work)


if __name__ == "__main__":
    main()
