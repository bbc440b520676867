"""A rigid cylinder is pressed into a block of rubber and dragged along it: finite strains.

The cylinder, of radius 1, is pressed by .5 into a block that is 8 wide and 3 high and held at its
bottom, and then dragged by 3:
over twelve cells. Rubber is neo-Hookean, friction .3. Strains reach 30 %, the surface turns by half
a radian. A prototype apart from this program, with penalties and another solver, gives a force of
.416159 when it is pressed in, and (.123484, −.411790) on the block at the end. The scene file
ironing.toml says the same.

Run it with ``python demos/demo_ironing.py`` or ``mpirun -n 2 python demos/demo_ironing.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    Material,
    MeshSource,
    Obstacle,
    Scene,
    Steps,
    Support,
    run_script,
)
from fenics_contact import Path as LoadPath

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "ironing.geo"

scene = Scene(
    title="Cylinder pressed into rubber and dragged along it",
    kinematics="plane strain",
    strains="finite",
    mesh=MeshSource(file=str(GEOMETRY), cell="quadrilateral"),
    material=Material(youngs_modulus=1.0, poissons_ratio=0.3, law="neo-Hookean"),
    support=(Support(on="bottom", displacement={"x": 0, "y": 0}),),
    contact=(
        Contact(
            on="top",
            obstacle=Obstacle(
                shape="cylinder",
                radius=1.0,
                position=(-1.5, 0.0),
                normal=(0, -1),
                indentation=0.5,  # up to time 1; then it stays
                path=LoadPath(time=(0, 1), factor=(0, 1)),
                displacement=(3.0, 0.0),
                displacement_path=LoadPath(time=(1, 2), factor=(0, 1)),
            ),
            friction_coefficient=0.3,
            law="incremental",
        ),
    ),
    steps=Steps(times=(1.0, 1.25, 1.5, 1.75, 2.0)),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/ironing", description=__doc__))
