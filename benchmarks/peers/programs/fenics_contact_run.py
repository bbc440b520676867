"""fenics_contact: a scene through ``run``, as a user writes it, with and without error bars."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any
from unittest import mock

from answers import Answer
from problems import Indentation

NAME = "fenics_contact"
INSTALL: tuple[str, tuple[str, ...]] = ("here", ())
_BARS = {"all of it (default)": {"errors": "auto"}, "no error bars": {"errors": "none"}}
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {"indentation": _BARS, "friction": _BARS}
ABOUT = (
    "`run` of a scene. The body is factorised once, by MUMPS, and condensed onto the contact: "
    "Newton's method and load steps work on the contact's unknowns alone. Nothing is chosen by "
    "hand: penalty and regularisation are automatic. By default it checks the physics and "
    "estimates the errors of its results; both are in its seconds of solve, and it is measured "
    "without the bars as well."
)
# Phases of a run that every program has.
_SOLVE = ("assemble", "factorise", "solve", "errors")


def solve(problem: Indentation, level: int, setting: dict[str, Any]) -> Answer:
    """By the public interface."""
    # Its phases are measured in CPU seconds here, as those of the others are.
    clock = SimpleNamespace(perf_counter=time.process_time)
    with mock.patch("fenics_contact.common.timings.time", clock):
        return _solve(problem, level, setting)


def _solve(problem: Indentation, level: int, setting: dict[str, Any]) -> Answer:
    from fenics_contact import __version__, run

    result = run(_indentation(problem, level, setting["errors"]))
    if not result.converged:
        raise RuntimeError(result.verdict)
    found = result.quantities
    values = {
        "force": found["normal_force"],
        "peak pressure": found["max_contact_pressure"],
        "contact radius": found["contact_radius"],
    }
    if problem.friction:
        values["stick radius"] = found["stick_radius"]
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
