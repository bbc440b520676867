"""A parabola on a half-plane, moved to and fro: the loop of partial slip (Cattaneo; Mindlin).

A rigid parabola is pressed on a half-plane (E = 1000, ν = .49, plane strain) by a constant force
P = 20, and moved along it in 45 load steps: to the right, then twice to the left and back, by so
little that the middle of the contact always sticks. After the first quarter the force along the
surface against the displacement is a loop, the same one in every cycle (history_loops.png;
animation_0.gif shows the friction traction on the way). In plane strain displacements have no
datum, but the area of the loop needs none. From δ(Q) = μ (δ_n(P) − δ_n(P − Q/μ)) for partial slip
(M. Ciavarella, Int. J. Solids Struct. 35 (1998) 2349-2378; J. Jäger, J. Tribology 120 (1998)
677-684) and dδ_n/dP = −ln P / (πE*) + const. with E* = E/(1 − ν²), and with both ways back as that
at twice the size (K. L. Johnson, Contact Mechanics, Cambridge 1985, Section 7.4), the friction work
of a cycle is

    W = 4 (μP)²/(πE*) ((1 − q) ln(1 − q) + q − q²/2) = .01955    for q = Q/μP = .848,

the largest force that comes out. One gets .01966 in the first cycle and .01965 in the second, whose
forces differ by less than .01 %. The scene file cycle.toml says the same.

Run it with ``python demos/demo_cycle.py`` or ``mpirun -n 2 python demos/demo_cycle.py``.
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

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "strip.geo"
FORCE, AMPLITUDE = 20, 0.022
FRICTION = 0.5

scene = Scene(
    title="Parabola on a half-plane, moved to and fro (Cattaneo; Mindlin)",
    kinematics="plane strain",
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"fine": 1.4, "size": 0.1, "extent": 20, "cells_outside": 10},
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.49),
    half_space=HalfSpace(on=("left", "right", "bottom")),
    contact=(
        Contact(
            on="contact",
            obstacle=Obstacle(
                shape="parabola",
                radius=50,
                force=FORCE,  # up to time 1; then it stays
                displacement=(AMPLITUDE, 0),
                displacement_path=LoadPath(
                    time=(1, 6, 16, 26, 36, 46), factor=(0, 1, -1, 1, -1, 1)
                ),
            ),
            law="incremental",
            friction_coefficient=FRICTION,
        ),
    ),
    steps=Steps(number=46, end=46),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/cycle", description=__doc__))
