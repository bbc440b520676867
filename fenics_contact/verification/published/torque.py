"""Laws whose depth, torque or ellipse of friction is known: compliance, a ring, a dragged block.

A ring in a tight ring, turned: what friction holds by Lamé's pressure, and what it does not. The
inner ring is turned by tractions along its bore and held by friction alone, which can carry a
torque of μ p 2π R² a length. The outer one is held at its rim.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, gamma, hypot, pi, radians, sin, sqrt
from typing import Literal, get_args

import numpy as np

from fenics_contact.analytic.two_bodies import Tube
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import OrthotropicFriction
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, Steps
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.scene.values import Path, Profile
from fenics_contact.simulation.runs import run
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.published.friction_bounds import (
    HEIGHT,
    LENGTH,
    block_of,
    stiff_block,
    stiff_pad,
)

_ACROSS, _POWER = 4e3, 2.0
_ALONG, _OWN_POWER = 800.0, 1.5
_DEPTH, _RADIUS = 0.01, 0.5
_LAWS = {
    "normal_law": {"kind": "normal compliance", "coefficient": _ACROSS, "exponent": _POWER},
    "friction_law": {"kind": "compliance", "coefficient": _ALONG, "exponent": _OWN_POWER},
}


def parabola_integral(power: float, radius: float = _RADIUS, depth: float = _DEPTH) -> float:
    """∫ ⟨d − x²/(2R)⟩^m dx over a line (length^(m + 1)).

    Args:
        power: The exponent m.
        radius: R (length).
        depth: The depth d in the middle (length).
    """
    half_width = sqrt(2 * radius * depth)
    shape = sqrt(pi) * gamma(power + 1) / gamma(power + 1.5)
    return float(depth**power * half_width * shape)


def _uniform(quick: bool) -> Iterator[Finding]:
    result = solved(stiff_block(_DEPTH, (_DEPTH,), _LAWS), block_of(4))
    normal, along = _ACROSS * _DEPTH**_POWER, _ALONG * _DEPTH**_OWN_POWER
    yield of_quantity(result, "normal_force", LENGTH * normal, 1e-3, ", uniform depth")
    yield of_quantity(result, "friction_force", LENGTH * along, 1e-3, ", uniform depth")


def _parabola(quick: bool) -> Iterator[Finding]:
    obstacle = Obstacle(
        "parabola",
        radius=_RADIUS,
        indentation=_DEPTH,
        position=(0, 0.2),
        displacement=(_DEPTH, 0),
    )
    result = solved(stiff_pad({"obstacle": obstacle, **_LAWS}), block_of(100 if quick else 400))
    normal = _ACROSS * parabola_integral(_POWER)
    along = _ALONG * parabola_integral(_OWN_POWER)
    yield of_quantity(result, "normal_force", normal, 1e-3, ", parabola")
    yield of_quantity(result, "friction_force", along, 1e-3, ", parabola")


def _both(quick: bool) -> Iterator[Finding]:
    yield from _uniform(quick)
    yield from _parabola(quick)


COMPLIANCE_CASES: tuple[Case, ...] = (
    Case(
        "compliance",
        "rough surfaces that give way, friction by a power of the depth",
        "Oden and Martins 1985, integrated over a uniform depth and over a parabola",
        _both,
    ),
)


Kinematics = Literal["plane stress", "3D"]

_BORE, _RADIUS_TORQUE, _OUTER, _LENGTH = 0.5, 1.0, 2.0, 0.5
_MODULUS, _RATIO, _INTERFERENCE, _COEFFICIENT = 1000.0, 0.3, 1e-3, 0.15
_HELD, _TOO_MUCH = (0.5, 0.98), 1.05  # of the torque that friction can carry


def limit_stress(kinematics: Kinematics) -> float:
    """Friction at its limit, μ p (stress); G. Lamé's u = a r + b/r is 0 at the outer ring's rim.

    Args:
        kinematics: ``plane stress``, or ``3D`` between ends that keep their length.
    """
    is_long = kinematics == "3D"
    modulus, ratio = _MODULUS, _RATIO
    if is_long:
        modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
    squares = (_OUTER / _RADIUS_TORQUE) ** 2
    hub = _RADIUS_TORQUE / modulus * (1 - ratio**2) * (squares - 1)
    hub /= 1 + ratio + (1 - ratio) * squares
    shaft = Tube(_BORE, _RADIUS_TORQUE, _MODULUS, _RATIO).compliance(
        _RADIUS_TORQUE, "outside", is_long
    )
    return _COEFFICIENT * _INTERFERENCE / (shaft + hub)


def turned_fit(kinematics: Kinematics, share: float) -> tuple[Scene, Body]:
    """Rings that are fitted at time 1 and turned at time 2, and their meshes.

    Args:
        kinematics: ``plane stress``, or ``3D`` between ends that keep their length.
        share: Torque over what friction can carry.
    """
    is_flat = kinematics == "plane stress"
    around, start, end, layers = (24, (), (), ()) if is_flat else (12, (0.0,), (_LENGTH,), (1,))
    parts = (
        Box("shaft", (0.0, _BORE, *start), (2 * pi, _RADIUS_TORQUE, *end), (around, 2, *layers)),
        Box("hub", (0.0, _RADIUS_TORQUE, *start), (2 * pi, _OUTER, *end), (around, 2, *layers)),
    )
    cell = "quadrilateral" if is_flat else "hexahedron"
    body = boxes(parts, cell, order=2, closed=("shaft", "hub"))
    places = body.mesh.geometry.x
    angles, radii = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0], places[:, 1] = radii * np.sin(angles), radii * np.cos(angles)
    shear = share * limit_stress(kinematics) * (_RADIUS_TORQUE / _BORE) ** 2  # at the bore
    ends = (-_BORE, _BORE)
    traction = Profile("y", ends, (shear, -shear)), Profile("x", ends, (-shear, shear))
    lengths = [Support(f"{part.name}.z{end}", {"z": 0.0}) for part in parts for end in (0, 1)]
    scene = Scene(
        kinematics=kinematics,
        material=(Material(_MODULUS, _RATIO),),
        support=(Support("hub.y1", {"x": 0.0, "y": 0.0}), *(() if is_flat else lengths)),
        load=(
            Load(
                "shaft.y0",
                traction=traction if is_flat else (*traction, 0.0),
                path=Path(time=(1, 2), factor=(0, 1)),
            ),
        ),
        contact=(
            Contact(
                "shaft.y1",
                against="hub.y0",
                interference=_INTERFERENCE,
                law="incremental",
                friction_coefficient=_COEFFICIENT,
            ),
        ),
        steps=Steps(times=(1.0, 2.0)),
        solver=SolverSettings(errors="none"),
    )
    return scene, body


def _torque(quick: bool) -> Iterator[Finding]:
    for kinematics in get_args(Kinematics)[: 1 if quick else None]:
        for share in _HELD:
            result = solved(*turned_fit(kinematics, share))
            label = f"{kinematics}, {share:g} of the limit"
            assert result.slip_limit is not None
            part = result.slip_limit.parts["shaft"]
            yield Finding(f"slip share, {label}", _number(part), share, 1e-3)
        answers = _answers(kinematics)
        label = f"{kinematics}, {_TOO_MUCH:g} of the limit"
        yield Finding(f"answers that pass, {label}", answers, 0, 0, absolute=True)


def _answers(kinematics: Kinematics) -> float:
    """Number of answers to a torque that friction cannot carry: none may pass."""
    scene, body = turned_fit(kinematics, _TOO_MUCH)
    try:
        return float(run(scene, body=body).passed)
    except NoEquilibriumError:
        return 0.0


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


TORQUE_CASES: tuple[Case, ...] = (
    Case(
        "torque",
        "a shaft in a tight hub, turned by half, nearly all, and more than friction holds",
        "G. Lamé's pressure, and statics: S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, "
        "1970, Section 28",
        _torque,
    ),
)


ALONG, ACROSS = 0.2, 0.5
# Unit vectors along the axes of the ellipse.
AXES = np.array([[0.8, 0.6], [-0.6, 0.8]])
LAW = OrthotropicFriction(
    kind="orthotropic", along=ALONG, across=ACROSS, direction=(*AXES[0].tolist(), 0.0)
)
_STIFFNESS, _DEPTH_ORTHOTROPIC, _WAY = 1e3, 0.01, 0.01
# What presses a block that is dragged on the ground (force).
PRESSING = _STIFFNESS * _DEPTH_ORTHOTROPIC * LENGTH**2
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
    return solved(
        stiff_block(_DEPTH_ORTHOTROPIC, way, keys, solver={"errors": "none"}), block_of(3, 3)
    )


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


ORTHOTROPIC_CASES: tuple[Case, ...] = (
    Case(
        "orthotropic",
        "friction that depends on the direction, by an ellipse",
        "the rule of flow along the ellipse's normal, and its half-diameter along the pull",
        _all,
    ),
)
