"""Contact pressure from the reactions: independent of penalty and quadrature.

The function on the contact surface whose nodal forces ∫ p N_i are those that the bulk
needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_root
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
    entries = surface.gathered_scalars(forces)
    # The same on all ranks, though their round-off may not be.
    found = from_root(surface.comm, surface.mass_factor.solve(entries))
    return surface.scattered_scalars(found)
