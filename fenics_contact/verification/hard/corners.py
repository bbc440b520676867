"""Hard cases at corners, and of bodies that keep their volume."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial

import numpy as np
from mpi4py import MPI

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.exact import exact_answer, statuses_of
from fenics_contact.verification.hard.scenes import (
    ASIDE,
    EXACT,
    NU,
    ROLLER,
    E,
    box,
    compared,
    plane_scene,
)
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import (
    INDENTATION,
    JOHNSON,
    RADIUS,
    YOUNGS_MODULUS,
    half_space_scene,
)

_THEME = "Corners, shared nodes and single facets"
_DOWN, _ASIDE = 10.0, 6.0
_UNIFORM = "uniform stress"


def _corner_scene(down: float, aside: float, coefficient: float) -> Scene:
    """A unit square in a corner of floor and wall, pressed into it."""
    return plane_scene(
        tuple(Contact(on, friction_coefficient=coefficient) for on in ("bottom", "left")),
        load=(Load("top", traction=(0, -down)), Load("right", traction=(-aside, 0))),
    )


def _pressures(result: Result, number: int) -> np.ndarray:
    points = result.points
    assert points is not None
    return np.asarray(points.contact_pressure[points.of(number)])


def _corner(trials: Trials) -> Iterator[Finding]:
    result = trials.solve(_corner_scene(_DOWN, _ASIDE, 0.0), box((8, 8)))
    for number, (on, expected) in enumerate((("floor", _DOWN), ("wall", _ASIDE))):
        worst = float(np.abs(_pressures(result, number) / expected - 1).max())
        yield Finding(f"pressure error, {on}", worst, 0.0, 1e-7, absolute=True)


def _mirrored_corner(trials: Trials) -> Iterator[Finding]:
    """With friction: the same with floor and wall exchanged."""
    one, other = (
        trials.solve(_corner_scene(*loads, 0.3), box((8, 8)))
        for loads in ((_DOWN, _ASIDE), (_ASIDE, _DOWN))
    )
    for number in (0, 1):
        ours, theirs = _pressures(one, number), _pressures(other, 1 - number)
        apart = float(np.abs(ours - theirs).max()) / _DOWN
        yield Finding(f"pressures exchanged, contact {number}", apart, 0.0, 1e-7, absolute=True)
    ours_up = sum(contact["quantities"]["contact_force"][1] for contact in one.contacts)
    yield Finding("floor and wall carry the load", ours_up, _DOWN, 1e-7)


def _slot(trials: Trials) -> Iterator[Finding]:
    """Between two walls that squeeze it, on a floor: plane strain under two pressures."""
    squeeze = 0.01
    scene = plane_scene(
        (
            Contact("bottom"),
            Contact("left"),
            Contact("right", obstacle=Obstacle("plane", position=(1, 0), indentation=squeeze)),
        ),
        load=(Load("top", traction=(0, -_DOWN)),),
    )
    result = trials.solve(scene, box((8, 8)))
    aside = (E * squeeze + NU * (1 + NU) * _DOWN) / (1 - NU**2)
    for number, expected in enumerate((_DOWN, aside, aside)):
        worst = float(np.abs(_pressures(result, number) / expected - 1).max())
        yield Finding(f"pressure error, contact {number}", worst, 0.0, 1e-3, absolute=True)


def _shared_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    return box((16, 8), (2, 1), comm=comm)


def _shared(coefficient: float, trials: Trials) -> Iterator[Finding]:
    """A cantilever pressed from below: its corner belongs to the clamp and to the contact."""
    obstacle = Obstacle("plane", indentation=0.02)
    scene = plane_scene(
        Contact("bottom", obstacle=obstacle, friction_coefficient=coefficient),
        (Support("left", {"x": 0, "y": 0}),),
    )
    result = trials.solve(scene, _shared_body())
    exact = exact_answer(scene, _shared_body, statuses_of(result))
    yield from compared(result, exact, 1e-3)


def _one_facet(kinematics: str, degree: int, trials: Trials) -> Iterator[Finding]:
    """A single cell on a floor under a uniform pressure."""
    in_space = kinematics == "3D"
    aside = (ASIDE, Support("front", {"y": 0})) if in_space else (ASIDE,)
    scene = plane_scene(
        Contact("bottom"),
        aside,
        (Load("top", pressure=_DOWN),),
        kinematics=kinematics,
        discretisation=Discretisation(degree),
    )
    result = trials.solve(scene, box((1, 1, 1) if in_space else (1, 1)))
    worst = float(np.abs(_pressures(result, 0) / _DOWN - 1).max())
    yield Finding("pressure error", worst, 0.0, 1e-9, absolute=True)


def _one_facet_sliding(trials: Trials) -> Iterator[Finding]:
    """A single cell dragged far: all of it slides, and friction is μ times the force."""
    scene = plane_scene(
        Contact("bottom", friction_coefficient=0.2), (Support("top", {"x": 0.5, "y": -0.1}),)
    )
    result = trials.solve(scene, box((1, 1), (4, 1)))
    quantities = result.quantities
    ratio = -quantities["friction_force"][0] / quantities["normal_force"]
    yield Finding("friction / normal force", ratio, 0.2, 1e-7)
    exact = exact_answer(scene, lambda comm: box((1, 1), (4, 1), comm=comm), statuses_of(result))
    yield from compared(result, exact, 1e-3)


def _one_point(trials: Trials) -> Iterator[Finding]:
    """A parabola smaller than a facet touches in one point."""
    obstacle = Obstacle("parabola", radius=0.05, position=(1, 1), indentation=1e-3)
    scene = plane_scene(Contact("top", obstacle=obstacle), (Support("bottom", {"x": 0, "y": 0}),))
    result = trials.solve(scene, _shared_body())
    yield from compared(result, exact_answer(scene, _shared_body), 1e-3)


CORNERS_CASES: tuple[HardCase, ...] = (
    HardCase("corner", _THEME, "floor and wall meet at a corner", _UNIFORM, _corner),
    HardCase(
        "corner_rough",
        _THEME,
        "the same with friction, held by nothing else",
        "floor and wall exchanged",
        _mirrored_corner,
    ),
    HardCase("slot", _THEME, "floor and two walls that squeeze", _UNIFORM, _slot),
    HardCase(
        "shared_nodes", _THEME, "a corner both clamped and in contact", EXACT, partial(_shared, 0.0)
    ),
    HardCase("shared_nodes_rough", _THEME, "the same with friction", EXACT, partial(_shared, 0.5)),
    *(
        HardCase(
            f"one_facet_{kinematics.replace(' ', '_')}_{degree}",
            _THEME,
            f"a contact of one facet, {kinematics}, degree {degree}",
            _UNIFORM,
            partial(_one_facet, kinematics, degree),
        )
        for kinematics, degree in (("plane strain", 1), ("plane strain", 2), ("3D", 1), ("3D", 2))
    ),
    HardCase(
        "one_facet_sliding",
        _THEME,
        "one facet that slides",
        f"Coulomb's law; {EXACT}",
        _one_facet_sliding,
    ),
    HardCase("one_point", _THEME, "a contact in a single point", EXACT, _one_point),
)


_THEME_INCOMPRESSIBLE = "Nearly incompressible"
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


INCOMPRESSIBLE_CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"hertz_nu_{ratio:g}",
            _THEME_INCOMPRESSIBLE,
            f"ν = {ratio:g}, paraboloid on a half-space",
            f"{JOHNSON}, (4.22)-(4.24)",
            partial(_axisymmetric, ratio, 0.0),
        )
        for ratio in _RATIOS
    ),
    *(
        HardCase(
            f"hertz_3d_nu_{ratio:g}",
            _THEME_INCOMPRESSIBLE,
            f"ν = {ratio:g}, the same in 3D, a quarter",
            f"{JOHNSON}, (4.22)-(4.24)",
            partial(_in_space, ratio),
        )
        for ratio in _RATIOS
    ),
    HardCase(
        "friction_nu_0.49999",
        _THEME_INCOMPRESSIBLE,
        "ν = 0.49999 and μ = 0.6: pressing moves no surface sideways",
        f"{JOHNSON}, (4.22)-(4.24); section 5.1: no coupling at ν = ½",
        partial(_axisymmetric, 0.49999, 0.6),
    ),
    HardCase(
        "confined_nu_0.49999",
        _THEME_INCOMPRESSIBLE,
        "confined between walls, 16,000 times as stiff as E",
        "uniaxial strain, E (1 − ν)/((1 + ν)(1 − 2ν))",
        partial(_confined, 0.49999),
    ),
)
