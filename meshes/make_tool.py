"""Write tool.step: a rigid stamp, rounded at its lower side.

    ./bootstrap python meshes/make_tool.py

The stamp is .8 by .4 wide and .5 high; the edges of its lower side, on z = 0 about the origin, have
a radius of .1.
"""

from pathlib import Path

import gmsh

LENGTH, WIDTH, HEIGHT, RADIUS = 0.8, 0.4, 0.5, 0.1


def main() -> None:
    """Build the solid with Gmsh's OpenCASCADE kernel, and write it."""
    gmsh.initialize()
    occ = gmsh.model.occ
    stamp = occ.addBox(-LENGTH / 2, -WIDTH / 2, 0, LENGTH, WIDTH, HEIGHT)
    occ.synchronize()
    near = 1e-6
    sides = (-LENGTH, -WIDTH, -near, LENGTH, WIDTH, near)
    edges = [edge for _, edge in gmsh.model.getEntitiesInBoundingBox(*sides, dim=1)]
    occ.fillet([stamp], edges, [RADIUS])
    occ.synchronize()
    gmsh.write(str(Path(__file__).with_name("tool.step")))
    gmsh.finalize()


if __name__ == "__main__":
    main()
