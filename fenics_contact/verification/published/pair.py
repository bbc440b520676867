"""Pressures between two bodies on meshes that do not match.

A uniform one crosses the interface exactly, whichever surface is the slave; one that is not
converges to that of an Airy stress function (``airy``).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi, sqrt
from typing import Any, Literal

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact.analytic.two_bodies import AiryField
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.loading import load_body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene, SolverSettings
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.boxes import (
    CELLS,
    LOWER,
    PRESSURE,
    RATIOS,
    SLAVES,
    UPPER,
    Cell,
    block,
    pair_scene,
    pressures,
    trusted,
    with_contact,
)
from fenics_contact.verification.case import Case, Finding, solved

# Cells along a side: below and above.
_PLANE_PAIRS = {"1:1": (4, 4), "2:3": (4, 6), "1:7": (2, 14)}
_SPACE_PAIRS = {"1:1": (2, 2), "2:3": (2, 3), "1:7": (1, 7)}
_VOLUME = 2.0

_MEAN, _AMPLITUDE = 1.0, 0.6
_MODULI = {LOWER: 1000.0, UPPER: 10000.0}
_COARSE, _FINE = (12, 18), (24, 36)


def _patch(quick: bool) -> Iterator[Finding]:
    """The worst of both degrees and both slaves."""
    for cell in CELLS[::3] if quick else CELLS:
        pairs = _SPACE_PAIRS if cell in ("hexahedron", "tetrahedron") else _PLANE_PAIRS
        for ratio, cells in pairs.items():
            if quick and ratio != "2:3":
                continue
            stress, pressure = _patch_errors(pair_scene(cell, cells))
            yield Finding(f"stress error, {cell}, {ratio}", stress, 0, 1e-9, absolute=True)
            yield Finding(f"pressure error, {cell}, {ratio}", pressure, 0, 1e-7, absolute=True)


def _patch_errors(scene: Scene) -> tuple[float, float]:
    """Of stress and pressure, over the pressure: the largest of both degrees and slaves."""
    body = load_body(scene.mesh, scene.dimension, MPI.COMM_WORLD)
    stress, pressure = [], []
    for degree in (1, 2):
        for slave in SLAVES:
            chosen = dataclasses.replace(scene, discretisation=Discretisation(degree))
            run, result = trusted(with_contact(chosen, slave=slave), body)
            stress.append(_stress_error(run))
            pressure.append(float(np.abs(pressures(result) / PRESSURE - 1).max()))
    return max(stress), max(pressure)


def _stress_error(run: Run) -> float:
    """What stresses differ from the uniform one in the mean square, over the pressure."""
    problem = run.problem
    assert run.solution is not None
    problem.displacement.x.array[:] = run.solution.displacement.reshape(-1)
    size = problem.spaces.components
    expected = np.zeros((3, 3))
    expected[size - 1, size - 1] = -PRESSURE
    error = problem.elastic.stress() - ufl.as_matrix(expected.tolist())
    squares = sum(error[i, j] ** 2 for i in range(size) for j in range(size))
    local = fem.assemble_scalar(form_cache.form(squares * problem.spaces.bulk))
    return sqrt(total(problem.comm, local) / _VOLUME) / PRESSURE


def _airy_scene(cells: tuple[int, int]) -> tuple[Scene, AiryField]:
    """Two blocks, held around them as the stress function has it, and the field below."""
    fields = {n: AiryField(_MEAN, _AMPLITUDE, pi, 1.0, e, RATIOS[n]) for n, e in _MODULI.items()}
    supports = []
    for name, field in fields.items():
        far = f"{name}.{'bottom' if name == LOWER else 'top'}"
        supports.append(Support(far, {"x": field.along, "y": field.across}))
        supports += [Support(f"{name}.{side}", {"x": field.along}) for side in ("left", "right")]
    penalty = 1e-8 / max(cells) / max(_MODULI.values())
    scene = Scene(
        kinematics="plane strain",
        mesh=tuple(block(name, count) for name, count in zip(fields, cells, strict=True)),
        material=tuple(Material(_MODULI[name], RATIOS[name], on=name) for name in fields),
        support=tuple(supports),
        contact=(Contact("upper.bottom", against="lower.top", penalty_parameter=penalty),),
    )
    return scene, fields[LOWER]


def _pressure_error(scene: Scene, field: AiryField) -> float:
    """Of the contact pressure in the mean square, relative."""
    points = solved(scene).points
    assert points is not None
    exact = field.pressure(points.coordinates[:, 0])
    squares = points.weights @ (points.contact_pressure - exact) ** 2
    return sqrt(squares / (points.weights @ exact**2))


def _airy(quick: bool) -> Iterator[Finding]:
    coarse, field = _airy_scene(_COARSE)
    fine, _ = _airy_scene(_FINE)
    for slave in SLAVES:
        error = _pressure_error(with_contact(coarse, slave=slave), field)
        label = f"pressure error, {_COARSE[0]}:{_COARSE[1]}, slave '{slave}'"
        yield Finding(label, error, 0, 5e-3, absolute=True)
        finer = _pressure_error(with_contact(fine, slave=slave), field)
        order = float(np.log2(error / finer))
        yield Finding(f"order, slave '{slave}'", order, 2, 0.1, absolute=True)


PAIR_CASES: tuple[Case, ...] = (
    Case("patch", "uniform pressure across meshes that do not match", "exact", _patch),
    Case(
        "airy",
        "pressure p₀ + p₁ cos kx between two bodies",
        "Airy stress function; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970",
        _airy,
    ),
)


_COEFFICIENT = 0.3
_PAIRS: dict[Cell, tuple[int, int]] = {"quadrilateral": (4, 6), "hexahedron": (2, 3)}
_SETTINGS = SolverSettings(tolerance=1e-12, outer_tolerance=1e-12)
# The full solver takes the penetration from two displacements: round-off in the pressure is about
# 1e-16 over this, so that a stiffer penalty would hide what the solvers have in common.
_EPSILON = 1e-2

_SOFT = 300.0
_BENT, _BENT_CELLS = 0.004, {LOWER: 12, UPPER: 18}
_INDEPENDENT = "an independent computation"


def _uneven(x: Array) -> Any:
    """A pressure on top, (points,) (stress)."""
    return PRESSURE * (1 + 0.3 * np.cos(pi * x[0]))


def _difference(one: Array, other: Array) -> float:
    """Largest difference of two arrays of this rank over the largest value; collective."""
    comm = MPI.COMM_WORLD
    return largest(comm, np.abs(one - other)) / largest(comm, np.abs(other))


def _solvers(quick: bool) -> Iterator[Finding]:
    """Newton's method on the jump alone against that on all displacements."""
    for cell, cells in list(_PAIRS.items())[: 1 if quick else 2]:
        for coefficient in (0.0, _COEFFICIENT):
            scene = pair_scene(cell, cells, _uneven, _EPSILON)
            scene = with_contact(scene, friction_coefficient=coefficient)
            condensed, full = _fields(scene, "condensed"), _fields(scene, "full")
            for number, quantity in enumerate(("displacement", "pressure")):
                difference = _difference(condensed[number], full[number])
                label = f"{quantity}, {cell}, friction {coefficient:g}"
                yield Finding(label, difference, 0, 1e-10, absolute=True)


