"""A hub that is shrunk onto a tube, which then gets hot inside: heat crosses the contact.

The tube (radii 10 and 20) is drawn too large by .01, and pressed by its hub (up to radius 40). Then
its bore gets 180 K warmer, while water cools the hub. The contact conducts in proportion to its
pressure, h = p/20, and presses the harder, the warmer the tube is beside the hub: pressures and
temperatures are found together. Both are long, so that a slice does not move along the axis, and
its pressure has a formula, of resistances in series and the thermal stresses of two rings
(docs/problems/warm_fit.md): it grows from 34.6154 to 137.3558, and 565,398 N mm/s of heat cross.
The scene file warm_fit.toml says the same.

Run it with ``python demos/demo_warm_fit.py`` or ``mpirun -n 2 python demos/demo_warm_fit.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Conductance,
    Contact,
    Film,
    Heat,
    Material,
    MeshSource,
    Scene,
    Steps,
    Support,
    run_script,
)
from fenics_contact import Path as LoadPath

GEOMETRY = str(Path(__file__).resolve().parent.parent / "meshes" / "pressfit.geo")
SIZES = {"bore": 10, "radius": 20, "outer": 40, "length": 20, "size": 2}  # mm
STEEL = Material(
    youngs_modulus=210e3,  # N/mm²
    poissons_ratio=0.3,
    thermal_expansion=12e-6,  # 1/K
    reference_temperature=20,  # °C
    conductivity=50,  # N/(s K), that is W/(m K)
)
ENDS = ("shaft_bottom", "shaft_top", "hub_bottom", "hub_top")

scene = Scene(
    title="Heat through a shrink fit",
    kinematics="axisymmetric",
    mesh=MeshSource(file=GEOMETRY, cell="quadrilateral", parameters=SIZES),
    material=STEEL,
    support=tuple(Support(on=end, displacement={"y": 0}) for end in ENDS),
    heat=(
        Heat(on="shaft_bore", temperature=200, path=LoadPath(time=(1, 2), factor=(0, 1))),
        Heat(on="hub_outside", film=Film(coefficient=5, temperature=20)),  # N/(mm s K)
    ),
    contact=(
        Contact(
            on="shaft_outside",
            against="hub_bore",
            law="none",
            interference=0.01,  # mm
            conductance=Conductance(pressures=(0, 200), values=(0, 10)),
        ),
    ),
    steps=Steps(times=(1, 1.25, 1.5, 1.75, 2)),  # first the fit, then the heat
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/warm_fit", description=__doc__))
