"""Two deformable bodies on meshes that do not match: patch tests, and one answer in several ways.

A uniform pressure crosses the interface exactly, whichever surface is the slave; a pressure that
is not uniform converges to that of an Airy stress function (``airy``).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi
from typing import Any, Literal

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact.gmsh_files import load_body
from fenics_contact.mesh import Body
from fenics_contact.parallel import largest, total
from fenics_contact.result import Result
from fenics_contact.scene import (
    Discretisation,
    Load,
    MeshSource,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.scene_contact import Contact, Obstacle
from fenics_contact.scene_material import Material
from fenics_contact.simulation import Run
from fenics_contact.verification.airy import AiryField
from fenics_contact.verification.case import Case, Finding, UntrustedError, mesh_file, solved

LOWER, UPPER = "lower", "upper"
Slave = Literal["on", "against"]

_PRESSURE = 5.0
_MODULI = {LOWER: 300.0, UPPER: 1000.0}
_RATIOS = {LOWER: 0.2, UPPER: 0.3}
_EPSILON = 1e-6  # times h/E
# Where two ways of solving are compared: forces of a stiffer penalty on the difference of two
# displacements have a round-off of 1e-16 over it, 1e-10 at the other.
_SOFT_EPSILON = 1e-2
_CELLS = ("quadrilateral", "triangle", "hexahedron", "tetrahedron")
# Cells along a side: below and above.
_FINER = {"1:1": (4, 4), "2:3": (4, 6), "1:7": (2, 14)}
_FINER_3D = {"1:1": (2, 2), "2:3": (2, 3), "1:7": (1, 7)}
_TIGHT = 1e-12

_WAVE = (1.0, 0.6)  # mean pressure and amplitude
_AIRY_MODULI = {LOWER: 1000.0, UPPER: 10000.0}
_AIRY_CELLS = ((12, 18), (24, 36))


def block(name: str, cells: int, cell: str = "quadrilateral", **parameters: float) -> MeshSource:
    """A unit square above or below y = 0, or what the parameters of ``block.geo`` make of it."""
    base = 0 if name == UPPER else -1
    sizes = {"base": base, "cells_along": cells, "cells_across": cells}
    shape: Any = cell
    return MeshSource(
        mesh_file("block.geo"), cell=shape, name=name, parameters=sizes | parameters
    )


def _brick(name: str, cells: int, cell: str) -> MeshSource:
    """A unit cube above or below z = 0."""
    parameters = {
        "base": 0 if name == UPPER else -1,
        "cells_along": cells,
        "hexahedra": int(cell == "hexahedron"),
    }
    return MeshSource(mesh_file("brick.geo"), name=name, parameters=parameters)


def pair_scene(cell: str, cells: tuple[int, int], pressed: Any = _PRESSURE) -> Scene:
    """A block on another, held below and pressed from above.

    Args:
        cell: Type of the cells.
        cells: Along a side of the lower and of the upper block.
        pressed: Pressure on top (stress).
    """
    in_space = cell in ("hexahedron", "tetrahedron")
    make = _brick if in_space else block
    sides = {"left": "x"} | ({"front": "y"} if in_space else {})
    held = tuple(
        Support(f"{name}.{side}", {axis: 0})  # type: ignore[dict-item]
        for name in _MODULI
        for side, axis in sides.items()
    )
    spacing = 1 / max(cells)
    return Scene(
        kinematics="3D" if in_space else "plane strain",
        mesh=tuple(make(name, count, cell) for name, count in zip(_MODULI, cells, strict=True)),
        material=tuple(Material(_MODULI[name], _RATIOS[name], on=name) for name in _MODULI),
        support=(Support("lower.bottom", {"z" if in_space else "y": 0}), *held),
        load=(Load("upper.top", pressure=pressed),),
        contact=(
            Contact(
                "upper.bottom",
                against="lower.top",
                penalty_parameter=_EPSILON * spacing / _MODULI[UPPER],
            ),
        ),
    )


def with_slave(scene: Scene, slave: Slave) -> Scene:
    """The scene with the slave surface chosen."""
    contact = dataclasses.replace(scene.contact[0], slave=slave)
    return dataclasses.replace(scene, contact=(contact,))


def trusted(scene: Scene, body: Body | None = None) -> tuple[Run, Result]:
    """Solve a scene and keep its fields; collective.

    Raises:
        UntrustedError: It did not converge, or a check failed.
    """
    run = Run(scene, body=body)
    result = run.solve()
    if not result.passed:
        raise UntrustedError(result.verdict)
    return run, result


def pressures(result: Result) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Contact pressures at all points (stress)."""
    assert result.points is not None
    return result.points.contact_pressure


