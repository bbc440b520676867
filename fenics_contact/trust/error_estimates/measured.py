"""Quantities of an answer, for what is estimated of them, and how much too stiff its mesh is.

Errors of what cycles lose, where a source of errors is looked at in one load step alone: what that
does to the friction work, it does at each turn of a cycle, or in each of its load steps.

A thin body shears where its elements cannot bend: it is much too stiff under given forces, and its
local errors are as large as the solution. Forces that stand for these move it by the share s of
what it has moved, a(δ, u) / a(u, u), which is only the first step to the answer of the space with
the bubbles. Along the solution's own shape each further step is that share of the one before, so
that all of them make 1/(1 - s) of the first one, as Ritz's method with that shape says.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.condensed_forces import CondensedForces
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.couplings import coupling_motions
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import global_quantities, scalar_records, support_records
from fenics_contact.evaluate.temperatures import ModelTemperatures
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.results.quantities import (
    quantities_of_scalars,
    reactions_by_name,
    scalars_of_step,
)
from fenics_contact.results.records.contacts import SupportRecord
from fenics_contact.scene.core_scene import LoadCycles
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.quantity_names import LossOfCycle, OfScalar, Reaction
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution

# Rows of a body at the most: with more it takes less to find what is inside it in each answer.
_MOST_ROWS = 24


class Measured:
    """Quantities of a solution, called in its state.

    Of a contact by its number and the name, of supports by a ``Reaction``. With temperatures where
    conduction finds them; those that the scene gives have no error. Without what is inside
    a body that is condensed, where that is found for nobody else and few numbers are asked of it.
    """

    def __init__(self, load_steps: LoadSteps) -> None:
        assert load_steps.last is not None
        self._problem, self._system = load_steps.problem, load_steps.newton.system
        self._answer = load_steps.last.solution
        self._of_answer: dict[Hashable, QuantityValue] = {}
        is_found = self._problem.conduction is not None
        self._temperatures = ModelTemperatures(self._problem) if is_found else None

    def __call__(self, solution: Solution) -> dict[Hashable, QuantityValue]:
        """Return the quantities of a solution; collective."""
        if solution is not self._answer:
            return self._measured(solution)
        if not self._of_answer:
            self._of_answer = self._measured(solution)
        return self._of_answer

    def _measured(self, solution: Solution) -> dict[Hashable, QuantityValue]:
        found = measured(self._problem, solution, self._forces(solution))
        if self._temperatures is not None:
            found.update(self._temperatures.quantities())
        return found

    def _forces(self, solution: Solution) -> InternalForces:
        """Return the forces that the bulk needs in the present state; collective."""
        problem, system = self._problem, self._system
        follows = problem.elastic.mixed is not None or problem.body_scalars or problem.feet
        if follows or not isinstance(system, CondensedSystem) or _rows(problem) > _MOST_ROWS:
            return BulkForces(problem, solution)
        scalars = system.scalar_values(system.state)
        moved = system.contact_displacements()
        return CondensedForces(problem, solution, system.body, moved, scalars)


def _rows(problem: Problem) -> int:
    """How many numbers are asked of the inside of a body, at the most."""
    spaces = problem.spaces
    supported = len(problem.applied_supports) * spaces.parts.count
    turning = len(problem.support_moments.centres) * (1 if spaces.components == 2 else 3)
    return spaces.components * (supported + len(problem.points.places)) + turning


def measured(
    problem: Problem, solution: Solution, forces: InternalForces | None = None
) -> dict[Hashable, QuantityValue]:
    """Quantities of a solution in whose state a problem is, by ``Measured``'s keys; collective.

    Args:
        problem: The model.
        solution: The solution.
        forces: What the bulk needs in it; by default by what is inside.
    """
    forces = forces or BulkForces(problem, solution)
    supports = support_records(forces)
    contacts = [contact_quantities(problem, solution, i) for i in range(len(problem.contacts))]
    every = global_quantities(forces, contacts)
    found: dict[Hashable, QuantityValue] = known_quantities(every)
    found.update(forces.at_points())
    for number, of_contact in enumerate(contacts):
        found |= {(number, name): value for name, value in known_quantities(of_contact).items()}
    found |= _losses_of_cycles(problem, solution)
    found |= quantities_of_scalars(scalar_records(problem, solution))
    motions = coupling_motions(problem, solution.scalars)
    for coupling, motion in zip(problem.scene.coupling, motions, strict=True):
        found |= {OfScalar(coupling.label, name): value for name, value in motion.items() if value}
    return found | reactions(supports)


def recorded(
    step: Mapping[str, Any], answer: Mapping[Hashable, QuantityValue]
) -> dict[Hashable, QuantityValue]:
    """Quantities of a load step by the keys of ``Measured``, those that it has."""
    found: dict[Hashable, QuantityValue] = dict(answer) | reactions(step["supports"])
    found |= quantities_of_scalars(scalars_of_step(step))
    for key in answer:
        if isinstance(key, str | tuple):
            of, name = (step["contacts"][key[0]], key[1]) if isinstance(key, tuple) else (step, key)
            recorded = of["quantities"].get(name)
            found[key] = answer[key] if recorded is None else recorded
    return found


def _losses_of_cycles(problem: Problem, solution: Solution) -> dict[Hashable, QuantityValue]:
    """Return the losses of each cycle up to now, at each contact and in all; collective."""
    cycles = cycles_of(problem.scene)
    if cycles is None:
        return {}
    found: dict[Hashable, QuantityValue] = {}
    every: dict[int, float] = {}
    pairs = zip(problem.contacts, solution.states, strict=True)
    for number, (contact, state) in enumerate(pairs):
        begins = [0.0] if cycles.begin == 0 else []
        works = [*begins, *contact.last_step.dissipated_before, contact.work.of_friction(state)]
        for cycle, loss in enumerate(np.diff(works), start=1):
            found[LossOfCycle(cycle, number)] = float(loss)
            every[cycle] = every.get(cycle, 0.0) + float(loss)
    return found | {LossOfCycle(cycle): loss for cycle, loss in every.items()}


def reactions(supports: list[SupportRecord]) -> dict[Hashable, QuantityValue]:
    """Return the quantities of each support, and of all supports of each name."""
    every: list[tuple[int | str, Mapping[str, QuantityValue]]] = [
        *((number, row.quantities) for number, row in enumerate(supports)),
        *reactions_by_name(supports).items(),
    ]
    return {Reaction(of, name): value for of, found in every for name, value in found.items()}


def known_quantities(quantities: Mapping[str, Any]) -> dict[Hashable, QuantityValue]:
    """Return the quantities that have a true value, and a value here."""
    return {
        name: quantities[name]
        for name in table.with_true_value()
        if quantities.get(name) is not None
    }


# The work to which a turn adds has such an error at the begin of the cycle and at its end.
_ENDS = 2.0
# Points that stick at one turn are loaded to and fro, each time from the other turn.
_SWINGS = 4.0

Errors = Mapping[Hashable, float]


class OfCycles:
    """Errors of the loss of a cycle, from errors of the friction work in load steps.

    Args:
        cycles: Of the scene, if any.
        times: Pseudo-times of all load steps.
    """

    def __init__(self, cycles: LoadCycles | None, times: Sequence[float]) -> None:
        period = 0.0 if cycles is None else cycles.repetition.period
        self._steps = sum(time > times[-1] - period * (1 - 1e-9) for time in times)

    def of_ends(self, errors: Errors) -> dict[Hashable, float]:
        """Where edges, or peaks, are at the end of a load step."""
        return _with_losses(errors, _ENDS)

    def of_steps(self, errors: Errors) -> dict[Hashable, float]:
        """Where each load step adds its own."""
        return _with_losses(errors, float(self._steps))

    def of_swings(self, errors: Errors, losses: Sequence[LossOfCycle]) -> dict[Hashable, float]:
        """Where all that touches sticks.

        Args:
            errors: Of some quantities.
            losses: All that are asked for.
        """
        found = dict(errors)
        for loss in losses:
            found[loss] = _SWINGS * errors.get(loss.friction_work, 0.0)
        return found


def _with_losses(errors: Errors, factor: float) -> dict[Hashable, float]:
    found = dict(errors)
    for key in errors:
        if isinstance(key, LossOfCycle):
            found[key] = factor * errors[key.friction_work]
    return found


def without_losses(errors: Errors) -> dict[Hashable, float]:
    """Without those of cycles: a load step alone tells nothing of them."""
    return {key: error for key, error in errors.items() if not isinstance(key, LossOfCycle)}


TOO_STIFF = (
    "What the mesh changes has no error bar: the mesh makes more of the stiffness than the bodies, "
    "as where thin parts bend in few cells of degree 1. Take degree 2, or more cells across what "
    "is thin."
)
# The mesh then makes half of the stiffness: what is estimated by small errors does not hold.
_MOST = 0.5
# Of the largest product of forces and displacements at a node: energy of a body that only moves.
_NONE = 1e-9


# Of its size: what the first step changes a quantity by that statics alone decide.
_DECIDED = 1e-6


class HeldBack:
    """Share of a solution's energy due to its mesh, by forces that represent local errors.

    Args:
        problem: The model.
        solution: Its solution.
        before: Displacement that these forces change, (nodes, components) (length).
        part: Of these forces, what is looked at.

    Attributes:
        share: Of the stiffness, along the solution's own shape, what the mesh makes.
    """

    def __init__(
        self, problem: Problem, solution: Solution, before: Array, part: float = 1.0
    ) -> None:
        self._comm, self._before, self._part = problem.comm, before, part
        self._owned = slice(0, problem.spaces.owned_nodes)
        self._force = solution.internal_force[self._owned]
        products = self._force * solution.displacement[self._owned]
        energy, sizes = total(self._comm, np.array([products.sum(), np.abs(products).sum()]))
        self._energy = energy if energy > _NONE * sizes else np.inf
        self.share = 0.0

    def look(self, changed: Solution) -> None:
        """Find the share from the solution under these forces as well; collective."""
        moved = (changed.displacement - self._before)[self._owned]
        done = total(self._comm, float(np.sum(self._force * moved)))
        self.share = done / (self._part * self._energy)

    @property
    def is_too_stiff(self) -> bool:
        """Whether the mesh makes more of the stiffness than the body."""
        return self.share > _MOST

    def hides(self, change: float, value: QuantityValue) -> bool:
        """Whether it is too stiff to tell the error of a quantity.

        Args:
            change: What local errors change it by.
            value: It itself.
        """
        return self.is_too_stiff and change > _DECIDED * float(np.linalg.norm(value))

    @property
    def all_steps(self) -> float:
        """Sum of all steps to the answer over the first one.

        Of a mesh that is too stiff no more is said than of one that nearly is.
        """
        return 1 / (1 - min(max(self.share, 0.0), _MOST))
