"""Contact pressure from the reactions: independent of penalty and quadrature.

The function on the contact surface whose nodal forces ∫ p N_i are those that the bulk
needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root, gather_rows
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.space import SurfaceSpace


def reaction_pressure(contact: ContactSurface, needed: Array) -> Array:
    """Pressure at all nodes of a contact's surface, (nodes,) (stress); collective.

    Args:
        contact: The contact.
        needed: Forces that the bulk needs from it at its nodes, (nodes, components) (force).
    """
    normals = contact.trace.normals[: len(contact.nodes)]
    forces = np.zeros((len(contact.trace.all_nodes), 1))
    forces[contact.trace.numbers, 0] = -np.einsum("ij,ij->i", needed, normals)
    return traction_of(contact.trace.surface, forces)[:, 0]


def traction_of(surface: SurfaceSpace, forces: Array) -> Array:
    """Tractions t with ∫ t N_i = f_i for nodal forces on a surface, (nodes, columns); collective.

    Args:
        surface: The surface.
        forces: At all of its nodes, (nodes, columns) (force).
    """
    # Only contact unknowns are gathered; the one small system is solved on every rank.
    comm = surface.comm
    rows, columns, values = (gather_rows(comm, part) for part in _mass(surface))
    entries = surface.gathered_scalars(forces)
    matrix = coo_matrix((values, (rows, columns)), shape=(len(entries),) * 2).tocsc()
    found = from_root(comm, spsolve(matrix, entries)).reshape(entries.shape)
    return surface.scattered_scalars(found)


def _mass(surface: SurfaceSpace) -> tuple[Integers, Integers, Array]:
    """∫ N_i N_j over the surface: global rows and columns, and values, of owned nodes."""
    space = surface.scalar_space
    matrix = fem.assemble_matrix(surface.mass)
    matrix.scatter_reverse()
    entries = matrix.to_scipy().tocoo()
    kept = entries.row < space.dofmap.index_map.size_local
    row, column = entries.row[kept].astype(np.int32), entries.col[kept].astype(np.int32)
    # The matrix may have columns of nodes that the space's own map does not know here.
    numbers = matrix.index_map(0).local_to_global(row), matrix.index_map(1).local_to_global(column)
    return *numbers, entries.data[kept]
