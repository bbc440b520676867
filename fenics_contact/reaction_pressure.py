"""Contact pressure from the reactions: independent of penalty and quadrature.

The function on the contact surface whose nodal forces ∫ p N_i are those that the bulk
needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from fenics_contact.contact import ContactSurface
from fenics_contact.problem import Problem
from fenics_contact.solution import Solution

Array = NDArray[np.float64]


def bulk_forces(problem: Problem, solution: Solution, number: int) -> Array:
    """Forces that the bulk needs at a contact's nodes from this contact, (nodes, components).

    K u − f, less what other contacts give to a shared node.
    """
    force = solution.internal_force - problem.load
    for other, (neighbour, given) in enumerate(
        zip(problem.contacts, solution.contact_force, strict=True)
    ):
        if other != number:
            force[neighbour.nodes] -= given
    return force[problem.contacts[number].nodes]


def reaction_pressure(problem: Problem, solution: Solution, number: int) -> Array:
    """Pressure at all nodes of this rank, 0 off the contact, (nodes,) (stress); collective."""
    contact, spaces, comm = problem.contacts[number], problem.spaces, problem.comm
    normals = contact.trace.normals[: len(contact.nodes)]
    forces = np.zeros(len(spaces.coordinates))
    needed = bulk_forces(problem, solution, number)
    forces[contact.nodes] = -np.einsum("ij,ij->i", needed, normals)
    every = np.arange(len(forces), dtype=np.int32)
    function = spaces.nodal_function("reaction_pressure", forces, every)
    index_map = function.function_space.dofmap.index_map
    owned, rows, columns, values = _mass(contact, function)
    entries = function.x.array[owned]
    here = [rows, columns, index_map.local_to_global(owned)]
    # Only contact unknowns are gathered; the one small system is solved on every rank.
    rows, columns, numbers = (np.concatenate(comm.allgather(part)) for part in here)
    values, entries = (np.concatenate(comm.allgather(part)) for part in (values, entries))
    order = np.argsort(numbers)
    rows, columns = (np.searchsorted(numbers[order], part) for part in (rows, columns))
    matrix = coo_matrix((values, (rows, columns)), shape=(len(numbers),) * 2).tocsc()
    found = comm.bcast(spsolve(matrix, entries[order]))
    function.x.array[:] = 0.0
    function.x.array[owned] = found[np.searchsorted(numbers[order], here[2])]
    function.x.scatter_forward()
    return np.array(spaces.nodal_values(function))


def _mass(contact: ContactSurface, function: Any) -> tuple[Any, Any, Any, Array]:
    """∫ N_i N_j over the surface: owned dofs; global rows and columns, and values."""
    space = function.function_space
    measure = contact.spaces.boundary(contact.group)
    trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
    matrix = fem.assemble_matrix(fem.form(contact.spaces.weight * trial * test * measure))
    matrix.scatter_reverse()
    entries = matrix.to_scipy().tocoo()
    kept = (entries.data != 0) & (entries.row < space.dofmap.index_map.size_local)
    row, column = entries.row[kept].astype(np.int32), entries.col[kept].astype(np.int32)
    # The matrix may have columns of nodes that the space's own map does not know here.
    numbers = matrix.index_map(0).local_to_global(row), matrix.index_map(1).local_to_global(column)
    return np.unique(row), *numbers, entries.data[kept]
