"""A block on a deformable incline, pushed up it until it slides.

Block and incline are two elastic bodies (plane strain) with meshes of their own, which do not
match. The block rests there by its weight G = 10; then its upright rear face is moved to the
right in load steps. The front begins to slip, and once all of it slips the push has reached what
balance of forces and Coulomb's law allow, however the pressure is spread:

    F = G (μ + tan α) / (1 − μ tan α) = 4.12371134    with tan α = .1, μ = .3,

the reaction of the rear face. The pressure then adds up to (G + F tan α) cos α = 10.3606966. The
scene file incline.toml says the same.

Run it with ``python demos/demo_incline.py`` or ``mpirun -n 2 python demos/demo_incline.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, Load, Material, MeshSource, Scene, Steps, Support, run_script
from fenics_contact import Path as LoadPath

GEOMETRY = str(Path(__file__).resolve().parent.parent / "meshes" / "sloped_block.geo")
FRICTION = 0.3
SLOPE = 0.1  # tan α
WEIGHT = 10
MOTION = 0.02  # of the rear face

scene = Scene(
    title="Block pushed up a deformable incline",
    kinematics="plane strain",
    mesh=(
        MeshSource(
            name="block",
            file=GEOMETRY,
            cell="quadrilateral",
            parameters={
                "left": 1,
                "length": 2,
                "bottom_slope": SLOPE,
                "top_slope": SLOPE,
                "cells_along": 16,
                "cells_across": 8,
            },
        ),
        MeshSource(
            name="incline",
            file=GEOMETRY,
            cell="quadrilateral",
            parameters={
                "length": 4,
                "bottom": -1,
                "top": 0,
                "top_slope": SLOPE,
                "cells_along": 64,
                "cells_across": 14,
            },
        ),
    ),
    material=(
        Material(on="block", youngs_modulus=1000, poissons_ratio=0.3),
        Material(on="incline", youngs_modulus=500, poissons_ratio=0.3),
    ),
    load=(Load(on="block", body_force=(0, -WEIGHT / 2)),),  # its area is 2
    support=(
        Support(on="incline.bottom", displacement={"x": 0, "y": 0}),
        Support(
            on="block.left",
            displacement={"x": MOTION},
            path=LoadPath(time=(1, 2), factor=(0, 1)),
        ),
    ),
    contact=(
        Contact(
            on="block.bottom",
            against="incline.top",
            law="incremental",
            friction_coefficient=FRICTION,
        ),
    ),
    steps=Steps(times=(1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.85, 2)),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/incline", description=__doc__))
