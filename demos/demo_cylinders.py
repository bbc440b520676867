"""Two elastic cylinders, pressed together and shifted along each other (Hertz; Cattaneo, Mindlin).

Halves of two equal cylinders (radius 8, E = 1000, ν = 0.3, plane strain), with meshes of their own
that do not match, are brought together by .11, and then shifted in four load steps. With
1/R = 2/8 and 1/E* = 2 (1 − ν²)/E (K. L. Johnson, Contact Mechanics, Cambridge 1985, Sections 4.2
and 7.2) the force F = 27.227 that comes out belongs to

    a = √(4 F R / (π E*)) = .5024,    p0 = 2 F / (π a) = 34.50,

half the width of the contact and the peak of the pressure, and one gets .5014 and 34.56. The
shift does not change them. Its force ends at Q = 4.669 = .572 μF: then the contact slips at both
edges, and sticks on c/a = √(1 − Q/μF) = .6545 of it; one gets .653. The scene file cylinders.toml
says the same.

Run it with ``python demos/demo_cylinders.py`` or ``mpirun -n 2 python demos/demo_cylinders.py``.
"""

import sys
from pathlib import Path

from fenics_contact import Contact, Material, MeshSource, Scene, Steps, Support, run_script
from fenics_contact import Path as LoadPath

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "half_disc.geo"
APPROACH, SHIFT = 0.11, 0.0316
FRICTION = 0.3


def half_cylinder(name: str, side: int, fine: float, size: float) -> MeshSource:
    """One of the two: above (side = 1) or below, with cells of its own size."""
    parameters = {"radius": 8, "side": side, "fine": fine, "size": size}
    return MeshSource(
        name=name, file=str(GEOMETRY), cell="quadrilateral", order=2, parameters=parameters
    )


scene = Scene(
    title="Two cylinders pressed together and shifted (Hertz; Cattaneo and Mindlin)",
    kinematics="plane strain",
    mesh=(
        half_cylinder("upper", side=1, fine=0.75, size=0.05),
        half_cylinder("lower", side=-1, fine=0.9, size=0.035),
    ),
    material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    support=(
        Support(on="lower.face", displacement={"x": 0, "y": 0}),
        Support(on="upper.face", displacement={"y": -APPROACH}),  # up to time 1
        Support(
            on="upper.face",
            displacement={"x": SHIFT},
            path=LoadPath(time=(1, 2), factor=(0, 1)),
        ),
    ),
    contact=(
        Contact(
            on="upper.contact",
            against="lower.contact",
            law="incremental",
            friction_coefficient=FRICTION,
        ),
    ),
    steps=Steps(times=(1, 1.25, 1.5, 1.75, 2)),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/cylinders", description=__doc__))
