"""Contact pressure from the reactions: independent of penalty and quadrature.

The function on the contact surface whose nodal forces ∫ p N_i are those that the bulk
needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from fenics_contact.contact import ContactSurface

Array = NDArray[np.float64]


def reaction_pressure(contact: ContactSurface, needed: Array) -> Array:
    """Pressure at all nodes of a contact's surface, (nodes,) (stress); collective.

    Args:
        contact: The contact.
        needed: Forces that the bulk needs from it at its nodes, (nodes, components) (force).
    """
    surface, comm = contact.trace.surface, contact.spaces.comm
    normals = contact.trace.normals[: len(contact.nodes)]
    forces = np.zeros(len(surface.coordinates))
    forces[contact.trace.numbers] = -np.einsum("ij,ij->i", needed, normals)
    function = surface.scalar_function(forces)
    owned = surface.scalar_space.dofmap.index_map.size_local
    # Only contact unknowns are gathered; the one small system is solved on every rank.
    rows, columns, values = (np.concatenate(comm.allgather(part)) for part in _mass(contact))
    entries = np.concatenate(comm.allgather(function.x.array[:owned]))
    matrix = coo_matrix((values, (rows, columns)), shape=(len(entries),) * 2).tocsc()
    found = comm.bcast(spsolve(matrix, entries))
    start = surface.scalar_space.dofmap.index_map.local_range[0]
    function.x.array[:owned] = found[start : start + owned]
    function.x.scatter_forward()
    return surface.scalars(function)


def _mass(contact: ContactSurface) -> tuple[Any, Any, Array]:
    """∫ N_i N_j over the surface: global rows and columns, and values, of owned nodes."""
    surface = contact.trace.surface
    space = surface.scalar_space
    matrix = fem.assemble_matrix(surface.mass)
    matrix.scatter_reverse()
    entries = matrix.to_scipy().tocoo()
    kept = entries.row < space.dofmap.index_map.size_local
    row, column = entries.row[kept].astype(np.int32), entries.col[kept].astype(np.int32)
    # The matrix may have columns of nodes that the space's own map does not know here.
    numbers = matrix.index_map(0).local_to_global(row), matrix.index_map(1).local_to_global(column)
    return *numbers, entries.data[kept]
