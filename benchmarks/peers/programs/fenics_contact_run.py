"""fenics_contact: a scene through ``run``, as a user writes it, with and without error bars."""

from __future__ import annotations

import dataclasses
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

from answers import Answer
from problems import Indentation, Problem, Slab

NAME = "fenics_contact"
INSTALL: tuple[str, tuple[str, ...]] = ("here", ())
_BARS = {"all of it (default)": {"errors": "auto"}, "no error bars": {"errors": "none"}}
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "indentation": _BARS,
    "friction": _BARS,
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

    scene_of, values_of = _KINDS[type(problem)]
    result = run(scene_of(problem, level, setting["errors"]))
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


_KINDS: dict[type, tuple[Any, Any]] = {
    Indentation: (_indentation, _of_indentation),
    Slab: (_slab, _of_slab),
}
