"""Bodies that friction or their own weight hold: just below, at and just above the limit load."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial
from math import asinh, atan, cos, hypot, sin, sqrt

import numpy as np

from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import Ending, HardCase, Trials
from fenics_contact.verification.hard.scenes import NU, SPECIFICATION, STATICS, E, box, plane_scene
from fenics_contact.verification.published.friction import incline_scene
from fenics_contact.verification.published.shear import slab_scene

_THEME = "At the limit load"
# The slab's friction: bound 90 over a length of 8.
_SLAB_LIMIT = 720.0
# ∫ |r| over the unit square about its middle: what a bound of 1 resists.
PAD_LIMIT = (sqrt(2) + asinh(1)) / 6
_TIPS = 2.5
_WEIGHT = 10.0
_HELD: tuple[Ending, ...] = ("solved",)
_REFUSED: tuple[Ending, ...] = ("refused",)


def _slab(end_load: float, trials: Trials) -> Iterator[Finding]:
    """Only friction resists the end load."""
    scene = slab_scene(end_load)
    scene = dataclasses.replace(scene, support=scene.support[:1])
    result = trials.solve(scene)
    friction = result.quantities["friction_force"][0]
    yield Finding("friction_force x", friction, end_load, 1e-7)
    share = float(result.model["used_share_of_limit_load"])
    yield Finding("share of the limit load", share, end_load / _SLAB_LIMIT, 1e-7, absolute=True)


def pad_scene(torque: float) -> Scene:
    """A unit square pad under a given pressure with g = 1, twisted by shear on its four sides."""
    height = 0.5
    shear = torque / (2 * height)  # two couples of arm 1 and area `height`
    sides = {"left": (0, -1), "right": (0, 1), "front": (1, 0), "back": (-1, 0)}
    return Scene(
        kinematics="3D",
        material=(Material(E, NU),),
        support=(Support("top", {"z": 0}),),
        load=tuple(Load(on, traction=(shear * x, shear * y, 0)) for on, (x, y) in sides.items()),
        contact=(Contact("bottom", pressure=2, friction_coefficient=0.5),),
    )


def _pad(share: float, trials: Trials) -> Iterator[Finding]:
    torque = share * PAD_LIMIT
    result = trials.solve(pad_scene(torque), box((8, 8, 2), (1, 1, 0.5)))
    points = result.points
    assert points is not None
    arms = points.coordinates[:, :2] - 0.5
    forces = points.weights[:, None] * points.friction_traction
    resisted = float(np.sum(arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]))
    yield Finding("torque of friction", -resisted, torque, 1e-6)
    found = float(result.model["used_share_of_limit_load"])
    yield Finding("share of the limit torque", found, share, 1e-3, absolute=True)


def _tipping(side: float, trials: Trials) -> Iterator[Finding]:
    """W × H = 1 × 2 with (Fx, −10) on its top: where the floor's resultant acts is known."""
    scene = plane_scene(
        Contact("bottom", friction_coefficient=2),
        load=(Load("top", traction=(side, -_WEIGHT)),),
    )
    result = trials.solve(scene, box((8, 16), (1, 2)))
    quantities = result.quantities
    yield Finding("normal_force", quantities["normal_force"], _WEIGHT, 1e-8)
    yield Finding("friction_force x", quantities["friction_force"][0], -side, 1e-6)
    place = 0.5 + 2 * side / _WEIGHT
    yield Finding("where the floor pushes", _centre(result), place, 1e-6, absolute=True)


def _centre(result: Result) -> float:
    """Of the contact pressure, along x (length)."""
    points = result.points
    assert points is not None
    forces = points.weights * points.contact_pressure
    return float(forces @ points.coordinates[:, 0] / forces.sum())


def _incline(coefficient: float, trials: Trials) -> Iterator[Finding]:
    """On a slope of 1 in 10 a block rests from μ = .1 on."""
    quantities = trials.solve(incline_scene(coefficient)).quantities
    angle = atan(0.1)
    yield Finding("normal_force / G", quantities["normal_force"] / 2, cos(angle), 1e-8)
    yield Finding(
        "|friction_force| / G", hypot(*quantities["friction_force"]) / 2, sin(angle), 1e-6
    )


def _pushed(side: float, trials: Trials) -> Iterator[Finding]:
    """A block 2 × 1 that only μ = .5 times its weight of 20 holds back."""
    scene = plane_scene(
        Contact("bottom", friction_coefficient=0.5), load=(Load("top", traction=(side, -10)),)
    )
    quantities = trials.solve(scene, box((8, 8), (2, 1))).quantities
    yield Finding("normal_force", quantities["normal_force"], 20, 1e-8)
    yield Finding("friction_force x", quantities["friction_force"][0], -2 * side, 1e-6)


_FRICTION = "times what friction can hold"
LIMIT_LOADS_CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"slab_{load:.2f}",
            _THEME,
            f"slab held by friction alone, end load {load:.2f}, limit 720",
            f"limit g·8 = 720: {SPECIFICATION}",
            partial(_slab, load),
            _HELD if load < _SLAB_LIMIT else _REFUSED,
            _FRICTION,
        )
        for load in (719.0, 719.99, 720.0, 720.01)
    ),
    *(
        HardCase(
            f"pad_{share:g}",
            _THEME,
            f"twisted pad in 3D, {share:g} of the limit torque .38260",
            "limit torque g ∫ |r| = (√2 + asinh 1)/6",
            partial(_pad, share),
            _HELD if share < 1 else _REFUSED,
            _FRICTION,
        )
        for share in (0.9, 0.999, 1.001, 1.1)
    ),
    *(
        HardCase(
            f"tipping_{side:g}",
            _THEME,
            f"block pushed at its top by {side:g}, tips at 2.5",
            STATICS,
            partial(_tipping, side),
            _HELD if side < _TIPS else _REFUSED,
            "rotation about z.*(push it away|nothing presses)",
        )
        for side in (2.4, 2.49, 2.499, 2.5, 2.6)
    ),
    *(
        HardCase(
            f"incline_{coefficient:g}",
            _THEME,
            f"two bodies, a slope of 0.1 and μ = {coefficient:g}",
            STATICS,
            partial(_incline, coefficient),
            _HELD if coefficient > 0.1 else ("refused", "not converged"),
            "[Oo]nly friction|friction can hold",
        )
        for coefficient in (0.101, 0.1001, 0.0999)
    ),
    *(
        HardCase(
            f"pushed_{side:g}",
            _THEME,
            f"block pushed by {side:g} on a floor that holds 5",
            STATICS,
            partial(_pushed, side),
            _HELD if side < 5 else ("refused", "not converged"),
            "[Oo]nly friction|friction can hold|runs away",
        )
        for side in (4.9, 4.99, 4.995, 4.999, 4.9999, 5.001)
    ),
)
