"""Displacements on which given loads do their work along the load steps."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.steps import LoadRecord


def load_records(problem: Problem, displacement: Array) -> list[LoadRecord]:
    """Each load of a scene at present; collective.

    Args:
        problem: In the state of the load step.
        displacement: There, at the nodes of this rank, (nodes, components) (length).
    """
    own = slice(problem.spaces.owned_nodes)
    found = []
    for name, nodal, factor in problem.acting_loads:
        size = np.linalg.norm(nodal[own], axis=1).sum()
        work = np.sum(nodal[own] * displacement[own])
        every, done = total(problem.comm, np.array([size, work]))
        found.append(
            LoadRecord(name=name, force=float(factor * every), displacement=float(done / every))
        )
    return found
