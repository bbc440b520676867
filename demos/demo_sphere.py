"""Example 3 of Campos, Oden & Kikuchi (1982): a sphere pressed on a half-space, with friction.

A rigid paraboloid, with the curvature of a sphere of radius 8, is driven by 1 into a half-space
(E = 1000, ν = 0.3, axisymmetric). With the coefficient .6 the contact sticks up to .765 of its
radius, and the force is 1.0247 times Hertz's. Without friction (FRICTION = 0) this is Hertz's
problem: a force of 4144.2, a peak pressure of 247.34 and a contact of radius √8 = 2.8284, so of
area 8π. The mesh is a piece of the half-space: on its outer boundary the displacement is that
which Boussinesq gives for the force, whatever that turns out to be. The scene file sphere.toml
says the same.

Run it with ``python demos/demo_sphere.py`` or ``mpirun -n 2 python demos/demo_sphere.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, HalfSpace, Material, MeshSource, Obstacle, Scene, run_script

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "half_space.geo"
FRICTION = 0.6  # 0: no friction

scene = Scene(
    title="Sphere pressed on a half-space (Campos, Oden & Kikuchi 1982, example 3)",
    kinematics="axisymmetric",
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"fine": 5, "size": 0.2, "extent": 60, "cells_outside": 16},
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    symmetry=("axis",),
    half_space=HalfSpace(on=("outer",)),
    contact=(
        Contact(
            on="contact",
            obstacle=Obstacle(shape="paraboloid", radius=8, indentation=1),
            friction_coefficient=FRICTION,
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/sphere", description=__doc__))
