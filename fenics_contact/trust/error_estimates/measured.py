"""Quantities of an answer, for what is estimated of them."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import (
    contact_quantities,
    global_quantities,
    preload_records,
    support_records,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.results.quantities import QUANTITIES, QuantityValue, reactions_by_name
from fenics_contact.results.records.contacts import PreloadRecord, SupportRecord
from fenics_contact.scene.quantity_names import OF_PRELOADS, OfPreload, Reaction
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution


class Measured:
    """Quantities of a solution, called in its state.

    Of a contact by its number and the name, of supports by a ``Reaction``.
    """

    def __init__(self, load_steps: LoadSteps) -> None:
        assert load_steps.last is not None
        self._problem = load_steps.problem
        self._answer = load_steps.last.solution
        self._of_answer: dict[Hashable, QuantityValue] = {}

    def __call__(self, solution: Solution) -> dict[Hashable, QuantityValue]:
        """Of a solution; collective."""
        if solution is not self._answer:
            return measured(self._problem, solution)
        if not self._of_answer:
            self._of_answer = measured(self._problem, solution)
        return self._of_answer


def measured(problem: Problem, solution: Solution) -> dict[Hashable, QuantityValue]:
    """Quantities of a solution in whose state a problem is, by ``Measured``'s keys; collective.

    Args:
        problem: The model.
        solution: The solution.
    """
    forces = BulkForces(problem, solution)
    supports = support_records(forces)
    contacts = [contact_quantities(problem, solution, i) for i in range(len(problem.contacts))]
    every = global_quantities(forces, contacts)
    found: dict[Hashable, QuantityValue] = _known(every)
    found.update(problem.points.quantities(solution.displacement))
    for number, of_contact in enumerate(contacts):
        found |= {(number, name): value for name, value in _known(of_contact).items()}
    return found | _reactions(supports) | _preloads(preload_records(problem, solution))


def recorded(
    step: Mapping[str, Any], answer: Mapping[Hashable, QuantityValue]
) -> dict[Hashable, QuantityValue]:
    """Quantities of a load step by the keys of ``Measured``, those that it has."""
    found: dict[Hashable, QuantityValue] = dict(answer) | _reactions(step["supports"])
    found |= _preloads(step.get("preloads", {}))
    for key in answer:
        if isinstance(key, str | tuple):
            of, name = (step["contacts"][key[0]], key[1]) if isinstance(key, tuple) else (step, key)
            recorded = of["quantities"].get(name)
            found[key] = answer[key] if recorded is None else recorded
    return found


def _reactions(supports: list[SupportRecord]) -> dict[Hashable, QuantityValue]:
    """Of each support, and of those of each name together."""
    found: dict[Hashable, QuantityValue] = {
        Reaction(number): row.reaction for number, row in enumerate(supports)
    }
    return found | {Reaction(name): sum_ for name, sum_ in reactions_by_name(supports).items()}


def _preloads(records: Mapping[str, PreloadRecord]) -> dict[Hashable, QuantityValue]:
    """Force and elongation of each."""
    return {
        OfPreload(name, quantity): record[quantity]
        for name, record in records.items()
        for quantity in OF_PRELOADS
    }


def _known(quantities: Mapping[str, Any]) -> dict[Hashable, QuantityValue]:
    """Those that have a true value, and one here: the force along no axis is none."""
    return {name: quantities[name] for name in QUANTITIES if quantities.get(name) is not None}
