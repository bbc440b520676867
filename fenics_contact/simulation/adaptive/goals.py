"""Weights of cells for a quantity: where the errors arise that change it.

An error of a cell moves a quantity J by a_K(e, ψ), where ψ is the adjoint of J. By the same local
problems ψ has an error e* in every cell, and what ψ has beyond it the elements follow, to which e
is orthogonal. So a cell counts by the energy norms of both, ‖e‖_K ‖e*‖_K (R. Becker, R. Rannacher,
An optimal control approach to a posteriori error estimation in finite element methods, Acta
Numerica 10 (2001) 1-102). Of a history, the adjoint is that of its last load step.

Where a quantity has no adjoint its cells count by ‖e‖²_K, as errors in the energy norm do.

Where conduction finds the temperatures, half of what a cell counts goes by the error of temperature
in it, ∫ k |∇e_T|²: wrong temperatures strain the body, and no adjoint says how much.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.scene.values import AXES
from fenics_contact.simulation.sensitivities.adjoints import AnswerAdjoint, adjoint_of
from fenics_contact.simulation.sensitivities.derivatives import (
    QuantityGradient,
    require_adjoint,
)
from fenics_contact.simulation.sensitivities.gradients import gradient_of
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors


@dataclass(frozen=True, eq=False)
class Goals:
    """How much each cell's error counts for each quantity.

    Attributes:
        squared: Cells' errors squared, for what has no adjoint, (cells,); 1 in all.
        weighed: Quantity → what its cells make of its error, likewise.
        by_energy: Quantities without an adjoint → why.
    """

    squared: Array
    weighed: Mapping[str, Array] = field(default_factory=dict)
    by_energy: Mapping[str, str] = field(default_factory=dict)

    def of(self, ratios: Mapping[str, float]) -> Array:
        """Return the errors by which cells are refined, (cells,).

        Args:
            ratios: Quantity → its error over what is allowed.
        """
        found = np.zeros_like(self.squared)
        for name, ratio in ratios.items():
            found += ratio * self.weighed.get(name, self.squared)
        return found if ratios else self.squared


class GoalFinder:
    """Finds the goals of one level after the other.

    Attributes:
        found: Of the last level; None before there is one whose cells have errors.

    Args:
        asked: Quantities by their names.
    """

    def __init__(self, asked: Iterable[str]) -> None:
        self._asked = list(asked)
        self.found: Goals | None = None

    def __call__(self, load_steps: LoadSteps, local: LocalErrors | None) -> None:
        """Find those of the last load step; collective.

        Args:
            load_steps: At their end; all is there again afterwards.
            local: Errors of its cells, where there are any.
        """
        self.found = None
        if local is not None:
            problem = load_steps.problem
            asked = {text: _names_of(problem, text) for text in self._asked}
            self.found = find_goals(load_steps, local, asked)
            load_steps.go_back()


def find_goals(
    load_steps: LoadSteps, local: LocalErrors, asked: Mapping[str, Sequence[str]]
) -> Goals:
    """Return the goals at the last load step; the problem is left in another state; collective.

    Args:
        load_steps: At their end.
        local: Errors of its cells.
        asked: Quantity → names whose adjoints are its own, of a vector its components.
    """
    problem = load_steps.problem
    heat = local.squared_of_heat

    def counted(cells: Array) -> Array:
        shares = _shares(problem, cells)
        if heat is None:
            return shares
        return (shares + _shares(problem, _of_a_section(problem, heat))) / 2

    squared = counted(_of_a_section(problem, local.squared))
    try:
        adjoint = _adjoint(load_steps)
    except InputError as error:
        return Goals(squared, {}, dict.fromkeys(asked, _reason(error)))
    weighed: dict[str, Array] = {}
    why: dict[str, str] = {}
    for quantity, names in asked.items():
        try:
            found = [_squared_adjoint(load_steps, adjoint, local, name) for name in names]
        except (InputError, NotConvergedError) as error:
            why[quantity] = _reason(error)
            continue
        weighed[quantity] = counted(np.sqrt(local.squared * sum(found)))
    return Goals(squared, weighed, why)


def _reason(error: Exception) -> str:
    """Return the reason in a message, without its key and its advice."""
    return str(error).removeprefix("of: ").removeprefix("derivatives: ").partition(";")[0]


def _names_of(problem: Problem, text: str) -> list[str]:
    """The names under which a quantity that is asked for has adjoints.

    Args:
        problem: The model.
        text: Its name; of a vector this stands for all components.
    """
    name = problem.scene.names.find(text)
    if not table.is_vector(name.quantity, problem.spaces.components) or name.axis is not None:
        return [text]
    return [f"{text}_{axis}" for axis in AXES[: problem.spaces.components]]


def _adjoint(load_steps: LoadSteps) -> AnswerAdjoint:
    require_adjoint(load_steps.problem)
    load_steps.go_back()
    return adjoint_of(load_steps)


def _squared_adjoint(
    load_steps: LoadSteps, adjoint: AnswerAdjoint, local: LocalErrors, name: str
) -> Array:
    """a_K(e*, e*) of the adjoint of a quantity, of this rank's own cells; collective.

    A quantity that has the strain energy in it a number of times has the displacement so many times
    in its adjoint: what is left of that is held at supports and contacts, and by the loads.
    """
    problem, step = load_steps.problem, load_steps.last
    assert step is not None
    state = gradient_of(problem, step.solution, name)
    multipliers = QuantityGradient(adjoint, step, state).multipliers
    stiffness, energy = adjoint.condensed.body.stiffness, state.energy
    virtual = multipliers.displacement - energy * step.solution.displacement
    forces = stiffness.forces(multipliers.unknowns) - energy * step.solution.internal_force
    forces.reshape(-1)[problem.constrained] = 0.0
    return local.squared_of(virtual, forces, -energy, multipliers.displacement)


def _shares(problem: Problem, values: Array) -> Array:
    """Return the values of cells over the sum of all cells; collective."""
    whole = float(total(problem.comm, values.sum()))
    return np.asarray(values / whole) if whole > 0 else values


def _of_a_section(problem: Problem, squared: Array) -> Array:
    """Return errors per circumference in axisymmetric bodies, so that cells at the axis count.

    A peak pressure often stands there, and over the whole circle they would count for nothing.
    """
    if problem.spaces.kinematics != "axisymmetric":
        return squared
    mesh = problem.body.mesh
    nodes = compat.geometry_nodes(mesh)[: len(squared)]
    return np.asarray(squared / (2 * np.pi * mesh.geometry.x[nodes][:, :, 0].mean(axis=1)))
