"""Example 4 of Campos, Oden & Kikuchi (1982): an annular punch, with friction.

A rigid, flat ring of inner radius .5 and outer radius 1 is driven by d = .01 into a half-space
(E = 1000, ν = 0.3, axisymmetric). The problem is linear in d: without friction (FRICTION = 0)
the force is .9819 × 2 E* d with E* = E / (1 − ν²), here 21.58. With the coefficient .3 it is
1.0231 times that, and the surface sticks to the ring for .510 < r < .905. If the ring is glued
to it instead, with contact="bonded" and FRICTION = 0, the force is 1.0276 times the 21.58: the
adhesive limit. The pressure is singular at both edges of the ring, where the mesh is finest. The
scene file annulus.toml says the same.

Run it with ``python demos/demo_annulus.py`` or ``mpirun -n 2 python demos/demo_annulus.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, HalfSpace, Material, MeshSource, Obstacle, Scene, run_script

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "annular_punch.geo"
FRICTION = 0.3  # 0: no friction

scene = Scene(
    title="Annular punch on a half-space (Campos, Oden & Kikuchi 1982, example 4)",
    kinematics="axisymmetric",
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"inner_radius": 0.5, "outer_radius": 1, "extent": 200, "size": 0.01},
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    symmetry=("axis",),
    half_space=HalfSpace(on=("outer",)),
    contact=(
        Contact(
            on="contact",
            contact="unilateral",
            obstacle=Obstacle(indentation=0.01),
            friction_coefficient=FRICTION,
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/annulus", description=__doc__))
