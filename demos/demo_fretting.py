"""A cylinder pressed on a specimen that is pulled to and fro: fretting.

A rigid parabola (R = 310.1 mm) is pressed by P = 246.6 N/mm on a specimen of an aluminium alloy
(E = 74 GPa, plane strain; ν = .49, so that pressing alone makes no friction, as between equal
bodies): contact is 2a = 2 mm wide, the largest pressure p₀ = 157 MPa. The loads at the two ends of
the specimen go to and fro; they differ by Q = ± 80.15 N/mm, which the cylinder carries by friction,
half of μP. Under the pull σ_B = ± 51 MPa the zone that sticks at the turns is

    2c = 2a √(1 − Q/μP) = 1.414 wide, its middle e = a σ_B/(2 μ p₀) = .25

from the middle of the contact, away from the trailing edge (D. Nowell, D. A. Hills, Int. J. Mech.
Sci. 29 (1987) 355-365, with 2 in place of 4, as the cylinder is rigid). One gets 1.404 and .245,
on cells of .07 mm. The loop is closed in the third cycle. At the trailing edge all criteria of
fatigue are worst: by Smith, Watson and Topper a crack is to be expected there after some 10⁷
cycles, and the safety factors of Crossland and Dang Van are .8 and .7; the stress has a cusp there,
which cells of .07 mm cut off, so that .2 or .3 of this are in doubt. The scene file fretting.toml
says the same.

Run it with ``python demos/demo_fretting.py`` or ``mpirun -n 2 python demos/demo_fretting.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    Cycles,
    FatigueLimits,
    Fretting,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Scene,
    Steps,
    StrainLifeLine,
    Support,
    Units,
    run_script,
)
from fenics_contact import Path as LoadPath

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "strip.geo"
TO_AND_FRO = LoadPath(time=(1, 2, 4, 6), factor=(0, 1, -1, 1))

scene = Scene(
    title="Fretting: a cylinder on a specimen that is pulled to and fro",
    kinematics="plane strain",
    units=Units(length="mm", force="N"),  # stresses are in N/mm², MPa
    mesh=MeshSource(
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"fine": 1.4, "size": 0.07, "extent": 60, "cells_outside": 16},
    ),
    material=Material(youngs_modulus=74000, poissons_ratio=0.49),
    support=(Support("bottom", {"y": 0}),),
    load=(  # σ_B ± Q/2H, on a height H = 60
        Load("right", traction=(51.693, 0), path=TO_AND_FRO),
        Load("left", traction=(-50.357, 0), path=TO_AND_FRO),
    ),
    contact=(
        Contact(
            on="contact",
            obstacle=Obstacle(shape="parabola", radius=310.1, force=246.6),
            law="incremental",
            friction_coefficient=0.65,
        ),
    ),
    steps=Steps(times=(1, 2)),
    cycles=Cycles(begin=2, end=6, increments=16, number=10),
    fretting=Fretting(
        depth=0.6,
        limits=FatigueLimits(torsion=85, tension=140),
        life=StrainLifeLine(
            strength=1044,
            strength_exponent=-0.114,
            ductility=1.765,
            ductility_exponent=-0.927,
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/fretting", description=__doc__))
