"""Friction by an ellipse: a stiff block that is dragged, and one that is about to slide."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, hypot, radians, sin

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import OrthotropicFriction
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import SolverSettings
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.laws.stiff_block import HEIGHT, LENGTH, block_of, stiff_block

ALONG, ACROSS = 0.2, 0.5
# Unit vectors along the axes of the ellipse.
AXES = np.array([[0.8, 0.6], [-0.6, 0.8]])
LAW = OrthotropicFriction(
    kind="orthotropic", along=ALONG, across=ACROSS, direction=(*AXES[0].tolist(), 0.0)
)
_STIFFNESS, _DEPTH, _WAY = 1e3, 0.01, 0.01
# What presses a block that is dragged on the ground (force).
PRESSING = _STIFFNESS * _DEPTH * LENGTH**2
_PRESSURE, _SHARE = 4.0, 0.97
_ANGLES, _FEWER = (0, 10, 25, 50, 70, 90), (10, 50)


def sliding_friction(way: Array) -> Array:
    """Friction by a unit pressure on points that slide, −M² v/|M v| (points, 2).

    Args:
        way: Where to they slide, along the ground's axes, (points, 2) (length).
    """
    coefficients = np.array([ALONG, ACROSS])
    own = way @ AXES.T
    sizes = np.linalg.norm(coefficients * own, axis=1)[:, None]
    force = -(coefficients**2 * own) / np.where(sizes > 0, sizes, 1.0)
    return np.asarray(force @ AXES)


def dragged(direction: tuple[float, ...]) -> Result:
    """A block that is pressed on springs and dragged over them; collective.

    Args:
        direction: Of the slip, a unit vector along the ground.
    """
    keys = {"foundation_stiffness": _STIFFNESS, "friction_law": LAW}
    way = tuple(_WAY * component for component in direction)
    return solved(stiff_block(_DEPTH, way, keys, solver={"errors": "none"}), block_of(3, 3))


def _dragged(angle: int) -> Iterator[Finding]:
    direction = (cos(radians(angle)), sin(radians(angle)))
    found = dragged(direction).quantities["friction_force"][:2]
    expected = PRESSING * sliding_friction(np.array([direction]))[0]
    for axis, value, right in zip("xy", found, expected, strict=True):
        yield Finding(f"friction_force_{axis}, dragged along {angle}°", value, right, 1e-3)


def starting_to_slide(angle: float, share: float) -> Scene:
    """A block that is pressed on the ground, and pulled by a share of what makes it slide.

    It slides at |Q| = P / √(cos²θ/μ₁² + sin²θ/μ₂²), the point of the ellipse in that direction.

    Args:
        angle: θ of the pull, from the axis of ``along`` (degrees).
        share: Of that force.
    """
    way = np.array([cos(radians(angle)), sin(radians(angle))])
    limit = _PRESSURE / hypot(*(way / np.array([ALONG, ACROSS])))
    pull = share * limit * way @ AXES
    return Scene(
        kinematics="3D",
        material=(Material(1e6, 0.0),),
        support=(Support("block.z1", {"z": 0}),),
        load=(Load("block", body_force=(*(pull / HEIGHT), 0.0)),),
        contact=(Contact("block.z0", pressure=_PRESSURE, friction_law=LAW),),
        solver=SolverSettings(errors="none"),
    )


def _about_to_slide(angle: int) -> Iterator[Finding]:
    result = solved(starting_to_slide(angle, _SHARE), block_of(2, 3))
    share = result.model["used_share_of_limit_load"]
    yield Finding(f"share of limit load, pulled along {angle}°", share, _SHARE, 1e-3)


def _all(quick: bool) -> Iterator[Finding]:
    for angle in _FEWER if quick else _ANGLES:
        yield from _dragged(angle)
        yield from _about_to_slide(angle)


CASES: tuple[Case, ...] = (
    Case(
        "orthotropic",
        "friction that depends on the direction, by an ellipse",
        "the rule of flow along the ellipse's normal, and its half-diameter along the pull",
        _all,
    ),
)
