"""Nearly incompressible bodies: neither locked, nor pressures ruined."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.bodies import box
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.scenes import ROLLER, plane_scene
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.point import (
    INDENTATION,
    JOHNSON,
    RADIUS,
    YOUNGS_MODULUS,
    half_space_scene,
)

THEME = "Nearly incompressible"
_RATIOS = (0.49, 0.499, 0.4999, 0.49999)
_LIMIT = 1e-2
_PARABOLOID = Obstacle("paraboloid", radius=RADIUS, indentation=INDENTATION)


def _hertz(ratio: float) -> formulas.HertzContact:
    modulus = formulas.plane_strain_modulus(YOUNGS_MODULUS, ratio)
    return formulas.paraboloid(modulus, RADIUS, INDENTATION)


def _compared(trials: Trials, scene: Scene, ratio: float, share: int = 1) -> Iterator[Finding]:
    """Force and peak pressure against Hertz's; one of `share` parts of the body is modelled."""
    quantities = trials.solve(scene).quantities
    exact = _hertz(ratio)
    yield Finding("normal_force", share * quantities["normal_force"], exact.force, _LIMIT)
    yield Finding("max_contact_pressure", quantities["max_contact_pressure"], exact.peak, _LIMIT)


def _axisymmetric(ratio: float, coefficient: float, trials: Trials) -> Iterator[Finding]:
    scene = dataclasses.replace(
        half_space_scene(_PARABOLOID), material=(Material(YOUNGS_MODULUS, ratio),)
    )
    if coefficient > 0:
        scene = with_friction(scene, coefficient)
    yield from _compared(trials, scene, ratio)


def _in_space(ratio: float, trials: Trials) -> Iterator[Finding]:
    scene = Scene(
        kinematics="3D",
        mesh=(
            MeshSource(
                mesh_file("quarter_space.geo"),
                parameters={"hexahedra": 1, "size": 0.6, "cells_outside": 5},
            ),
        ),
        material=(Material(YOUNGS_MODULUS, ratio),),
        discretisation=Discretisation(2),
        symmetry=("symmetry_x", "symmetry_y"),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=_PARABOLOID),),
    )
    yield from _compared(trials, scene, ratio, share=4)


def _confined(ratio: float, trials: Trials) -> Iterator[Finding]:
    """Between walls: the stiffness is that of compression waves, far above E."""
    depth = 1e-5
    walls = tuple(Support(side, {"x": 0}) for side in ("left", "right"))
    scene = plane_scene(
        Contact("top", obstacle=Obstacle("plane", position=(0, 1), indentation=depth)),
        (ROLLER, *walls),
        material=(Material(YOUNGS_MODULUS, ratio),),
    )
    quantities = trials.solve(scene, box((4, 4))).quantities
    modulus = YOUNGS_MODULUS * (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio))
    yield Finding("normal_force", quantities["normal_force"], depth * modulus, 1e-3)


CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"hertz_nu_{ratio:g}",
            THEME,
            f"ν = {ratio:g}, paraboloid on a half-space",
            f"{JOHNSON}, (4.22)-(4.24)",
            partial(_axisymmetric, ratio, 0.0),
        )
        for ratio in _RATIOS
    ),
    *(
        HardCase(
            f"hertz_3d_nu_{ratio:g}",
            THEME,
            f"ν = {ratio:g}, the same in 3D, a quarter",
            f"{JOHNSON}, (4.22)-(4.24)",
            partial(_in_space, ratio),
        )
        for ratio in _RATIOS
    ),
    HardCase(
        "friction_nu_0.49999",
        THEME,
        "ν = 0.49999 and μ = 0.6: pressing moves no surface sideways",
        f"{JOHNSON}, (4.22)-(4.24); section 5.1: no coupling at ν = ½",
        partial(_axisymmetric, 0.49999, 0.6),
    ),
    HardCase(
        "confined_nu_0.49999",
        THEME,
        "confined between walls, 16,000 times as stiff as E",
        "uniaxial strain, E (1 − ν)/((1 + ν)(1 − 2ν))",
        partial(_confined, 0.49999),
    ),
)
