"""fenics_contact: a scene through ``run``, as a user writes it, with and without error bars."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

from answers import Answer
from problems import Block, HalfSpace, Indentation, Pair, Problem, Slab

NAME = "fenics_contact"
INSTALL: tuple[str, tuple[str, ...]] = ("here", ())
_BARS = {"all of it (default)": {"errors": "auto"}, "no error bars": {"errors": "none"}}
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "indentation": _BARS,
    "friction": _BARS,
    "half-space": _BARS,
    "block": _BARS,
    "rough block": _BARS,
    "pair": _BARS,
    "slab": _BARS,
}
ABOUT = (
    "`run` of a scene. The body is factorised once, by MUMPS, and condensed onto the contact: "
    "Newton's method and load steps work on the contact's unknowns alone. Nothing is chosen by "
    "hand: penalty and regularisation are automatic. By default it checks the physics and "
    "estimates the errors of its results; both are in its seconds of solve, and it is measured "
    "without the bars as well."
)
# Phases of a run that every program has.
_SOLVE = ("assemble", "factorise", "solve", "errors")


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """By the public interface."""
    # Its phases are measured in CPU seconds here, as those of the others are.
    clock = SimpleNamespace(perf_counter=time.process_time)
    with mock.patch("fenics_contact.common.timings.time", clock):
        return _solve(problem, level, setting)


def _solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    from fenics_contact import __version__, run

    scene_of, body_of, values_of = _KINDS[type(problem)]
    scene = scene_of(problem, level, setting["errors"])
    result = run(scene, body=body_of(problem, level))
    if not result.converged:
        raise RuntimeError(result.verdict)
    values = values_of(problem, result.quantities)
    return Answer(
        version=__version__,
        dofs=result.model["dofs"],
        solve_seconds=sum(result.timings[phase] for phase in _SOLVE),
        newton=sum(step["newton_iterations"] for step in result.steps),
        factorisations=1,
        values={name: float(value) for name, value in values.items()},
    )


def _indentation(problem: Indentation, level: int, errors: str) -> Any:
    """The scene; its mesh has the problem's lines."""
    from fenics_contact import (
        Contact,
        Material,
        MeshSource,
        Obstacle,
        Scene,
        SolverSettings,
        Steps,
        Support,
    )
    from fenics_contact.common.program import mesh_file

    parameters = {
        "fine": problem.fine,
        "size": problem.size(level),
        "extent": problem.extent,
        "cells_outside": problem.cells_outside(level),
    }
    mesh = MeshSource(mesh_file("half_space.geo"), cell="quadrilateral", parameters=parameters)
    obstacle = Obstacle("paraboloid", radius=problem.radius, indentation=problem.indentation)
    friction = {"law": "incremental", "friction_coefficient": problem.friction}
    contact = Contact("contact", obstacle=obstacle, **(friction if problem.friction else {}))
    return Scene(
        kinematics="axisymmetric",
        mesh=(mesh,),
        material=(Material(problem.youngs_modulus, problem.poissons_ratio),),
        symmetry=("axis",),
        support=(Support("outer", {"x": 0, "y": 0}),),
        contact=(contact,),
        steps=Steps(problem.steps),
        solver=SolverSettings(errors=errors),
    )


def _of_indentation(problem: Indentation, found: Any) -> dict[str, float]:
    values = {
        "force": found["normal_force"],
        "peak pressure": found["max_contact_pressure"],
        "contact radius": found["contact_radius"],
    }
    return values | ({"stick radius": found["stick_radius"]} if problem.friction else {})


def _half_space(problem: HalfSpace, level: int, errors: str) -> Any:
    """The scene, by symmetry of revolution; beyond 60 follows the rest of the half-space."""
    from fenics_contact import (
        Contact,
        HalfSpace,
        Material,
        MeshSource,
        Obstacle,
        Scene,
        SolverSettings,
    )
    from fenics_contact.common.program import mesh_file

    size = problem.size(level)
    parameters = {"fine": problem.width, "size": size, "extent": 60.0}
    parameters["cells_outside"] = round(2.4 / size)
    mesh = MeshSource(mesh_file("half_space.geo"), cell="quadrilateral", parameters=parameters)
    return Scene(
        kinematics="axisymmetric",
        mesh=(mesh,),
        material=(Material(problem.youngs_modulus, problem.poissons_ratio),),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(
            Contact(
                "contact",
                obstacle=Obstacle("paraboloid", radius=problem.radius, force=problem.force),
            ),
        ),
        solver=SolverSettings(errors=errors),
    )


def _of_half_space(problem: HalfSpace, found: Any) -> dict[str, float]:
    return {
        "peak pressure": found["max_contact_pressure"],
        "contact radius": found["contact_radius"],
    }


