"""A sphere pressed on a half-space, then pushed sideways (Cattaneo; Mindlin), in 3D.

A rigid paraboloid, with the curvature of a sphere of radius 50, is pressed on a half-space
(E = 1000, ν = .49) by P = 35.092, so that contact ends at Hertz's radius a = 1, and then moved
along it in ten load steps. From the edge of the contact a ring of slip grows inwards: at the force
Q along the surface it sticks up to the radius c = a (1 − Q/μP)^(1/3) (K. L. Johnson, Contact
Mechanics, Cambridge 1985, Section 7.2). One gets, with c/a from the areas that stick and touch,

    Q/μP       .115   .331   .526   .699   .842   .902
    c/a        .971   .865   .764   .663   .531   .452
    formula    .960   .875   .780   .670   .541   .461

and a = 1.008. The last displacement, .00697, is that of
Q = .9 μP by Mindlin's formula. animation_0.gif, of the report, shows what sticks and slips, and the
friction traction. The model is half of the body; on its outer boundary displacements are those of
Boussinesq and Cerruti. The scene file cattaneo.toml says the same.

Run it with ``python demos/demo_cattaneo.py`` or ``mpirun -n 2 python demos/demo_cattaneo.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    HalfSpace,
    Material,
    MeshSource,
    Obstacle,
    Scene,
    Steps,
    run_script,
)
from fenics_contact import Path as LoadPath

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "quarter_space.geo"
FORCE, SHIFT = 17.546, 0.00697  # the force on the half that is modelled
FRICTION = 0.3

scene = Scene(
    title="Sphere pressed on a half-space, then pushed sideways (Cattaneo; Mindlin)",
    kinematics="3D",
    mesh=MeshSource(
        file=str(GEOMETRY),
        parameters={
            "half": 1,
            "hexahedra": 1,
            "fine": 1.2,
            "size": 0.2,
            "extent": 10,
            "cells_outside": 4,
        },
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.49),
    symmetry=("symmetry_y",),
    half_space=HalfSpace(on=("outer",)),
    contact=(
        Contact(
            on="contact",
            obstacle=Obstacle(
                shape="paraboloid",
                radius=50,
                force=FORCE,
                displacement=(SHIFT, 0, 0),
                displacement_path=LoadPath(time=(1, 11), factor=(0, 1)),
            ),
            law="incremental",
            friction_coefficient=FRICTION,
        ),
    ),
    steps=Steps(number=11, end=11),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/cattaneo", description=__doc__))