def _fields(scene: Scene, solver: Literal["condensed", "full"]) -> tuple[Array, Array]:
    """Displacements of this rank and all contact pressures (length; stress)."""
    settings = dataclasses.replace(_SETTINGS, solver=solver)
    run, result = trusted(dataclasses.replace(scene, solver=settings))
    assert run.solution is not None
    return run.solution.displacement, pressures(result)


def _rough_scene() -> Scene:
    scene = pair_scene("quadrilateral", _PAIRS["quadrilateral"], _uneven)
    return with_contact(scene, friction_coefficient=_COEFFICIENT)


def _reaction(quick: bool) -> Iterator[Finding]:
    """What the contact carries against what the lower block's support does."""
    for slave in SLAVES:
        result = solved(with_contact(_rough_scene(), slave=slave))
        (support,) = (row for row in result.supports if row["on"] == "lower.bottom")
        force = result.quantities["normal_force"]
        yield Finding(f"normal_force, slave '{slave}'", force, support["reaction"][1], 1e-7)


def _meshes(quick: bool) -> Iterator[Finding]:
    """Two meshes against two parts of one."""
    below, above = _PAIRS["quadrilateral"]
    single = MeshSource(
        mesh_file("two_blocks.geo"),
        cell="quadrilateral",
        parameters={"cells_below": below, "cells_above": above},
    )
    scene = dataclasses.replace(_rough_scene(), solver=_SETTINGS)
    two, one = solved(scene), solved(dataclasses.replace(scene, mesh=(single,)))
    difference = _difference(pressures(two), pressures(one))
    yield Finding("pressure", difference, 0, 1e-12, absolute=True)
    for quantity in ("normal_force", "strain_energy"):
        yield Finding(quantity, two.quantities[quantity], one.quantities[quantity], 1e-12)


def _bent_scene(ratio: float) -> Scene:
    """A soft block, bent so that a part of it touches a stiff one; the ratio is of their moduli."""

    def bent(x: Array) -> Any:
        return _BENT * (1 + 2 * np.cos(pi * x[0]))

    penalty = 1e-4 / _BENT_CELLS[LOWER] / _SOFT
    return Scene(
        kinematics="plane strain",
        mesh=tuple(block(name, cells) for name, cells in _BENT_CELLS.items()),
        material=(Material(_SOFT, 0.3, on=LOWER), Material(_SOFT * ratio, 0.3, on=UPPER)),
        support=(
            Support("lower.bottom", {"x": 0, "y": bent}),
            Support("upper.top", {"x": 0, "y": 0}),
        ),
        contact=(
            Contact("lower.top", against="upper.bottom", slave="on", penalty_parameter=penalty),
        ),
    )


def _rigid(quick: bool) -> Iterator[Finding]:
    """The stiff block against a rigid plane in its place."""
    plane = Obstacle("plane", position=(0, 0))
    rigid = solved(with_contact(_bent_scene(1), against=None, slave="auto", obstacle=plane))
    for ratio, tolerance in ((1e3, 1.2e-3), (1e6, 2e-6)):
        stiff, label = solved(_bent_scene(ratio)), f"moduli 1:{ratio:.0e}"
        for quantity in ("normal_force", "max_contact_pressure", "contact_area"):
            value, reference = stiff.quantities[quantity], rigid.quantities[quantity]
            yield Finding(f"{quantity}, {label}", value, reference, tolerance)
        difference = _difference(pressures(stiff), pressures(rigid))
        yield Finding(f"pressure, {label}", difference, 0, tolerance, absolute=True)


PAIR_WAYS_CASES: tuple[Case, ...] = (
    Case("pair_solvers", "two bodies, condensed against full solver", _INDEPENDENT, _solvers),
    Case("pair_reaction", "two bodies, contact force against support", "equilibrium", _reaction),
    Case("pair_meshes", "two meshes against two parts of one mesh", _INDEPENDENT, _meshes),
    Case("pair_rigid", "stiff body on a soft one against a rigid plane", "moduli 1:∞", _rigid),
)