def _stress_error(run: Run) -> float:
    """Root mean square of what stresses differ from the uniform one, over the pressure."""
    problem, comm = run.problem, run.problem.comm
    assert run.solution is not None
    problem.displacement.x.array[:] = run.solution.displacement.reshape(-1)
    size = problem.spaces.components
    along = ufl.as_vector([0] * (size - 1) + [1])
    stress = problem.elastic.stress()
    in_plane = ufl.as_matrix([[stress[i, j] for j in range(size)] for i in range(size)])
    error = in_plane + _PRESSURE * ufl.outer(along, along)
    squares = fem.form(ufl.inner(error, error) * problem.spaces.bulk)
    volume = 2.0
    mean = total(comm, fem.assemble_scalar(squares)) / volume
    return float(np.sqrt(mean)) / _PRESSURE


def _patch(quick: bool) -> Iterator[Finding]:
    """The worst of both degrees and both slaves, each cell and ratio."""
    for cell in _CELLS:
        in_space = cell in _CELLS[2:]
        for ratio, cells in (_FINER_3D if in_space else _FINER).items():
            if quick and (ratio != "2:3" or cell == "hexahedron"):
                continue
            scene = pair_scene(cell, cells)
            body = load_body(scene.mesh, scene.dimension, MPI.COMM_WORLD)
            stress, pressure = 0.0, 0.0
            for degree in (1, 2):
                for slave in ("on", "against"):
                    chosen = with_slave(scene, slave)  # type: ignore[arg-type]
                    chosen = dataclasses.replace(chosen, discretisation=Discretisation(degree))
                    run, result = trusted(chosen, body)
                    stress = max(stress, _stress_error(run))
                    worst = np.abs(pressures(result) / _PRESSURE - 1).max()
                    pressure = max(pressure, float(worst))
            label = f"{cell}, {ratio}"
            yield Finding(f"stress error, {label}", stress, 0, 1e-9, absolute=True)
            yield Finding(f"pressure error, {label}", pressure, 0, 1e-7, absolute=True)


def _uneven(x: np.ndarray[Any, Any]) -> Any:
    """A pressure on top that bends the bodies (stress)."""
    return _PRESSURE * (1 + 0.3 * np.cos(pi * x[0]))


def _difference(one: Any, other: Any) -> float:
    """Largest difference of two arrays over the largest value; collective."""
    comm = MPI.COMM_WORLD
    return largest(comm, np.abs(one - other)) / largest(comm, np.abs(other))


def _rough(scene: Scene, coefficient: float, **changes: float) -> Scene:
    """The scene with friction, and with other changes of its contact."""
    contact = dataclasses.replace(
        scene.contact[0], friction_coefficient=coefficient, **changes
    )  # type: ignore[arg-type]
    return dataclasses.replace(scene, contact=(contact,))


def _solvers(quick: bool) -> Iterator[Finding]:
    """Newton on the jump alone against Newton on all displacements."""
    for cell, cells in (("quadrilateral", (4, 6)), ("hexahedron", (2, 3))):
        if quick and cell == "hexahedron":
            return
        for coefficient in (0.0, 0.3):
            epsilon = _SOFT_EPSILON / max(cells) / _MODULI[UPPER]
            scene = pair_scene(cell, cells, _uneven)
            scene = _rough(scene, coefficient, penalty_parameter=epsilon)
            found = []
            for solver in ("condensed", "full"):
                settings = SolverSettings(solver=solver, tolerance=_TIGHT, outer_tolerance=_TIGHT)  # type: ignore[arg-type]
                run, result = trusted(dataclasses.replace(scene, solver=settings))
                assert run.solution is not None
                found.append((run.solution.displacement, pressures(result)))
            for number, name in enumerate(("displacement", "pressure")):
                difference = _difference(found[0][number], found[1][number])
                label = f"{name}, {cell}, friction {coefficient:g}"
                yield Finding(label, difference, 0, 1e-10, absolute=True)


def _reaction(quick: bool) -> Iterator[Finding]:
    """What the contact carries against what the lower block's support does."""
    for slave in ("on", "against"):
        scene = _rough(pair_scene("quadrilateral", (4, 6), _uneven), 0.3)
        result = solved(with_slave(scene, slave))  # type: ignore[arg-type]
        (support,) = (row for row in result.supports if row["on"] == "lower.bottom")
        force = result.quantities["normal_force"]
        yield Finding(f"normal_force, slave '{slave}'", force, support["reaction"][1], 1e-7)


