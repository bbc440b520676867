"""CAD files of several solids, made by Gmsh where a test needs them."""

import re
from pathlib import Path

from mpi4py import MPI

THICK, WIDE, HOLE, SHANK, HEAD, HIGH = 4.0, 20.0, 5.0, 4.0, 8.0, 3.0


def write_shapes(path: Path, build, labels=()) -> str:
    """Solids, or faces, that a function builds by Gmsh's OpenCASCADE; its name for scenes.

    Args:
        path: ``.step`` or ``.brep``; rank 0 writes it.
        build: From ``gmsh.model.occ``.
        labels: Of the solids of a STEP file, in order.
    """
    if MPI.COMM_WORLD.rank == 0:
        import gmsh

        gmsh.initialize(readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        try:
            build(gmsh.model.occ)
            gmsh.model.occ.synchronize()
            gmsh.write(str(path))
        finally:
            gmsh.finalize()
        if labels:
            path.write_text(labelled(path.read_text(), labels))
    MPI.COMM_WORLD.barrier()
    return str(path)


def labelled(step: str, labels) -> str:
    """A STEP file that OpenCASCADE has written, its solids called as asked for."""
    for number, label in enumerate(labels, start=1):
        text = label.replace("'", "''").replace("\n", "\\X\\0A")
        name = rf"'Open CASCADE STEP translator [\d.]+ \d+\.{number}'"
        found = re.subn(
            rf"PRODUCT\({name},\s*{name}", lambda _, text=text: f"PRODUCT('{text}','{text}'", step
        )
        step, count = found
        assert count == 1
    return step


def label_faces(step: str, names) -> str:
    """The same for faces, all of them in order."""
    left = iter(names)
    return re.sub(r"ADVANCED_FACE\(''", lambda _: f"ADVANCED_FACE('{next(left)}'", step)


def joint(occ, shank: float = SHANK) -> None:
    """Two plates with a hole each, and a bolt with head and nut that touch them.

    Args:
        occ: Gmsh's OpenCASCADE.
        shank: The bolt's diameter; of that of the hole it touches, of a larger one it overlaps.
    """
    middle = WIDE / 2, WIDE / 2
    for level in (0, THICK):
        plate = occ.addBox(0, 0, level, WIDE, WIDE, THICK)
        hole = occ.addCylinder(*middle, level, 0, 0, THICK, HOLE / 2)
        occ.cut([(3, plate)], [(3, hole)])
    bolt = occ.addCylinder(*middle, -HIGH, 0, 0, 2 * (THICK + HIGH), shank / 2)
    ends = [occ.addCylinder(*middle, at, 0, 0, HIGH, HEAD / 2) for at in (-HIGH, 2 * THICK)]
    occ.fuse([(3, bolt)], [(3, end) for end in ends])


def turned(references: str) -> str:
    """A list of references, the first two of them last."""
    first, second, *others = references.split(",")
    return ",".join([*others, first, second])
