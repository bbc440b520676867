"""A block of rubber that is pressed on a belt, which moves at .2 m/s, and judders.

It sticks, is taken along until friction can hold it no more, springs back, and sticks again. That
needs a coefficient that is larger at rest (.8) than in sliding (.5), as R. A. Ibrahim has it
(Applied Mechanics Reviews 47, 1994, 209-226): where it falls with the speed, sliding is not steady.

Friction is .5 of the normal force where all of the block slides fast, some 350 times a second. It
never reaches .8, as edges begin to slide before the middle. The scene file stick_slip.toml says
the same.

Run it with ``python demos/demo_stick_slip.py`` or ``mpirun -n 2 python demos/demo_stick_slip.py``.
"""

import sys
from pathlib import Path as File

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Motion,
    Obstacle,
    Path,
    Rayleigh,
    Scene,
    SpeedDependentFriction,
    Support,
    Units,
    run_script,
)

GEOMETRY = File(__file__).resolve().parent.parent / "meshes" / "block.geo"

scene = Scene(
    title="A block of rubber on a belt",
    kinematics="plane strain",
    units=Units(length="mm", force="N"),
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"length": 20, "height": 10, "cells_along": 16, "cells_across": 8},
    ),
    discretisation=Discretisation(degree=1),
    material=Material(youngs_modulus=5, poissons_ratio=0.45, density=1.1e-9),  # t/mm³
    support=(Support(on="top", displacement={"x": 0, "y": 0}),),
    contact=(
        Contact(
            on="bottom",
            law="incremental",
            friction_coefficient=0.8,
            friction_law=SpeedDependentFriction(
                kind="speed dependent", speeds=(0, 10, 100), shares=(1, 0.7, 0.625)
            ),
            obstacle=Obstacle(
                shape="plane",
                position=(0, 0),
                normal=(0, 1),
                indentation=0.2,
                path=Path(time=(0,), factor=(1,)),
                displacement=(200, 0),  # in a second
                displacement_path=Path(time=(0, 2), factor=(0, 2)),
            ),
        ),
    ),
    motion=Motion(
        step=2e-5,
        end=0.015,
        start="static",  # pressed, and at rest
        rayleigh=Rayleigh(mass=0, stiffness=1e-5),
    ),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/stick_slip", description=__doc__))
