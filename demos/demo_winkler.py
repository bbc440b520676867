"""Example 2 of Campos, Oden & Kikuchi (1982): a slab on a Winkler foundation, with friction.

A slab of 20 × 1 (E = 1000, ν = 0.3, plane stress) lies on springs that only push: pressure =
100 × depth, and rub: friction ≤ 1 × pressure. A patch of half-width 1 on its top is pressed
down by 10; the ends lift off. The model is the right half. It sinks in by .0578 in the middle,
the contact ends at x = 3.20, and friction carries 8.20. Without friction (FRICTION = 0) it sinks
in by .0718, and the contact ends at x = 2.36. The scene file winkler.toml says the same.

Run it with ``python demos/demo_winkler.py`` or ``mpirun -n 2 python demos/demo_winkler.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, Load, Material, MeshSource, Scene, run_script

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "foundation_slab.geo"
FRICTION = 1.0  # 0: no friction

scene = Scene(
    title="Slab on a Winkler foundation (Campos, Oden & Kikuchi 1982, example 2)",
    kinematics="plane stress",
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"length": 10, "height": 1, "patch": 1, "cells_along": 80, "cells_across": 8},
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    symmetry=("left",),
    load=(Load(on="patch", pressure=10),),
    contact=(Contact(on="bottom", foundation_stiffness=100, friction_coefficient=FRICTION),),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/winkler", description=__doc__))
