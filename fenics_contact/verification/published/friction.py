"""Friction of published cases, and of a block on an incline.

Contact with Coulomb friction: the paper's examples 2 to 4, and partial slip. The static law acts
on the total displacement, the incremental one on the slip of a load step.

A deformable block on a deformable slope, meshes that do not match: statics gives the forces. The
slope rises by tan α towards +x and the block, of weight G, rests on it: on rough ground it stays
with N = G cos α and T = G sin α; a horizontal push F that moves it up is G (μ + tan α) / (1 − μ
tan α).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import atan, cos, hypot, sin, sqrt
from typing import Any, Literal

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.common.program import mesh_file
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.simulation.runs import run
from fenics_contact.verification.boxes import LOWER, UPPER, block
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.published.indenters import (
    HERTZ,
    INDENTATION,
    JOHNSON,
    MATERIAL,
    RADIUS,
    YOUNGS_MODULUS,
    annulus_scene,
    half_space_scene,
)
from fenics_contact.verification.published.shear import winkler_scene

_SLOPE, _COEFFICIENT, _TOO_SMOOTH = 0.1, 0.3, 0.099
_WEIGHT = 2.0
_LENGTH, _HEIGHT = 2.0, 1.0
_MODULI = {LOWER: 1000.0, UPPER: 3000.0}
# More than the parts' deformations, and little of their size.
_PUSHED = 0.01


def incline_scene(coefficient: float, pushed: float | None = None) -> Scene:
    """A block on a slope.

    Args:
        coefficient: Of friction.
        pushed: How far the block's rear is moved, horizontally (length); None leaves it free.
    """
    rear = () if pushed is None else (Support("upper.left", {"x": pushed}),)
    weight = _WEIGHT / (_LENGTH * _HEIGHT)
    return Scene(
        kinematics="plane strain",
        mesh=(
            block(LOWER, 14, slope=_SLOPE, left=-2, length=6, cells_across=3),
            block(UPPER, 9, slope=_SLOPE, length=_LENGTH, height=_HEIGHT, cells_across=4),
        ),
        material=tuple(Material(modulus, 0.3, on=name) for name, modulus in _MODULI.items()),
        support=(Support("lower.bottom", {"x": 0, "y": 0}), *rear),
        load=(Load(UPPER, body_force=(0, -weight)),),
        contact=(Contact("upper.bottom", against="lower.top", friction_coefficient=coefficient),),
        solver=SolverSettings(tolerance=1e-12, outer_tolerance=1e-10),
    )


def _pushed(quick: bool) -> Iterator[Finding]:
    result = solved(incline_scene(_COEFFICIENT, _PUSHED))
    (rear,) = (row["reaction"] for row in result.supports if row["on"] == "upper.left")
    expected = (_COEFFICIENT + _SLOPE) / (1 - _COEFFICIENT * _SLOPE)
    yield Finding("F / G", rear[0] / _WEIGHT, expected, 1e-8, absolute=True)


def _resting(quick: bool) -> Iterator[Finding]:
    angle = atan(_SLOPE)
    quantities = solved(incline_scene(_COEFFICIENT)).quantities
    normal = quantities["normal_force"]
    yield Finding("normal_force", normal, _WEIGHT * cos(angle), 1e-9)
    friction = hypot(*quantities["friction_force"])
    yield Finding("|friction_force|", friction, _WEIGHT * sin(angle), 1e-9)
    yield Finding("answers with friction too small", _answers(), 0, 0, absolute=True)


def _answers() -> float:
    """Number of answers to a block that slides down: it is to be refused."""
    try:
        return float(run(incline_scene(_TOO_SMOOTH)).converged)
    except NoEquilibriumError:
        return 0.0


INCLINE_CASES: tuple[Case, ...] = (
    Case(
        "incline", "block pushed up a slope, both deformable", "statics of a rigid block", _pushed
    ),
    Case(
        "resting", "block at rest on a slope, both deformable", "statics of a rigid block", _resting
    ),
)


_COEFFICIENT_FRICTION = 0.6
# Static law: forces at the same indentation, peaks at the same force, stick over contact radius.
_FORCE_RATIO, _PEAK_RATIO, _STICK_RATIO = 1.0247, 1.0764, 0.765
# Incremental law: number of equal steps in the indentation → stick over contact radius.
_STICK_RATIOS = {1: 0.765, 5: 0.932, 20: 0.984, 60: 0.992}
_FORCE_60_STEPS = 4210.9
# The zone that slips after 60 steps is .02 wide: cells of a sixteenth have points .03 apart.
_STEPS_MESH = {"fine": 3.0, "size": 0.0625, "cells_outside": 12}
_QUICK_MESH = {"fine": 3.0, "size": 0.125, "cells_outside": 12}

_BLOCK_SIDE, _BLOCK_PEAK_RATIO = 8.0, 1.068
_ANNULUS_COEFFICIENT, _ANNULUS_RATIO = 0.3, 1.0231
_DEFLECTION, _CONTACT_END, _FRICTION = 0.0578, 3.20, 8.20

_SHEARED = (Material(YOUNGS_MODULUS, 0.49),)
_SHEARED_MODULUS = formulas.plane_strain_modulus(YOUNGS_MODULUS, 0.49)
_SHEARED_COEFFICIENT = 0.5
# Half-width over radius is small: the obstacle then moves sideways by little of the half-width.
_CYLINDER_RADIUS, _HALF_WIDTH = 400.0, 1.0
# Needs 3/4 of the shear that makes all of the contact slip.
_SIDEWAYS = 0.00336

_PAPER = "Campos, Oden & Kikuchi 1982"
_PROTOTYPE = "data reconstructed; values of a separate prototype"


def with_friction(
    scene: Scene, coefficient: float, law: Literal["static", "incremental"] = "static"
) -> Scene:
    """The scene with Coulomb friction on its contact."""
    contact = dataclasses.replace(scene.contact[0], friction_coefficient=coefficient, law=law)
    return dataclasses.replace(scene, contact=(contact,))


def stick_ratio(result: Result) -> float:
    """Stick radius over contact radius, each of the circle that has the area."""
    return sqrt(result.quantities["stick_area"] / result.quantities["contact_area"])


def _paraboloid_scene(mesh: dict[str, float] | None = None, **driven: Any) -> Scene:
    return half_space_scene(Obstacle("paraboloid", radius=RADIUS, **driven), **(mesh or {}))


def _ratio(scene: Scene, coefficient: float, quantity: str) -> tuple[float, Result]:
    """A quantity with friction over that without, and the result with friction."""
    rough, smooth = solved(with_friction(scene, coefficient)), solved(scene)
    return rough.quantities[quantity] / smooth.quantities[quantity], rough


def _sphere(quick: bool) -> Iterator[Finding]:
    pressed = _paraboloid_scene(_QUICK_MESH if quick else None, indentation=INDENTATION)
    ratio, rough = _ratio(pressed, _COEFFICIENT_FRICTION, "normal_force")
    yield Finding("force, with / without friction", ratio, _FORCE_RATIO, 1e-3, absolute=True)
    yield Finding("stick / contact radius", stick_ratio(rough), _STICK_RATIO, 1e-2, absolute=True)
    if not quick:
        loaded = _paraboloid_scene(force=HERTZ.force)
        ratio, _ = _ratio(loaded, _COEFFICIENT_FRICTION, "max_contact_pressure")
        yield Finding("peak, with / without friction", ratio, _PEAK_RATIO, 2e-3, absolute=True)


def _steps(quick: bool) -> Iterator[Finding]:
    scene = with_friction(
        _paraboloid_scene(_STEPS_MESH, indentation=INDENTATION),
        _COEFFICIENT_FRICTION,
        "incremental",
    )
    scene = dataclasses.replace(scene, solver=SolverSettings(strategy="monolithic"))
    for number, expected in _STICK_RATIOS.items():
        if quick and number > 5:
            return
        result = solved(dataclasses.replace(scene, steps=Steps(number)))
        label = f"stick / contact radius, {number} step{'s' * (number > 1)}"
        yield Finding(label, stick_ratio(result), expected, 1e-2, absolute=True)
        if number == 60:
            yield of_quantity(result, "normal_force", _FORCE_60_STEPS, 2e-3, ", 60 steps")


def _block(quick: bool) -> Iterator[Finding]:
    side = _BLOCK_SIDE
    scene = Scene(
        kinematics="axisymmetric",
        mesh=(
            MeshSource(
                mesh_file("slab.geo"),
                cell="quadrilateral",
                parameters={"length": side, "height": side, "cells_along": 64, "cells_across": 64},
            ),
        ),
        material=MATERIAL,
        symmetry=("left",),
        support=(Support("bottom", {"y": 0}),),
        contact=(
            Contact(
                "top",
                obstacle=Obstacle(
                    "paraboloid", radius=RADIUS, position=(0, side), force=HERTZ.force
                ),
            ),
        ),
    )
    ratio, _ = _ratio(scene, _COEFFICIENT_FRICTION, "max_contact_pressure")
    yield Finding("peak, with / without friction", ratio, _BLOCK_PEAK_RATIO, 5e-3, absolute=True)


def _annulus(quick: bool) -> Iterator[Finding]:
    ratio, _ = _ratio(annulus_scene(), _ANNULUS_COEFFICIENT, "normal_force")
    yield Finding("force, with / without friction", ratio, _ANNULUS_RATIO, 1e-3, absolute=True)


def _winkler(quick: bool) -> Iterator[Finding]:
    result = solved(with_friction(winkler_scene(100), 1.0))
    quantities = result.quantities
    assert result.points is not None
    yield Finding("w(0)", -float(result.points.gap[0]), _DEFLECTION, 1e-2)
    yield Finding("contact end", quantities["contact_area"], _CONTACT_END, 0.05, absolute=True)
    yield of_quantity(result, "friction_force", _FRICTION, 1e-2)


def _sheared_scene(steps: int) -> Scene:
    """A parabola pressed on a strip in the first step, then pushed sideways in others."""
    obstacle = Obstacle(
        "parabola",
        radius=_CYLINDER_RADIUS,
        force=formulas.line_force(_SHEARED_MODULUS, _CYLINDER_RADIUS, _HALF_WIDTH),
        displacement=(_SIDEWAYS, 0),
        displacement_path=Path(time=(1.0, 1.0 + steps), factor=(0.0, 1.0)),
    )
    scene = Scene(
        kinematics="plane strain",
        mesh=(MeshSource(mesh_file("strip.geo"), cell="quadrilateral"),),
        material=_SHEARED,
        support=(Support("bottom", {"x": 0, "y": 0}),),
        contact=(Contact("contact", obstacle=obstacle),),
        steps=Steps(1 + steps, 1.0 + steps),
        solver=SolverSettings(strategy="monolithic"),
    )
    return with_friction(scene, _SHEARED_COEFFICIENT, "incremental")


def _cattaneo(quick: bool) -> Iterator[Finding]:
    """c/a = √(1 − Q/(μ P)) with the shear Q and the pressure P that the run found."""
    steps = 3 if quick else 6
    result = solved(_sheared_scene(steps))
    for step in result.steps[steps // 3 :: steps // 3]:
        quantities = step["quantities"]
        strongest = _SHEARED_COEFFICIENT * quantities["normal_force"]
        share = abs(quantities["friction_force"][0]) / strongest
        ratio = quantities["stick_area"] / quantities["contact_area"]
        label = f"stick / contact width, Q = {share:.2f} μP"
        yield Finding(label, ratio, sqrt(1 - share), 0.015, absolute=True)


FRICTION_CASES: tuple[Case, ...] = (
    Case(
        "friction_sphere",
        "paraboloid with friction, static law",
        f"{_PAPER}, example 3; ratios of an independent integral equation solution",
        _sphere,
    ),
    Case(
        "friction_steps",
        "paraboloid with friction, incremental law",
        f"{_PAPER}, example 3; values of a separate prototype, self-similar limit .993",
        _steps,
    ),
    Case(
        "friction_block",
        "paraboloid with friction on a short cylinder",
        f"{_PAPER}, example 3; {_PROTOTYPE}",
        _block,
    ),
    Case(
        "friction_annulus",
        "flat annular punch with friction",
        f"{_PAPER}, example 4; value of a separate prototype",
        _annulus,
    ),
    Case(
        "friction_winkler",
        "slab on a Winkler foundation with friction",
        f"{_PAPER}, example 2; {_PROTOTYPE}",
        _winkler,
    ),
    Case(
        "cattaneo",
        "cylinder pressed, then pushed sideways",
        f"C. Cattaneo, Rend. Accad. Lincei 27 (1938); {JOHNSON}, section 7.2",
        _cattaneo,
    ),
)
