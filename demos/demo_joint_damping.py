"""Two layers that slip on each other: natural frequency and damping over amplitude.

Two steel layers, clamped at one end and pressed on each other, vibrate in their first mode. While
all of the joint between them sticks they are one beam; the further they bend, the more of it slips,
which makes the beam softer and damps it. The scene file joint_damping.toml says the same.
Millimetres, newtons, seconds: densities are in t/mm³, frequencies in Hz.

Run it with ``python demos/demo_joint_damping.py`` or
``mpirun -n 2 python demos/demo_joint_damping.py``.
"""

import sys
from pathlib import Path

from fenics_contact import (
    Contact,
    Damping,
    Load,
    Material,
    MeshSource,
    Modes,
    Scene,
    Support,
    run_script,
)

GEOMETRY = Path(__file__).resolve().parent.parent / "meshes" / "block.geo"
LENGTH, HEIGHT = 200, 5


def layer(name, base):
    """One of the layers, from its lower side upwards."""
    cells = {"cells_along": 50, "cells_across": 2}
    return MeshSource(
        name=name,
        file=str(GEOMETRY),
        cell="quadrilateral",
        parameters={"base": base, "length": LENGTH, "height": HEIGHT, **cells},
    )


scene = Scene(
    title="Two layers that slip on each other, driven in their first mode",
    kinematics="plane stress",
    thickness=20,
    mesh=(layer("lower", -HEIGHT), layer("upper", 0)),
    material=Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9),
    support=(
        Support("lower.left", {"x": 0, "y": 0}),
        Support("upper.left", {"x": 0, "y": 0}),
    ),
    load=(Load("lower.bottom", pressure=1), Load("upper.top", pressure=1)),
    contact=(
        Contact(
            "upper.bottom",
            against="lower.top",
            name="joint",
            law="incremental",
            friction_coefficient=0.2,
        ),
    ),
    modes=Modes(number=3),
    damping=Damping(
        modes=(1,),
        amplitudes=(0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0),  # at the tip while nothing slips
        increments=24,
    ),
)

if __name__ == "__main__":
    sys.exit(run_script(scene, default_folder="results/joint_damping", description=__doc__))
