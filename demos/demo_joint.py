"""A bolted joint from a CAD file: tightened, then pulled to and fro.

Two aluminium bars overlap in a half-lap joint and are clamped by a steel bolt. Each part is a solid
of a STEP file, and a body of its own here; five contacts with friction hold them together. The bolt
is tightened to 10 kN, its length is kept from then on, and the bars are pulled and pushed by 1.5 kN
in eleven load steps. Friction holds them, while the lap slips at its edges and dissipates. The
scene file joint.toml says the same. Millimetres, newtons, megapascals.

Run it with ``python demos/demo_joint.py`` or ``mpirun -n 2 python demos/demo_joint.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    Preload,
    Scene,
    Steps,
    Support,
    run_script,
)
from fenics_contact import Path as LoadPath

CAD = Path(__file__).resolve().parent.parent / "meshes" / "joint.step"
STEEL = {"youngs_modulus": 210e3, "poissons_ratio": 0.3}
ALUMINIUM = {"youngs_modulus": 70e3, "poissons_ratio": 0.33}
# Name, surface, the one opposite, friction coefficient.
PAIRS = (
    ("lap", "upper_lap", "lower_lap", 0.2),
    ("head", "head", "left_top", 0.15),
    ("nut", "nut", "right_bottom", 0.15),
    ("hole above", "left_hole", "shank", 0.15),
    ("hole below", "right_hole", "shank", 0.15),
)

scene = Scene(
    title="A bolted joint: tightened, then pulled to and fro",
    kinematics="3D",
    mesh=MeshSource(
        file=str(CAD),
        size=5,
        sizes={"bolt_M8": 2.5},
        curvature=16,
        groups={
            "fixed": (17,),
            "pulled": (1,),
            "upper_lap": (7,),
            "lower_lap": (14,),
            "left_top": (3,),
            "right_bottom": (15,),
            "left_hole": (9,),
            "right_hole": (18,),
            "head": (21,),
            "nut": (23,),
            "shank": (22,),
        },
    ),
    material=(
        Material(on="left_bar", **ALUMINIUM),
        Material(on="right_bar", **ALUMINIUM),
        Material(on="bolt_M8", **STEEL),
    ),
    discretisation=Discretisation(degree=1),
    support=(
        Support(on="fixed", displacement={"x": 0, "y": 0, "z": 0}),
        Support(on="pulled", displacement={"y": 0, "z": 0}),
    ),
    preload=(
        Preload(
            name="bolt",
            on="bolt_M8",
            between=(-3, 3),
            axis=(0, 0, 1),
            force=10e3,
            path=LoadPath(time=(0, 1), factor=(0, 1)),
            locked_from=1,
        ),
    ),
    load=(
        Load(
            on="pulled",
            traction=(-5, 0, 0),
            path=LoadPath(time=(1, 2, 4, 6), factor=(0, 1, -1, 1)),
        ),
    ),
    contact=tuple(
        Contact(name=name, on=on, against=against, law="incremental", friction_coefficient=friction)
        for name, on, against, friction in PAIRS
    ),
    steps=Steps(times=(1, 1.5, 2, 2.5, 3, 3.5, 4, 4.4, 4.8, 5.2, 5.6, 6)),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/joint", description=__doc__))
