"""Pressures between two bodies on meshes that do not match.

A uniform one crosses the interface exactly, whichever surface is the slave; one that is not
converges to that of an Airy stress function (``airy``).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi, sqrt

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact.analytic.two_bodies import AiryField
from fenics_contact.common import form_cache
from fenics_contact.common.parallel import total
from fenics_contact.mesh.loading import load_body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.block_pair import (
    CELLS,
    LOWER,
    PRESSURE,
    RATIOS,
    SLAVES,
    UPPER,
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


CASES: tuple[Case, ...] = (
    Case("patch", "uniform pressure across meshes that do not match", "exact", _patch),
    Case(
        "airy",
        "pressure p₀ + p₁ cos kx between two bodies",
        "Airy stress function; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970",
        _airy,
    ),
)
