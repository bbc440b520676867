"""The same body in other units, or very small or stiff: the same dimensionless answer."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.block_pair import LOWER, UPPER, block
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.bodies import box
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.scenes import NU, plane_scene

THEME = "Units and scales"
_LIMIT = 1e-8
# Steel of a few millimetres: in millimetres and megapascals, and in others (length, stress).
_MILLIMETRES = (1.0, 2.1e5)
_UNITS = {
    "Pa and m": (1e-3, 2.1e11),
    "lengths of 1e-6 m in Pa": (1e-6, 2.1e11),
    "lengths of 1e6, E = 1e-6": (1e6, 1e-6),
}
# A scene by its unit of length and its modulus, and its body, None where a file has it.
Made = tuple[Scene, Body | None]


def _box(length: float) -> Body:
    return box((16, 8), (2 * length, length))


def _punch(length: float, modulus: float) -> Obstacle:
    force = 0.01 * modulus * length
    return Obstacle("parabola", radius=2 * length, position=(0.9 * length, length), force=force)


def _frictionless(length: float, modulus: float) -> Made:
    """A parabola under force."""
    scene = plane_scene(
        Contact("top", obstacle=_punch(length, modulus)),
        (Support("bottom", {"x": 0, "y": 0}),),
        material=(Material(modulus, NU),),
    )
    return scene, _box(length)


def _static(length: float, modulus: float) -> Made:
    """The driven block, part of which slips."""
    scene = plane_scene(
        Contact("bottom", friction_coefficient=1),
        (Support("top", {"x": 0.05 * length, "y": -0.01 * length}),),
        material=(Material(modulus, NU),),
    )
    return scene, _box(length)


def _incremental(length: float, modulus: float) -> Made:
    """A parabola pressed, then dragged."""
    obstacle = dataclasses.replace(
        _punch(length, modulus),
        displacement=(0.01 * length, 0),
        displacement_path=Path(time=(1.0, 4.0), factor=(0.0, 1.0)),
    )
    scene = plane_scene(
        Contact("top", obstacle=obstacle, friction_coefficient=0.3, law="incremental"),
        (Support("bottom", {"x": 0, "y": 0}),),
        material=(Material(modulus, NU),),
        steps=Steps(4, 4.0),
    )
    return scene, _box(length)


def _pair(length: float, modulus: float) -> Made:
    """A block pressed obliquely on another, meshes that do not match."""
    below = {"base": -length, "length": length, "height": length}
    above = {"left": length / 4, "length": length / 2, "height": length}
    scene = plane_scene(
        Contact("upper.bottom", against="lower.top", friction_coefficient=0.4),
        (Support("lower.bottom", {"x": 0, "y": 0}),),
        (Load("upper.top", traction=(0.002 * modulus, -0.01 * modulus)),),
        mesh=(block(LOWER, 8, False, **below), block(UPPER, 11, False, **above)),
        material=(Material(modulus, NU, on=LOWER), Material(2 * modulus, NU, on=UPPER)),
    )
    return scene, None


def _without_units(result: Result, length: float, modulus: float) -> dict[str, Array]:
    """Quantities and pressures, all of order one."""
    points, quantities = result.points, result.quantities
    assert points is not None
    force = modulus * length
    return {
        "normal_force": np.array([quantities["normal_force"] / force]),
        "friction_force": np.array(quantities["friction_force"]) / force,
        "contact_area": np.array([quantities["contact_area"] / length]),
        "strain_energy": np.array([quantities["strain_energy"] / (force * length)]),
        "pressures": points.contact_pressure / modulus,
        "friction": points.friction_traction / modulus,
        "slip": points.slip / length,
    }


def _compared(
    make: Callable[[float, float], Made], units: tuple[float, float], trials: Trials
) -> Iterator[Finding]:
    """All quantities over their largest entry, in these units and in millimetres."""
    ours, other = (
        _without_units(trials.solve(*make(*scales)), *scales) for scales in (units, _MILLIMETRES)
    )
    for key, expected in other.items():
        size = float(np.abs(expected).max(initial=0.0)) or 1.0
        if key in ("friction_force", "friction"):  # without friction, round-off of the pressure
            pressing = other["normal_force" if key == "friction_force" else "pressures"]
            size = float(np.abs(pressing).max())
        apart = float(np.abs(ours[key] - expected).max(initial=0.0))
        yield Finding(f"change of {key}", apart / size, 0.0, _LIMIT, absolute=True)


_SCENES: dict[str, tuple[str, Callable[[float, float], Made]]] = {
    "frictionless": ("parabola under force", _frictionless),
    "static": ("driven block, static law", _static),
    "incremental": ("parabola pressed and dragged, incremental law", _incremental),
    "pair": ("a block on another, with friction", _pair),
}
CASES: tuple[HardCase, ...] = tuple(
    HardCase(
        f"units_{name}_{number}",
        THEME,
        f"{words}, in {unit}",
        "the same in MPa and mm",
        partial(_compared, make, scales),
    )
    for name, (words, make) in _SCENES.items()
    for number, (unit, scales) in enumerate(_UNITS.items(), 1)
)
