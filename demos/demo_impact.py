"""A steel ball that hits a rigid wall with 5 m/s, as after a fall from 1.3 m, and rebounds.

As long as waves run through the ball many times in a contact, its force follows from Hertz's law
F = 4/3 E* √R d^1.5 and Newton's m d'' = −F (H. Hertz 1882; K. L. Johnson, Contact Mechanics,
section 11.4): with m the mass, E* = E/(1 − ν²) and R = 10 mm

    the contact lasts 2.868 (m²/(R E*² v))^(1/5) = 38.0 µs,
    its force is at most 1.283 E*^(2/5) m^(3/5) v^(6/5) R^(1/5) = 15.9 kN,
    and its radius .987 (R² m v²/E*)^(1/5) = .803 mm.

A whole ball is not the half-space of Hertz's law: its force is about 1 + .48 a/R times as large,
here by 4 %, and the contact so much shorter. One gets 37 µs, 16.3 kN and .82 mm on cells of .12 mm.
The impulse is 2 m v but for what stays in waves, a tenth of a per cent of the energy. The scene
file impact.toml says the same.

Run it with ``python demos/demo_impact.py`` or ``mpirun -n 2 python demos/demo_impact.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Motion,
    Obstacle,
    Scene,
    Units,
    run_script,
)

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "ball.geo"

scene = Scene(
    title="A ball that bounces",
    kinematics="axisymmetric",
    units=Units(length="mm", force="N"),
    mesh=MeshSource(file=str(GEOMETRY)),
    discretisation=Discretisation(degree=1),
    material=Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9),  # t/mm³
    contact=(
        Contact(
            on="contact",
            obstacle=Obstacle(shape="plane", position=(0, -0.02), normal=(0, 1)),  # 4 µs away
        ),
    ),
    motion=Motion(step=2e-7, end=60e-6, velocity={"ball": (0, -5000)}),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/impact", description=__doc__))
