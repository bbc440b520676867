"""Meshes that grow, flatten and twist: patch tests, and Hertz's pressure."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.verification.boxes import LOWER, UPPER, block
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.scenes import ASIDE, NU, E, box, plane_scene
from fenics_contact.verification.published.indenters import (
    HERTZ,
    INDENTATION,
    JOHNSON,
    RADIUS,
    half_space_scene,
)

_THEME = "Graded and distorted meshes"
_PRESSURE = 10.0
_PATCH_LIMIT = 1e-7
_EXACT = "a uniform pressure is exact on any mesh"


def _pressed(kinematics: str, degree: int) -> Scene:
    """A body on a floor, free to widen, under a uniform pressure on its top."""
    aside = (ASIDE, Support("front", {"y": 0})) if kinematics == "3D" else (ASIDE,)
    return plane_scene(
        Contact("bottom"),
        aside,
        (Load("top", pressure=_PRESSURE),),
        kinematics=kinematics,
        discretisation=Discretisation(degree),
    )


def _pressure_error(result: Result, limit: float) -> Finding:
    """Largest error of the pressure, which is uniform."""
    points = result.points
    assert points is not None
    worst = float(np.abs(points.contact_pressure / _PRESSURE - 1).max())
    return Finding("pressure error", worst, 0.0, limit, absolute=True)


def _patch(body: Body, kinematics: str, degree: int, trials: Trials) -> Iterator[Finding]:
    result = trials.solve(_pressed(kinematics, degree), body)
    yield _pressure_error(result, _PATCH_LIMIT)
    assert result.points is not None
    volume = result.points.weights.sum()
    modulus = E if kinematics == "3D" else E / (1 - NU**2)
    energy = _PRESSURE**2 * volume / (2 * modulus)
    yield Finding("strain_energy", result.quantities["strain_energy"], energy, 1e-7)


def _layered(aspect: float, degree: int, trials: Trials) -> Iterator[Finding]:
    """Cells that get ever flatter towards the floor, up to so much longer than high."""
    cells = 16
    lowest = 1 / (4 * aspect)  # over the height; all are a quarter long
    growth = brentq(lambda g: (g**cells - 1) / (g - 1) * lowest - 1, 1.01, 10)

    def move(x: Array) -> Array:
        up = (growth ** (x[:, 1] * cells) - 1) / (growth**cells - 1)
        return np.stack([x[:, 0], up], axis=1)

    yield from _patch(box((4, cells), (1, 1), move), "plane strain", degree, trials)


def _sheet(aspect: float, degree: int, trials: Trials) -> Iterator[Finding]:
    """Cells that are so much longer than high, eight of them over the body."""
    body = box((16, 8), (1, 1), lambda x: x * [1, 0.5 / aspect])
    yield _pressure_error(trials.solve(_pressed("plane strain", degree), body), _PATCH_LIMIT)


def _graded(ratio: float, degree: int, trials: Trials) -> Iterator[Finding]:
    """Cells that grow by a constant ratio, both ways, from the corner at the origin."""

    def move(x: Array) -> Array:
        return np.asarray(np.expm1(x * np.log(ratio)) / (ratio - 1))

    yield from _patch(box((12, 12), (1, 1), move), "plane strain", degree, trials)


def _twisted(x: Array, size: float) -> Array:
    """Nodes inside moved to and fro; those of the boundary stay."""
    bubble = np.prod(np.sin(np.pi * x), axis=1) ** 0.5
    wave = np.stack([np.sin(37 * x.sum(axis=1) + 5 * axis) for axis in range(x.shape[1])], axis=1)
    return np.asarray(x + size * bubble[:, None] * wave)


def _distorted(kinematics: str, simplices: bool, degree: int, trials: Trials) -> Iterator[Finding]:
    in_space = kinematics == "3D"
    cells, size = ((5, 5, 5), 0.04) if in_space else ((10, 10), 0.03)
    body = box(cells, move=lambda x: _twisted(x, size), simplices=simplices)
    yield from _patch(body, kinematics, degree, trials)


def _paraboloid(trials: Trials, scene: Scene, body: Body | None, limit: float) -> Iterator[Finding]:
    quantities = trials.solve(scene, body).quantities
    yield Finding("normal_force", quantities["normal_force"], HERTZ.force, limit)
    yield Finding("max_contact_pressure", quantities["max_contact_pressure"], HERTZ.peak, limit)


_OBSTACLE = Obstacle("paraboloid", radius=RADIUS, indentation=INDENTATION)


def _far(extent: float, trials: Trials) -> Iterator[Finding]:
    """Far cells grow until they are a thousand times as long as wide and more."""
    scene = half_space_scene(_OBSTACLE, extent=extent, cells_outside=24)
    yield from _paraboloid(trials, scene, None, 5e-3)


def _distorted_hertz(trials: Trials) -> Iterator[Finding]:
    """The nodes inside the fine part are moved by up to a quarter of a cell."""
    size, fine = 0.25, 5.0
    scene = half_space_scene(_OBSTACLE, size=size)
    body = load_body(scene.mesh, 2, MPI.COMM_WORLD)
    x = body.mesh.geometry.x
    inside = (x[:, 0] > 1e-9) & (x[:, 0] < fine - 1e-9) & (x[:, 1] < -1e-9) & (x[:, 1] > -fine)
    phase = 37 * (x[inside, 0] / fine) + 53 * (x[inside, 1] / fine)
    x[inside, 0] += 0.25 * size * np.sin(phase)
    x[inside, 1] += 0.25 * size * np.sin(phase + 2)
    yield from _paraboloid(trials, scene, body, 1e-2)


def _flat_pair(aspect: float, trials: Trials) -> Iterator[Finding]:
    """Two flat bodies on each other, meshes that do not match."""
    height = 1 / (8 * aspect) * 4
    scene = plane_scene(
        Contact("upper.bottom", against="lower.top"),
        (
            Support("lower.bottom", {"y": 0}),
            Support("lower.left", {"x": 0}),
            Support("upper.left", {"x": 0}),
        ),
        (Load("upper.top", pressure=_PRESSURE),),
        mesh=(
            block(LOWER, 8, base=-height, height=height, cells_across=4),
            block(UPPER, 11, height=height, cells_across=4),
        ),
        material=(Material(E, NU, on=LOWER), Material(E, NU, on=UPPER)),
    )
    yield _pressure_error(trials.solve(scene), 1e-6)


MESHES_CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"{name}_{aspect:.0e}_q{degree}",
            _THEME,
            f"{where}, cells {aspect:.0e} times as long as high, degree {degree}",
            _EXACT,
            partial(solve, aspect, degree),
        )
        for name, where, solve in (
            ("layers", "at the floor", _layered),
            ("sheet", "a thin sheet", _sheet),
        )
        for aspect in (1e3, 1e4)
        for degree in (1, 2)
    ),
    HardCase(
        "flat_pair_1e+03",
        _THEME,
        "two bodies, cells 1e+03 times as long as high",
        _EXACT,
        partial(_flat_pair, 1e3),
    ),
    *(
        HardCase(
            f"graded_{ratio:.0e}",
            _THEME,
            f"cells that grow by {ratio:.0e} over the body",
            _EXACT,
            partial(_graded, ratio, 2),
        )
        for ratio in (1e3, 1e6)
    ),
    *(
        HardCase(
            f"distorted_{name}",
            _THEME,
            f"twisted {name} of degree {degree}",
            _EXACT,
            partial(_distorted, kinematics, simplices, degree),
        )
        for name, kinematics, simplices, degree in (
            ("quadrilaterals", "plane strain", False, 2),
            ("triangles", "plane strain", True, 1),
            ("hexahedra", "3D", False, 1),
            ("tetrahedra", "3D", True, 2),
        )
    ),
    *(
        HardCase(
            f"hertz_extent_{extent:.0e}",
            _THEME,
            f"paraboloid, cells from 1/8 to {extent / 3:.0e}",
            f"{JOHNSON}, (4.22)-(4.24)",
            partial(_far, extent),
        )
        for extent in (6e3, 6e4)
    ),
    HardCase(
        "hertz_distorted",
        _THEME,
        "paraboloid on twisted cells of 1/4",
        f"{JOHNSON}, (4.22)-(4.24)",
        _distorted_hertz,
    ),
)
