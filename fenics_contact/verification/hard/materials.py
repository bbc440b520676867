"""Stiffnesses that jump by a million, and pressures without bound at the edges of flat punches."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial
from math import pi, sqrt

import numpy as np
from mpi4py import MPI

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.exact import exact_answer
from fenics_contact.verification.hard.scenes import (
    CLAMPED,
    EXACT,
    NU,
    ROLLER,
    E,
    box,
    compared,
    driven_body,
    driven_scene,
    plane_scene,
)
from fenics_contact.verification.published.indenters import (
    JOHNSON,
    MATERIAL,
    MODULUS,
    half_space_scene,
)

_THEME = "Material jumps and flat punches"
_JUMP = 1e6
_DEPTH = 0.01


def _confined_modulus(modulus: float) -> float:
    return modulus * (1 - NU) / ((1 + NU) * (1 - 2 * NU))


def _series(below: float, above: float, trials: Trials) -> Iterator[Finding]:
    """Two layers between walls: springs in series."""
    body = box((4, 8), (1, 1), parts={"upper": lambda x: x[:, 1] > 0.5})
    walls = tuple(Support(side, {"x": 0}) for side in ("left", "right"))
    scene = plane_scene(
        Contact("top", obstacle=Obstacle("plane", position=(0, 1), indentation=_DEPTH)),
        (ROLLER, *walls),
        material=(Material(below, NU, on="rest"), Material(above, NU, on="upper")),
    )
    result = trials.solve(scene, body)
    softness = sum(0.5 / _confined_modulus(modulus) for modulus in (below, above))
    yield Finding("normal_force", result.quantities["normal_force"], _DEPTH / softness, 1e-3)
    yield _uneven(result)


def _uneven(result: Result) -> Finding:
    points = result.points
    assert points is not None
    pressure = points.contact_pressure
    return Finding("pressure, largest / smallest", pressure.max() / pressure.min(), 1.0, 1e-3)


def _parallel(trials: Trials) -> Iterator[Finding]:
    """Two columns side by side under a plate, ν = 0: springs in parallel."""
    body = box((8, 8), (1, 1), parts={"right_half": lambda x: x[:, 0] > 0.5})
    scene = plane_scene(
        Contact("top", obstacle=Obstacle("plane", position=(0, 1), indentation=_DEPTH)),
        (ROLLER, Support("left", {"x": 0})),
        material=(Material(E, 0.0, on="rest"), Material(E * _JUMP, 0.0, on="right_half")),
    )
    result = trials.solve(scene, body)
    stiff = _DEPTH * E * (1 + _JUMP) / 2
    yield Finding("normal_force", result.quantities["normal_force"], stiff, 1e-3)
    points = result.points
    assert points is not None
    soft = points.contact_pressure[points.coordinates[:, 0] < 0.5 - 1e-9]
    yield Finding("pressure on the soft one", float(soft.mean()), _DEPTH * E, 1e-2)


def _layer(trials: Trials) -> Iterator[Finding]:
    """A layer on a substrate a million times as stiff against a layer that is clamped."""

    def scene(height: float, *material: Material) -> Scene:
        obstacle = Obstacle("parabola", radius=2, position=(0.9, height), indentation=_DEPTH)
        return plane_scene(Contact("top", obstacle=obstacle), (CLAMPED,), material=material)

    body = box((16, 16), (2, 2), parts={"layer": lambda x: x[:, 1] > 1})
    layered = scene(2, Material(E * _JUMP, NU, on="rest"), Material(E, NU, on="layer"))
    result = trials.solve(layered, body)
    yield from compared(result, exact_answer(scene(1, Material(E, NU)), driven_body), 1e-3)


def _plate(trials: Trials) -> Iterator[Finding]:
    """A stiff plate drives the block in place of its top."""
    body = box((16, 12), (2, 1.5), parts={"plate": lambda x: x[:, 1] > 1})
    driven = driven_scene(0.5, 0.01, -0.01)
    plated = dataclasses.replace(
        driven, material=(Material(E, NU, on="rest"), Material(E * _JUMP, NU, on="plate"))
    )
    result = trials.solve(plated, body)
    yield from compared(result, exact_answer(driven, driven_body), 1e-3)


def _inclusion_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    def middle(x: np.ndarray) -> np.ndarray:
        return (np.abs(x[:, 0] - 1) < 0.25) & (np.abs(x[:, 1] - 0.5) < 0.25)

    return box((16, 8), (2, 1), parts={"inclusion": middle}, comm=comm)


def _inclusion(factor: float, trials: Trials) -> Iterator[Finding]:
    """A square inside of the driven block."""
    scene = dataclasses.replace(
        driven_scene(0.5, 0.01, -0.01),
        material=(Material(E, NU, on="rest"), Material(E * factor, NU, on="inclusion")),
    )
    result = trials.solve(scene, _inclusion_body())
    yield from compared(result, exact_answer(scene, _inclusion_body), 1e-3)


def _at(result: Result, place: float) -> tuple[float, float]:
    """Place and pressure of the point nearest to a distance from the axis."""
    points = result.points
    assert points is not None
    number = int(np.abs(points.coordinates[:, 0] - place).argmin())
    return float(points.coordinates[number, 0]), float(points.contact_pressure[number])


def _round_punch(trials: Trials) -> Iterator[Finding]:
    """The pressure is F/(2π a²)/√(1 − r²/a²), without bound at the edge."""
    obstacle = Obstacle("flat punch", radius=1, indentation=_DEPTH)
    mesh = {"fine": 2.0, "size": 1 / 32, "extent": 60, "cells_outside": 24}
    result = trials.solve(half_space_scene(obstacle, **mesh))
    force = formulas.flat_punch_force(MODULUS, 1.0, _DEPTH)
    yield Finding("normal_force", result.quantities["normal_force"], force, 1e-2)
    for place in (0.0, 0.5):
        r, pressure = _at(result, place)
        exact = force / (2 * pi) / sqrt(1 - r**2)
        yield Finding(f"pressure at r = {place:g} a", pressure, exact, 2e-2)


def _strip_punch(trials: Trials) -> Iterator[Finding]:
    """The pressure is P/(π √(a² − x²)), P the force; half of it is modelled."""
    force = 20.0
    mesh = {"fine": 2.0, "size": 1 / 32, "extent": 60, "cells_outside": 24}
    scene = Scene(
        kinematics="plane strain",
        mesh=(MeshSource(mesh_file("half_space.geo"), cell="quadrilateral", parameters=mesh),),
        material=MATERIAL,
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=Obstacle("flat punch", radius=1, force=force / 2)),),
    )
    result = trials.solve(scene)
    for place in (0.0, 0.5):
        x, pressure = _at(result, place)
        exact = force / (pi * sqrt(1 - x**2))
        yield Finding(f"pressure at x = {place:g} a", pressure, exact, 2e-2)


MATERIALS_CASES: tuple[HardCase, ...] = (
    HardCase(
        "soft_below",
        _THEME,
        "confined layers, the upper one 1e6 times as stiff",
        "springs in series",
        partial(_series, E, E * _JUMP),
    ),
    HardCase(
        "soft_above",
        _THEME,
        "confined layers, the lower one 1e6 times as stiff",
        "springs in series",
        partial(_series, E * _JUMP, E),
    ),
    HardCase(
        "columns",
        _THEME,
        "columns side by side, one 1e6 times as stiff",
        "springs in parallel",
        _parallel,
    ),
    HardCase(
        "layer",
        _THEME,
        "parabola on a layer on a substrate 1e6 times as stiff",
        f"the layer clamped: {EXACT}",
        _layer,
    ),
    HardCase(
        "plate",
        _THEME,
        "driven block with a plate on it 1e6 times as stiff",
        f"without the plate, its top driven: {EXACT}",
        _plate,
    ),
    *(
        HardCase(
            f"inclusion_{factor:.0e}",
            _THEME,
            f"driven block with a square inside, {factor:.0e} times as stiff",
            EXACT,
            partial(_inclusion, factor),
        )
        for factor in (_JUMP, 1 / _JUMP)
    ),
    HardCase(
        "round_punch",
        _THEME,
        "flat round punch, pressure without bound at its edge",
        f"{JOHNSON}, section 3.4",
        _round_punch,
    ),
    HardCase(
        "strip_punch",
        _THEME,
        "flat punch in plane strain, by force",
        f"{JOHNSON}, section 2.8",
        _strip_punch,
    ),
)
