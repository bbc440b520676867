"""One answer on two deformable bodies in several ways, which must agree."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi
from typing import Any, Literal

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import MeshSource, Scene, SolverSettings
from fenics_contact.verification.block_pair import (
    LOWER,
    PRESSURE,
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


CASES: tuple[Case, ...] = (
    Case("pair_solvers", "two bodies, condensed against full solver", _INDEPENDENT, _solvers),
    Case("pair_reaction", "two bodies, contact force against support", "equilibrium", _reaction),
    Case("pair_meshes", "two meshes against two parts of one mesh", _INDEPENDENT, _meshes),
    Case("pair_rigid", "stiff body on a soft one against a rigid plane", "moduli 1:∞", _rigid),
)
