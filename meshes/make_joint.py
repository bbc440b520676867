"""Write joint.step: two bars in a half-lap joint, and the bolt that clamps them.

    ./bootstrap python meshes/make_joint.py

Lengths in millimetres. The bars lie along x, 10 thick and 5 in the lap of 30 x 30 around the bolt,
whose axis is z. The bolt is an M8 with a head of 13 across, its nut is one with it, and its holes
are 9 wide. The ends of the laps leave 2 free to the shoulders.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import gmsh

LAP, WIDTH, THICKNESS = 30, 30, 10
BAR, CLEARANCE = 18, 2  # of the bar beyond its shoulder; between a lap's end and a shoulder
BOLT, HOLE, HEAD, HEIGHT = 4, 4.5, 6.5, 5.3  # radii, and the height of head and nut
NAMES = ("left bar", "right bar", "bolt M8")


def main() -> None:
    """Build the solids with Gmsh's OpenCASCADE kernel, write them, and name them."""
    gmsh.initialize()
    _bar(-1)
    _bar(1)
    _bolt()
    gmsh.model.occ.synchronize()
    file = Path(__file__).with_name("joint.step")
    gmsh.write(str(file))
    gmsh.finalize()
    file.write_text(named(file.read_text(encoding="utf-8"), NAMES, "joint"), encoding="utf-8")


def _bar(side: int) -> None:
    """A bar that goes to the left (-1), its lap above, or to the right (1), its lap below."""
    occ, half = gmsh.model.occ, LAP / 2
    start = side * (half + CLEARANCE)
    full = occ.addBox(
        min(start, start + side * BAR), -WIDTH / 2, -THICKNESS / 2, BAR, WIDTH, THICKNESS
    )
    bottom = 0 if side < 0 else -THICKNESS / 2
    lap = occ.addBox(
        -half if side > 0 else start, -WIDTH / 2, bottom, LAP + CLEARANCE, WIDTH, THICKNESS / 2
    )
    (body,), _ = occ.fuse([(3, full)], [(3, lap)])
    hole = occ.addCylinder(0, 0, -THICKNESS / 2, 0, 0, THICKNESS, HOLE)
    occ.cut([body], [(3, hole)])


def _bolt() -> None:
    """Head, shank and nut as one solid."""
    occ, half = gmsh.model.occ, THICKNESS / 2
    shank = occ.addCylinder(0, 0, -half, 0, 0, THICKNESS, BOLT)
    head = occ.addCylinder(0, 0, half, 0, 0, HEIGHT, HEAD)
    nut = occ.addCylinder(0, 0, -half - HEIGHT, 0, 0, HEIGHT, HEAD)
    occ.fuse([(3, shank)], [(3, head), (3, nut)])


def named(text: str, names: Sequence[str], whole: str) -> str:
    """The file with names of parts, as CAD programs write them; Gmsh gives each a number.

    Args:
        text: Of the file.
        names: Of its parts, in their order.
        whole: Name of all of it.
    """
    for number, name in enumerate(names, start=1):
        text, count = re.subn(
            rf"'Open CASCADE STEP translator [\d.]+ 1\.{number}'", f"'{name}'", text
        )
        if not count:
            raise ValueError(f"no part {number} in the file")
    return re.sub(r"'Open CASCADE STEP translator [\d.]+ 1'", f"'{whole}'", text)


if __name__ == "__main__":
    main()
