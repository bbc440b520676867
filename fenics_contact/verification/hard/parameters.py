"""Hard cases of parameters and of units."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import LOWER, UPPER, block
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.exact import exact_answer, statuses_of
from fenics_contact.verification.hard.scenes import (
    EXACT,
    NU,
    E,
    box,
    compared,
    driven_body,
    driven_scene,
    plane_scene,
    pressed_scene,
    with_contact,
)
from fenics_contact.verification.published.shear import slab_scene

_THEME = "Tiny ε and ε₁"
# ε is measured by how far the block's top moves, ε₁ by h/E.
_MOVED, _COMPLIANCE = 0.05, 0.125 / E
_PENALTIES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
_SLIPS = (1e-4, 1e-6, 1e-8, 1e-10)
# A smaller ε₁ moves the forces by its share; round-off of the stiff springs limits the smallest.
_LIMIT = 1e-3
# Of the slab on 16 × 1 elements.
_SLAB_FRICTION = 209.98


def _pressed(share: float, trials: Trials) -> Iterator[Finding]:
    scene = pressed_scene(penalty_parameter=share * _COMPLIANCE)
    result = trials.solve(scene, _pressed_body())
    yield from compared(result, exact_answer(scene, _pressed_body), _LIMIT)


def _pressed_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    return box((16, 8), (2, 1), comm=comm)


def _driven(
    coefficient: float, slip: float, penalty: float | None, trials: Trials
) -> Iterator[Finding]:
    scene = driven_scene(coefficient, _MOVED, -0.01, regularisation_parameter=slip * _MOVED)
    if penalty is not None:
        scene = with_contact(scene, penalty_parameter=penalty * _COMPLIANCE)
    result = trials.solve(scene, driven_body())
    exact = exact_answer(scene, driven_body, statuses_of(result))
    yield from compared(result, exact, _LIMIT)


def _slab(epsilon: float, trials: Trials) -> Iterator[Finding]:
    scene = with_contact(slab_scene(300.0), regularisation_parameter=epsilon)
    friction = trials.solve(scene).quantities["friction_force"][0]
    yield Finding("friction_force x", friction, _SLAB_FRICTION, 0.02, absolute=True)


PARAMETERS_CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"penalty_{share:.0e}",
            _THEME,
            f"ε₁ = {share:.0e} h/E, parabola on a block",
            EXACT,
            partial(_pressed, share),
        )
        for share in _PENALTIES
    ),
    *(
        HardCase(
            f"penalty_{share:.0e}",
            _THEME,
            f"ε₁ = {share:.0e} h/E: round-off drowns the springs",
            EXACT,
            partial(_pressed, share),
            expected=("solved", "not converged"),
            reason="round-off.*a larger penalty_parameter",
        )
        for share in (1e-13, 1e-14, 1e-15)
    ),
    *(
        HardCase(
            f"slip_{share:.0e}",
            _THEME,
            f"ε = {share:.0e} of the motion, driven block, μ = 0.5",
            EXACT,
            partial(_driven, 0.5, share, None),
        )
        for share in _SLIPS
    ),
    *(
        HardCase(
            f"large_mu_{coefficient:g}_slip_{slip:.0e}",
            _THEME,
            f"μ = {coefficient:g} and ε = {slip:.0e} of the motion, driven block",
            EXACT,
            partial(_driven, coefficient, slip, None),
        )
        for coefficient in (5.0, 10.0)
        for slip in (1e-6, 1e-10)
    ),
    HardCase(
        "slip_and_penalty",
        _THEME,
        "ε = 1e-10 and ε₁ = 1e-10 at once, driven block, μ = 3",
        EXACT,
        partial(_driven, 3.0, 1e-10, 1e-10),
    ),
    *(
        HardCase(
            f"slab_slip_{epsilon:.0e}",
            _THEME,
            f"ε = {epsilon:.0e}, slab under a given pressure",
            "the paper's example 1; value of a separate prototype",
            partial(_slab, epsilon),
        )
        for epsilon in (1e-6, 1e-10)
    ),
)


_THEME_UNITS = "Units and scales"
_LIMIT_UNITS = 1e-8
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
        yield Finding(f"change of {key}", apart / size, 0.0, _LIMIT_UNITS, absolute=True)


_SCENES: dict[str, tuple[str, Callable[[float, float], Made]]] = {
    "frictionless": ("parabola under force", _frictionless),
    "static": ("driven block, static law", _static),
    "incremental": ("parabola pressed and dragged, incremental law", _incremental),
    "pair": ("a block on another, with friction", _pair),
}
UNITS_CASES: tuple[HardCase, ...] = tuple(
    HardCase(
        f"units_{name}_{number}",
        _THEME_UNITS,
        f"{words}, in {unit}",
        "the same in MPa and mm",
        partial(_compared, make, scales),
    )
    for name, (words, make) in _SCENES.items()
    for number, (unit, scales) in enumerate(_UNITS.items(), 1)
)
