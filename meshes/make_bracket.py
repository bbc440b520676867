"""Write bracket.step: an L-shaped bracket with a fillet, a hole and two friction pads.

    ./bootstrap python meshes/make_bracket.py

Lengths in millimetres. The wall is at x = 0, the shelf reaches to x = 60; a pad of
20 x 20 stands 2 proud of the shelf above and another below.
"""

from pathlib import Path

import gmsh

WIDTH, REACH, HEIGHT, THICKNESS = 30, 60, 40, 8
FILLET, HOLE = 8, 5
PAD, PAD_HEIGHT, PAD_START = 20, 2, 20


def main() -> None:
    """Build the solid with Gmsh's OpenCASCADE kernel and write it."""
    gmsh.initialize()
    occ = gmsh.model.occ
    wall = occ.addBox(0, 0, 0, THICKNESS, WIDTH, HEIGHT)
    shelf = occ.addBox(0, 0, 0, REACH, WIDTH, THICKNESS)
    across = (WIDTH - PAD) / 2
    above = occ.addBox(PAD_START, across, THICKNESS, PAD, PAD, PAD_HEIGHT)
    below = occ.addBox(PAD_START, across, -PAD_HEIGHT, PAD, PAD, PAD_HEIGHT)
    corner = _fillet()
    (body,), _ = occ.fuse([(3, wall)], [(3, p) for p in (shelf, above, below, corner)])
    hole = occ.addCylinder(REACH - 10, WIDTH / 2, 0, 0, 0, THICKNESS, HOLE)
    occ.cut([body], [(3, hole)])
    occ.synchronize()
    gmsh.write(str(Path(__file__).with_name("bracket.step")))
    gmsh.finalize()


def _fillet() -> int:
    """The rounded corner between shelf and wall."""
    occ = gmsh.model.occ
    block = occ.addBox(THICKNESS, 0, THICKNESS, FILLET, WIDTH, FILLET)
    round_ = occ.addCylinder(THICKNESS + FILLET, 0, THICKNESS + FILLET, 0, WIDTH, 0, FILLET)
    ((_, corner),), _ = occ.cut([(3, block)], [(3, round_)])
    return corner


if __name__ == "__main__":
    main()
