"""Kratos: contact of two bodies by mortar integrals and an augmented Lagrangian."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from answers import Answer, cpu_seconds, crossing
from problems import Pair, Problem

NAME = "Kratos"
_VERSION = "10.4.4"
_APPLICATIONS = ("ContactStructuralMechanics", "StructuralMechanics", "LinearSolvers")
# Its files are for Python up to 3.12.
INSTALL = (
    "pip, older Python",
    (
        f"KratosMultiphysics=={_VERSION}",
        *(f"Kratos{name}Application=={_VERSION}" for name in _APPLICATIONS),
    ),
)
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {"pair": {"linear cells": {}}}
ABOUT = (
    "`ALMContactFrictionless`, its mortar method with an augmented Lagrangian, whose penalty and "
    "scale it chooses, by its `alm_contact_process`, on small-displacement quadrilaterals of four "
    "nodes, since its contact is for linear facets alone; `sparse_lu` of its linear solvers. Its "
    "obstacles are bodies, and friction with given pressure it has not, so it solves one of the "
    "problems."
)
_PARTS = ("axis", "held", "top", "contact", "slave")


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """Write the files of a run, and run it in this process."""
    assert isinstance(problem, Pair)
    model = _Model(problem, level)
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "pair.mdpa").write_text(model.text(), "utf-8")
        Path(folder, "materials.json").write_text(json.dumps(_materials(problem)), "utf-8")
        os.chdir(folder)
        try:
            with _silently():
                return _run(problem, model)
        finally:
            os.chdir(here)


def _run(problem: Pair, model: _Model) -> Answer:
    import KratosMultiphysics
    from KratosMultiphysics import (
        ContactStructuralMechanicsApplication,
        LinearSolversApplication,  # noqa: F401
    )
    from KratosMultiphysics.StructuralMechanicsApplication import structural_mechanics_analysis

    parameters = KratosMultiphysics.Parameters(json.dumps(_parameters(problem)))
    everything = KratosMultiphysics.Model()
    analysis = structural_mechanics_analysis.StructuralMechanicsAnalysis(everything, parameters)
    start = cpu_seconds()
    analysis.Initialize()
    analysis.RunSolutionLoop()
    seconds = cpu_seconds() - start
    structure = everything["Structure"]
    scale = structure.ProcessInfo[KratosMultiphysics.SCALE_FACTOR]
    top, slave = (everything[f"Structure.{name}"].Nodes for name in ("top", "slave"))
    force = sum(node.GetSolutionStepValue(KratosMultiphysics.REACTION_Y) for node in top)
    multiplier = ContactStructuralMechanicsApplication.LAGRANGE_MULTIPLIER_CONTACT_PRESSURE
    rows = sorted((node.X0, -scale * node.GetSolutionStepValue(multiplier)) for node in slave)
    places, pressure = (list(column) for column in zip(*rows, strict=True))
    newton = int(structure.ProcessInfo[KratosMultiphysics.NL_ITERATION_NUMBER])
    return Answer(
        version=_VERSION,
        dofs=2 * len(model.nodes),
        solve_seconds=seconds,
        newton=newton,
        factorisations=newton,
        values={
            "force": -2 * float(force),
            "peak pressure": max(pressure),
            "half-width": crossing(places, [p - 1e-3 * max(pressure) for p in pressure]),
        },
    )


class _Model:
    """Nodes, elements and parts of an input file."""

    def __init__(self, problem: Pair, level: int) -> None:
        self.nodes: list[tuple[float, float]] = []
        self.elements: list[list[int]] = []
        self.sides: list[tuple[int, int]] = []
        self.parts: dict[str, list[int]] = {name: [] for name in _PARTS}
        lines = problem.lines(level)
        count = len(lines) - 1
        low = self._grid(count, count, lambda i, j: (lines[i], -lines[count - j]))
        self.bodies = [(len(self.nodes), len(self.elements))]
        along, up = problem.upper_cells(level)
        high = self._grid(along, up, lambda i, j: problem.upper_place(i / along, j / up))
        self.bodies.append((len(self.nodes), len(self.elements)))
        near = sum(place < problem.width * (1 - 1e-9) for place in lines)
        # With the body on their left.
        master = [low[i, count] for i in range(near, -1, -1)]
        slave = [high[i, 0] for i in range(along + 1)]
        self.sides = [*pairwise(master), *pairwise(slave)]
        ends = range(count + 1)
        self.parts["axis"] = [low[0, j] for j in ends] + [high[0, j] for j in range(up + 1)]
        self.parts["held"] = sorted({low[k, 0] for k in ends} | {low[count, k] for k in ends})
        self.parts["top"] = [high[i, up] for i in range(along + 1)]
        self.parts["contact"], self.parts["slave"] = [*master, *slave], slave

    def _grid(self, across: int, up: int, place: Any) -> dict[tuple[int, int], int]:
        numbers: dict[tuple[int, int], int] = {}
        for i, j in product(range(across + 1), range(up + 1)):
            self.nodes.append(place(i, j))
            numbers[i, j] = len(self.nodes)
        for i, j in product(range(across), range(up)):
            ring = ((0, 0), (1, 0), (1, 1), (0, 1))
            self.elements.append([numbers[i + a, j + b] for a, b in ring])
        return numbers

    def text(self) -> str:
        """Of the input file."""
        return "\n".join([*self._blocks(), ""])

    def _blocks(self) -> Iterator[str]:
        for number in (0, 1):
            yield from _block(f"Properties {number}", ())
        places = (f"{n} {x:.15g} {y:.15g} 0" for n, (x, y) in enumerate(self.nodes, 1))
        yield from _block("Nodes", places)
        cells = (f"{n} 1 {' '.join(map(str, cell))}" for n, cell in enumerate(self.elements, 1))
        yield from _block("Elements SmallDisplacementElement2D4N", cells)
        sides = (f"{n} 0 {a} {b}" for n, (a, b) in enumerate(self.sides, 1))
        yield from _block("Conditions LineCondition2D2N", sides)
        first = (0, 0)
        for name, last in zip(("lower", "upper"), self.bodies, strict=True):
            nodes, cells = (range(a + 1, b + 1) for a, b in zip(first, last, strict=True))
            yield from _part(name, nodes, cells, ())
            first = last
        facets = {"contact": range(1, len(self.sides) + 1)}
        facets["slave"] = facets["contact"][-len(self.parts["slave"]) + 1 :]
        for name, chosen in self.parts.items():
            yield from _part(name, chosen, (), facets.get(name, ()))


def _block(head: str, lines: Iterable[object]) -> Iterator[str]:
    yield f"Begin {head}"
    yield from map(str, lines)
    yield f"End {head.split()[0]}"


def _part(
    name: str, nodes: Iterable[int], cells: Iterable[int], facets: Iterable[int]
) -> Iterator[str]:
    kinds = {"Nodes": nodes, "Elements": cells, "Conditions": facets}
    inner = [line for kind, of in kinds.items() for line in _block(f"SubModelPart{kind}", of)]
    yield from _block(f"SubModelPart {name}", inner)


def _materials(problem: Pair) -> dict[str, Any]:
    values = {"DENSITY": 1.0, "YOUNG_MODULUS": problem.youngs_modulus}
    law = {"constitutive_law": {"name": "LinearElasticPlaneStrain2DLaw"}, "Tables": {}}
    law["Variables"] = values | {"POISSON_RATIO": problem.poissons_ratio}
    rows = [
        {"model_part_name": f"Structure.{name}", "properties_id": 1, "Material": law}
        for name in ("lower", "upper")
    ]
    return {"properties": rows}


def _parameters(problem: Pair) -> dict[str, Any]:
    tolerances = {"displacement_relative_tolerance": 1e-8, "displacement_absolute_tolerance": 1e-12}
    tolerances |= {"residual_relative_tolerance": 1e-8, "residual_absolute_tolerance": 1e-10}
    solver = {
        "solver_type": "Static",
        "model_part_name": "Structure",
        "domain_size": 2,
        "echo_level": 0,
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "mdpa", "input_filename": "pair"},
        "material_import_settings": {"materials_filename": "materials.json"},
        "contact_settings": {"mortar_type": "ALMContactFrictionless"},
        "time_stepping": {"time_step": 1.1},
        "reform_dofs_at_each_step": False,
        "convergence_criterion": "contact_residual_criterion",
        **tolerances,
        "max_iteration": 50,
        "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
    }
    contact = {
        "model_part_name": "Structure",
        "contact_model_part": {"0": ["contact"]},
        "assume_master_slave": {"0": ["slave"]},
        "contact_type": "Frictionless",
    }
    held = [
        _held("axis", [True, False, False], [0.0, None, None]),
        _held("held", [True] * 3, [0.0] * 3),
        _held("top", [True] * 3, [0.0, -problem.pushed, 0.0]),
    ]
    return {
        "problem_data": {
            **{"problem_name": "pair", "parallel_type": "OpenMP", "echo_level": 0},
            **{"start_time": 0.0, "end_time": 1.0},
        },
        "solver_settings": solver,
        "processes": {
            "constraints_process_list": held,
            "contact_process_list": [
                {
                    "python_module": "alm_contact_process",
                    "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
                    "process_name": "ALMContactProcess",
                    "Parameters": contact,
                }
            ],
        },
    }


def _held(part: str, which: list[bool], values: list[float | None]) -> dict[str, Any]:
    return {
        "python_module": "assign_vector_variable_process",
        "kratos_module": "KratosMultiphysics",
        "process_name": "AssignVectorVariableProcess",
        "Parameters": {
            "model_part_name": f"Structure.{part}",
            "variable_name": "DISPLACEMENT",
            "interval": [0.0, "End"],
            "constrained": which,
            "value": values,
        },
    }


@contextmanager
def _silently() -> Iterator[None]:
    """What it prints would stand in the way of the answer."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