def _one_mesh(quick: bool) -> Iterator[Finding]:
    """Two parts of one mesh against two meshes."""
    two = _rough(pair_scene("quadrilateral", (4, 6), _uneven), 0.3)
    settings = SolverSettings(tolerance=_TIGHT, outer_tolerance=_TIGHT)
    two = dataclasses.replace(two, solver=settings)
    mesh = MeshSource(
        mesh_file("two_blocks.geo"),
        cell="quadrilateral",
        parameters={"cells_below": 4, "cells_above": 6},
    )
    results = [solved(dataclasses.replace(two, mesh=source)) for source in ((mesh,), two.mesh)]
    one, other = (pressures(result) for result in results)
    yield Finding("pressure", _difference(one, other), 0, 1e-12, absolute=True)
    for quantity in ("normal_force", "strain_energy"):
        one, other = (result.quantities[quantity] for result in results)
        yield Finding(quantity, one, other, 1e-12)


def _airy_scene(cells: tuple[int, int]) -> tuple[Scene, AiryField]:
    """Two blocks with the displacements of an Airy stress function around them."""
    fields = {
        name: AiryField(*_WAVE, pi, 1.0, modulus, _RATIOS[name])
        for name, modulus in _AIRY_MODULI.items()
    }
    supports = []
    for name, field in fields.items():
        outside = "bottom" if name == LOWER else "top"
        supports += [
            Support(f"{name}.{outside}", {"y": field.across}),
            *(Support(f"{name}.{side}", {"x": field.along}) for side in ("left", "right")),
        ]
        supports.append(Support(f"{name}.{outside}", {"x": field.along}))
    scene = Scene(
        kinematics="plane strain",
        mesh=tuple(block(name, count) for name, count in zip(fields, cells, strict=True)),
        material=tuple(Material(_AIRY_MODULI[name], _RATIOS[name], on=name) for name in fields),
        support=tuple(supports),
        contact=(
            Contact(
                "upper.bottom",
                against="lower.top",
                penalty_parameter=1e-8 / max(cells) / max(_AIRY_MODULI.values()),
            ),
        ),
    )
    return scene, fields[LOWER]


def _pressure_error(scene: Scene, field: AiryField) -> float:
    """Error of the pressure in the mean square, relative."""
    points = solved(scene).points
    assert points is not None
    exact = field.pressure(points.coordinates[:, 0])
    squares = points.weights @ (points.contact_pressure - exact) ** 2
    return float(np.sqrt(squares / (points.weights @ exact**2)))


def _airy(quick: bool) -> Iterator[Finding]:
    for slave in ("on", "against"):
        errors = []
        for cells in _AIRY_CELLS[: 1 if quick else 2]:
            scene, field = _airy_scene(cells)
            errors.append(_pressure_error(with_slave(scene, slave), field))  # type: ignore[arg-type]
        label = f"pressure error, {_AIRY_CELLS[0][0]}:{_AIRY_CELLS[0][1]}, slave '{slave}'"
        yield Finding(label, errors[0], 0, 5e-3, absolute=True)
        if not quick:
            order = float(np.log2(errors[0] / errors[1]))
            yield Finding(f"order, slave '{slave}'", order, 2, 1, absolute=True)


def _rigid_scene(ratio: float | None) -> Scene:
    """A soft block that is bent against a stiff one, or against a rigid plane.

    Args:
        ratio: Of the moduli; None for the plane.
    """
    def bent(x: np.ndarray[Any, Any]) -> Any:
        return 0.004 * (1 + 2 * np.cos(pi * x[0]))

    soft = _MODULI[LOWER]
    prefix = "" if ratio is None else f"{LOWER}."  # groups of a single mesh have none
    supports = [Support(f"{prefix}bottom", {"x": 0, "y": bent})]
    if ratio is not None:
        supports.append(Support("upper.top", {"x": 0, "y": 0}))
    names = (LOWER,) if ratio is None else (LOWER, UPPER)
    return Scene(
        kinematics="plane strain",
        mesh=tuple(block(name, 12 if name == LOWER else 18) for name in names),
        material=tuple(
            Material(soft * (1 if name == LOWER else ratio or 1), 0.3, on=name) for name in names
        ),
        support=tuple(supports),
        contact=(
            Contact(
                f"{prefix}top",
                against=None if ratio is None else "upper.bottom",
                slave="auto" if ratio is None else "on",
                obstacle=Obstacle("plane", position=(0, 0)) if ratio is None else None,
                penalty_parameter=1e-4 / 12 / soft,
            ),
        ),
    )


def _rigid(quick: bool) -> Iterator[Finding]:
    rigid = solved(_rigid_scene(None))
    for ratio, tolerance in ((1e3, 1.2e-3), (1e6, 2e-6)):
        stiff = solved(_rigid_scene(ratio))
        for quantity in ("normal_force", "max_contact_pressure", "contact_area"):
            value, reference = stiff.quantities[quantity], rigid.quantities[quantity]
            yield Finding(f"{quantity}, moduli 1:{ratio:.0e}", value, reference, tolerance)
        difference = _difference(pressures(stiff), pressures(rigid))
        yield Finding(f"pressure, moduli 1:{ratio:.0e}", difference, 0, tolerance, absolute=True)