def _block(problem: Block, level: int, errors: str) -> Any:
    """The scene, on a mesh of its own."""
    from fenics_contact import (
        Contact,
        Discretisation,
        Material,
        Obstacle,
        Scene,
        SolverSettings,
        Steps,
        Support,
    )

    obstacle = Obstacle("paraboloid", radius=problem.radius, indentation=problem.indentation)
    friction = {"law": "incremental", "friction_coefficient": problem.friction}
    return Scene(
        kinematics="3D",
        material=(Material(problem.youngs_modulus, problem.poissons_ratio),),
        discretisation=Discretisation(2),
        symmetry=("x0", "y0"),
        support=(Support("outer", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("contact", obstacle=obstacle, **(friction if problem.friction else {})),),
        steps=Steps(problem.steps),
        solver=SolverSettings(errors=errors),
    )


def _block_body(problem: Block, level: int) -> Any:
    """Hexahedra between the problem's lines, with named sides."""
    import numpy as np
    from dolfinx import mesh
    from mpi4py import MPI

    from fenics_contact import Body, Group

    lines = np.array(problem.lines(level))
    count, end = len(lines) - 1, problem.extent
    ends = [np.zeros(3), np.full(3, float(count))]
    made = mesh.create_box(MPI.COMM_WORLD, ends, [count] * 3, mesh.CellType.hexahedron)
    places = made.geometry.x
    places[:] = np.interp(places, np.arange(count + 1), lines)
    places[:, 2] = -places[:, 2]
    near = problem.fine * (1 + 1e-9)
    sides = {
        "x0": lambda x: np.isclose(x[0], 0),
        "y0": lambda x: np.isclose(x[1], 0),
        "outer": lambda x: np.isclose(x, end).any(axis=0) | np.isclose(x[2], -end),
        "contact": lambda x: np.isclose(x[2], 0) & (x[0] < near) & (x[1] < near),
    }
    found = [mesh.locate_entities_boundary(made, 2, where) for where in sides.values()]
    facets = np.concatenate(found)
    tags = np.repeat(np.arange(len(sides), dtype=np.int32), [len(side) for side in found])
    order = np.argsort(facets)
    cells = np.arange(made.topology.index_map(3).size_local, dtype=np.int32)
    return Body(
        made,
        mesh.meshtags(made, 3, cells, np.zeros_like(cells)),
        mesh.meshtags(made, 2, facets[order], tags[order]),
        {name: Group(2, (tag,)) for tag, name in enumerate(sides)},
    )


def _of_block(problem: Block, found: Any) -> dict[str, float]:
    """Of all four quarters."""
    return {"force": 4 * found["normal_force"], "peak pressure": found["max_contact_pressure"]}


def _pair(problem: Pair, level: int, errors: str) -> Any:
    """The scene of two bodies."""
    from fenics_contact import Contact, Discretisation, Material, Scene, SolverSettings, Support

    return Scene(
        kinematics="plane strain",
        material=(Material(problem.youngs_modulus, problem.poissons_ratio),),
        discretisation=Discretisation(2),
        symmetry=("lower.x0", "upper.x0"),
        support=(
            Support("lower.x1", {"x": 0, "y": 0}),
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"x": 0, "y": -problem.pushed}),
        ),
        contact=(Contact("upper.y0", against="lower.y1"),),
        solver=SolverSettings(errors=errors),
    )


def _pair_body(problem: Pair, level: int) -> Any:
    """Both meshes, made between numbers of cells and moved to where they lie."""
    import numpy as np

    from fenics_contact.verification.boxes import Box, boxes

    lines, (along, up) = np.array(problem.lines(level)), problem.upper_cells(level)
    count = len(lines) - 1
    lower = Box("lower", (0.0, -float(count)), (float(count), 0.0), (count, count))
    upper = Box("upper", (0.0, 1.0), (float(along), 1.0 + up), (along, up))
    body = boxes((lower, upper), "quadrilateral", order=2)
    places = body.mesh.geometry.x
    is_upper = places[:, 1] > 0.5
    x, y = places[is_upper, 0] / along, (places[is_upper, 1] - 1) / up
    places[is_upper, :2] = np.column_stack(problem.upper_place(x, y))
    moved = np.interp(np.abs(places[~is_upper, :2]), np.arange(count + 1), lines)
    places[~is_upper, :2] = moved * [1.0, -1.0]
    return body


def _of_pair(problem: Pair, found: Any) -> dict[str, float]:
    """Of both halves."""
    return {
        "force": 2 * found["normal_force"],
        "peak pressure": found["max_contact_pressure"],
        "half-width": found["contact_area"],
    }


def _slab(problem: Slab, level: int, errors: str) -> Any:
    """The demo with another mesh."""
    from fenics_contact import SolverSettings, load_scene

    scene = load_scene(Path(__file__).parents[3] / "demos" / "slab.toml")
    along, up = problem.lines(level)
    cells = {"cells_along": len(along) - 1, "cells_across": len(up) - 1}
    (mesh,) = scene.mesh
    mesh = dataclasses.replace(mesh, parameters={**mesh.parameters, **cells})
    return dataclasses.replace(scene, mesh=(mesh,), solver=SolverSettings(errors=errors))


def _of_slab(problem: Slab, found: Any) -> dict[str, float]:
    return {
        "friction force": found["friction_force"][0],
        "strain energy": found["strain_energy"],
        "stick length": found["stick_area"],
    }


def _of_the_scene(problem: Problem, level: int) -> None:
    """The mesh is that which the scene names."""


_KINDS: dict[type, tuple[Any, Any, Any]] = {
    Indentation: (_indentation, _of_the_scene, _of_indentation),
    HalfSpace: (_half_space, _of_the_scene, _of_half_space),
    Block: (_block, _block_body, _of_block),
    Pair: (_pair, _pair_body, _of_pair),
    Slab: (_slab, _of_the_scene, _of_slab),
}
