"""Nodal forces that the bulk needs, each worked out once for a solution."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.recovered_pressure import reaction_pressure
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton.solution import Solution


class BulkForces:
    """What the bulk needs in a solution, against what loads and contacts give; collective, as all.

    Attributes:
        problem: The model.
        solution: Its solution.
        contacts: Forces of all contacts on the body, (nodes, components) (force).
        unbalanced: What it needs less loads and contacts: reactions where supports hold (force).
    """

    def __init__(self, problem: Problem, solution: Solution) -> None:
        self.problem, self.solution = problem, solution
        self._given = solution.contact_force
        self.contacts = np.zeros_like(problem.load)
        for contact, force in zip(problem.contacts, self._given, strict=True):
            self.contacts += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
        self.unbalanced = solution.internal_force - problem.load - self.contacts
        self._pressures: dict[int, Array] = {}

    def at_contact(self, number: int) -> Array:
        """Forces that the bulk needs from a contact at its nodes, (nodes, components) (force).

        K u − f, less what other contacts give to a shared node.
        """
        return self.unbalanced[self.problem.contacts[number].nodes] + self._given[number]

    def pressure(self, number: int) -> Array:
        """``reaction_pressure`` of a contact, at all nodes of its surface (stress)."""
        if number not in self._pressures:
            forces = self.at_contact(number)
            self._pressures[number] = reaction_pressure(self.problem.contacts[number], forces)
        return self._pressures[number]

    @cached_property
    def imbalance(self) -> float:
        """What may be out of balance: the imbalance accepted, or what round-off leaves (force).

        Inside the body the condensed solver measures none. What is left there counts as far as
        round-off of K u may make it, so that a state out of balance is none.
        """
        problem, solution = self.problem, self.solution
        inside = self.unbalanced.copy().reshape(-1)
        inside[problem.constrained] = 0.0
        owned = problem.spaces.owned_nodes * problem.spaces.components
        left = float(total(problem.comm, np.abs(inside[:owned]).sum()))
        return max(solution.imbalance_limit, min(left, solution.bulk_round_off))

    @cached_property
    def strain_energy(self) -> float:
        """½ a(u, u); in preloaded parts of the strain beyond the one free of stress (energy)."""
        owned = slice(0, self.problem.spaces.owned_nodes)
        solution = self.solution
        product = np.sum(solution.displacement[owned] * solution.internal_force[owned])
        tightened = sum(state.force * state.shortening for state in solution.preloads)
        return 0.5 * (float(total(self.problem.comm, product)) + tightened)
