"""Two deformable bodies: stiff on soft, loose in each other, rolling on each other."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import MeshSource, Scene, Steps
from fenics_contact.scene.values import Profile
from fenics_contact.verification.boxes import LOWER, PRESSURE, RATIOS, UPPER, Slave, pair_scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.scenes import NU, STATICS, E, with_contact
from fenics_contact.verification.published import hertz_pair as hertz_pair_cases
from fenics_contact.verification.published.indenters import JOHNSON, MATERIAL, MODULUS

_THEME = "Two bodies"
_JUMP = 1e6


def _patch(slave: Slave, trials: Trials) -> Iterator[Finding]:
    """A uniform pressure crosses from a stiff block to a soft one, meshes that do not match."""
    moduli = {LOWER: E, UPPER: E * _JUMP}
    scene = with_contact(pair_scene("quadrilateral", (4, 6)), slave=slave, penalty_parameter="auto")
    materials = tuple(Material(moduli[name], RATIOS[name], on=name) for name in moduli)
    points = trials.solve(dataclasses.replace(scene, material=materials)).points
    assert points is not None
    worst = float(np.abs(points.contact_pressure / PRESSURE - 1).max())
    yield Finding("pressure error", worst, 0.0, 1e-7, absolute=True)


def _spheres(trials: Trials) -> Iterator[Finding]:
    """A stiff sphere pressed on a soft one of the same radius."""
    scene = hertz_pair_cases.pressed_scene("axisymmetric")
    scene = dataclasses.replace(
        scene,
        material=(Material(E, NU, on=LOWER), Material(E * _JUMP, NU, on=UPPER)),
        steps=Steps(),
    )
    scene = dataclasses.replace(
        scene, support=(scene.support[0], Support("upper.foot", {"y": -0.02}))
    )
    quantities = trials.solve(scene).quantities
    radius, force = 25.0, quantities["normal_force"]
    modulus = MODULUS / (1 + 1 / _JUMP)
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    peak = formulas.paraboloid(modulus, radius, a**2 / radius).peak
    yield Finding("max_contact_pressure", quantities["max_contact_pressure"], peak, 1e-2)
    yield Finding("contact radius", (quantities["contact_area"] / np.pi) ** 0.5, a, 2e-2)


_PIN, _HOLE, _DROP = 32.0, 33.0, 0.3


def _pin(trials: Trials) -> Iterator[Finding]:
    """A pin that lies loose in a recess and falls onto its bottom: 1/R is the difference."""
    both_modulus, both_radius = MODULUS / 2, 1 / (1 / _PIN - 1 / _HOLE)
    force = formulas.line_force(both_modulus, both_radius, 1.0)
    fine = {"fine": 1.5, "size": 0.125}
    scene = Scene(
        kinematics="plane strain",
        mesh=(
            MeshSource(
                mesh_file("cylinder.geo"),
                cell="quadrilateral",
                order=2,
                name="pin",
                parameters={"radius": _PIN, "contact_angle": 10, **fine},
            ),
            MeshSource(
                mesh_file("socket.geo"),
                cell="quadrilateral",
                order=2,
                name="socket",
                parameters={"radius": _HOLE, "drop": _DROP, **fine},
            ),
        ),
        material=MATERIAL,
        symmetry=("pin.axis", "socket.axis"),
        support=(Support("socket.foot", {"x": 0, "y": 0}),),
        load=(Load("pin.top", traction=(0, -force / 2 / _PIN)),),
        contact=(Contact("pin.contact", against="socket.contact", slave="on"),),
    )
    quantities = trials.solve(scene).quantities
    exact = formulas.line_contact(both_modulus, both_radius, force)
    yield Finding("normal_force", quantities["normal_force"], force / 2, 1e-7)
    yield Finding("max_contact_pressure", quantities["max_contact_pressure"], exact.peak, 2e-2)
    yield Finding("half-width", quantities["contact_area"], exact.radius, 2e-2)


def rocking_scene(offset: float, force: float) -> Scene:
    """Half of a disc that stands on its arc on rough ground, loaded off its middle."""
    radius = 8.0
    mean = force / (2 * radius)
    # A linear pressure has its resultant off the middle by slope (2R)²/12.
    change = 3 * offset / radius
    ends = (-mean * (1 - change), -mean * (1 + change))
    return Scene(
        kinematics="plane strain",
        mesh=(MeshSource(mesh_file("half_disc.geo"), cell="quadrilateral", order=2),),
        material=MATERIAL,
        load=(Load("face", traction=(0, Profile("x", (-radius, radius), ends))),),
        contact=(
            Contact(
                "contact",
                obstacle=Obstacle("plane", normal=(0, 1)),
                friction_coefficient=0.5,
            ),
        ),
    )


def _rocking(offset: float, trials: Trials) -> Iterator[Finding]:
    """It rolls until the ground pushes below the load."""
    force = formulas.line_force(MODULUS, 8.0, 0.3)
    result = trials.solve(rocking_scene(offset, force))
    points = result.points
    assert points is not None
    pushed = points.weights * points.contact_pressure * points.normals[:, 1]
    quantities = result.quantities
    carried = quantities["normal_force"] + quantities["friction_force"][1]
    yield Finding("pressure and friction carry", carried, force, 1e-8)
    rubbed = points.weights @ (
        points.friction_traction[:, 1] * points.coordinates[:, 0]
        - points.friction_traction[:, 0] * points.coordinates[:, 1]
    )
    sideways = points.weights * points.contact_pressure * points.normals[:, 0]
    moment = -pushed @ points.coordinates[:, 0] + sideways @ points.coordinates[:, 1] + rubbed
    yield Finding("moment / force", float(moment) / force, offset, 1e-6, absolute=True)


PAIRS_CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"pair_patch_{slave}",
            _THEME,
            f"a block 1e6 times as stiff on a soft one, slave '{slave}'",
            "a uniform pressure is exact",
            partial(_patch, slave),
        )
        for slave in ("on", "against")
    ),
    HardCase(
        "pair_spheres",
        _THEME,
        "a sphere 1e6 times as stiff on a soft one",
        f"{JOHNSON}, (4.22)-(4.24), E* of the soft one",
        _spheres,
    ),
    HardCase(
        "loose_pin",
        _THEME,
        "a pin that falls in a recess 3 % wider",
        f"{JOHNSON}, (4.43), (4.45), 1/R = 1/R₁ − 1/R₂",
        _pin,
    ),
    *(
        HardCase(
            f"rocking_{offset:g}",
            _THEME,
            f"half a disc on its arc, loaded {offset:g} off its middle",
            STATICS,
            partial(_rocking, offset),
        )
        for offset in (0.0, 0.8)
    ),
    HardCase(
        "rocking_3",
        _THEME,
        "the same, loaded beyond the end of the contact surface",
        STATICS,
        partial(_rocking, 3.0),
        ("refused", "not converged"),
        "no equilibrium.*rotation about z|[Oo]nly friction",
    ),
)
