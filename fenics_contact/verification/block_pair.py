"""A block on another, on meshes that need not match: scenes that several cases use."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

from fenics_contact.common.arrays import Array
from fenics_contact.common.program import mesh_file
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.scene.values import AxisName, Value
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.case import UntrustedError, note_mesh

LOWER, UPPER = "lower", "upper"
Cell = Literal["triangle", "quadrilateral", "tetrahedron", "hexahedron"]
CELLS: tuple[Cell, ...] = ("quadrilateral", "triangle", "hexahedron", "tetrahedron")
Slave = Literal["on", "against"]
SLAVES: tuple[Slave, ...] = ("on", "against")

PRESSURE = 5.0
_MODULI = {LOWER: 300.0, UPPER: 1000.0}
RATIOS = {LOWER: 0.2, UPPER: 0.3}


def block(name: str, cells: int, triangles: bool = False, **parameters: float) -> MeshSource:
    """A unit square above or below y = 0, or what the parameters of ``block.geo`` make of it."""
    base = 0 if name == UPPER else -1
    sizes = {"base": base, "cells_along": cells, "cells_across": cells}
    return MeshSource(
        mesh_file("block.geo"),
        cell="triangle" if triangles else "quadrilateral",
        name=name,
        parameters=sizes | parameters,
    )


def _brick(name: str, cells: int, hexahedra: bool) -> MeshSource:
    """A unit cube above or below z = 0."""
    base = 0 if name == UPPER else -1
    parameters = {"base": base, "cells_along": cells, "hexahedra": int(hexahedra)}
    return MeshSource(mesh_file("brick.geo"), name=name, parameters=parameters)


def pair_scene(
    cell: Cell, cells: tuple[int, int], pressed: Value = PRESSURE, epsilon: float = 1e-6
) -> Scene:
    """Two blocks that stand on each other, the lower one held and the upper one pressed down.

    Args:
        cell: Type of the cells.
        cells: Along a side of the lower and of the upper block.
        pressed: Pressure on top (stress).
        epsilon: ε₁ over h/E of the finer mesh and the stiffer block.
    """
    in_space = cell in ("hexahedron", "tetrahedron")
    if in_space:
        meshes = [_brick(n, c, cell == "hexahedron") for n, c in zip(_MODULI, cells, strict=True)]
    else:
        meshes = [block(n, c, cell == "triangle") for n, c in zip(_MODULI, cells, strict=True)]
    sides: dict[str, AxisName] = {"left": "x", "front": "y"} if in_space else {"left": "x"}
    held = [Support(f"{n}.{side}", {axis: 0}) for n in _MODULI for side, axis in sides.items()]
    penalty = epsilon / max(cells) / max(_MODULI.values())
    return Scene(
        kinematics="3D" if in_space else "plane strain",
        mesh=tuple(meshes),
        material=tuple(Material(_MODULI[name], RATIOS[name], on=name) for name in _MODULI),
        support=(Support("lower.bottom", {"z" if in_space else "y": 0}), *held),
        load=(Load("upper.top", pressure=pressed),),
        contact=(Contact("upper.bottom", against="lower.top", penalty_parameter=penalty),),
    )


def with_contact(scene: Scene, **changes: Any) -> Scene:
    """The scene with changes of its only contact."""
    contact = dataclasses.replace(scene.contact[0], **changes)
    return dataclasses.replace(scene, contact=(contact,))


def trusted(scene: Scene, body: Body | None = None) -> tuple[Run, Result]:
    """Solve a scene, keeping its fields; collective.

    Raises:
        UntrustedError: It did not converge, or a check failed.
    """
    run = Run(scene, body=body)
    result = run.solve()
    note_mesh(result.model)
    if not result.passed:
        raise UntrustedError(result.verdict)
    return run, result


def pressures(result: Result) -> Array:
    """Contact pressures at all points, (points,) (stress)."""
    assert result.points is not None
    return result.points.contact_pressure
