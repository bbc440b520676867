"""Example 1 of Campos, Oden & Kikuchi (1982): a slab with prescribed contact pressure.

A slab of 8 × 1 (E = 1000, ν = 0.3, plane stress) is pressed between a smooth floor and
a rough ceiling by a given pressure of 300, and pushed from its right end by 300. With
the coefficient 0.3 friction can carry at most g = 90: the right end slips, the rest
sticks. The scene file slab.toml says the same.

Run it with ``python demos/demo_slab.py`` or ``mpirun -n 2 python demos/demo_slab.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, Load, Material, MeshSource, Scene, Support, run_script

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "slab.geo"

scene = Scene(
    title="Slab with prescribed contact pressure (Campos, Oden & Kikuchi 1982, example 1)",
    kinematics="plane stress",
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"length": 8, "height": 1, "cells_along": 16, "cells_across": 1},
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    support=(
        Support(on="bottom", displacement={"y": 0}),
        Support(on="left", displacement={"x": 0}),
    ),
    load=(Load(on="right", traction=(-300, 0)),),
    contact=(Contact(on="top", pressure=300, friction_coefficient=0.3),),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/slab", description=__doc__))
