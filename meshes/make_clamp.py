"""Write clamp.step: a split collar with an arm, the shaft in it, and the bolt that closes it.

    ./bootstrap python meshes/make_clamp.py

Lengths in millimetres. The shaft lies along z, 20 across, without play in the bore of the collar,
which is 16 wide. The collar is split by a slot of 2 between two ears; an M6 bolt, with a head of 10
across and its nut one with it, goes through them along y. Its holes are 6.6 wide.
"""

from pathlib import Path

import gmsh
from make_joint import named

BORE, RIM, WIDTH = 10, 18, 16  # radii, and along the shaft
SLOT, EAR, REACH, BOLT_AT = 2, 13, 34, 26.5  # an ear's half height, how far it reaches, its bolt
BOLT, HOLE, HEAD = 3, 3.3, 5  # radii
NAMES = ("collar", "shaft", "bolt M6")


def main() -> None:
    """Build the solids with Gmsh's OpenCASCADE kernel, write them, and name them."""
    gmsh.initialize()
    occ = gmsh.model.occ
    body = occ.addCylinder(0, 0, -WIDTH / 2, 0, 0, WIDTH, RIM)
    ears = occ.addBox(0, -EAR, -WIDTH / 2, REACH, 2 * EAR, WIDTH)
    arm = occ.addBox(-REACH, -6, -WIDTH / 2, 20, 12, WIDTH)
    collar, _ = occ.fuse([(3, body)], [(3, ears), (3, arm)])
    bore = occ.addCylinder(0, 0, -WIDTH, 0, 0, 2 * WIDTH, BORE)
    slot = occ.addBox(0, -SLOT / 2, -WIDTH, 2 * REACH, SLOT, 2 * WIDTH)
    hole = occ.addCylinder(BOLT_AT, -2 * EAR, 0, 0, 4 * EAR, 0, HOLE)
    occ.cut(collar, [(3, bore), (3, slot), (3, hole)])
    occ.addCylinder(0, 0, -14, 0, 0, 44, BORE)
    shank = occ.addCylinder(BOLT_AT, -EAR, 0, 0, 2 * EAR, 0, BOLT)
    head = occ.addCylinder(BOLT_AT, EAR, 0, 0, 6, 0, HEAD)
    nut = occ.addCylinder(BOLT_AT, -EAR, 0, 0, -5, 0, HEAD)
    occ.fuse([(3, shank)], [(3, head), (3, nut)])
    occ.synchronize()
    file = Path(__file__).with_name("clamp.step")
    gmsh.write(str(file))
    gmsh.finalize()
    file.write_text(named(file.read_text(encoding="utf-8"), NAMES, "clamp"), encoding="utf-8")


if __name__ == "__main__":
    main()
