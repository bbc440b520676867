"""Contact pressure as a function on the surface: from the points, and from the reactions.

That from the reactions is independent of penalty and quadrature: the function whose nodal forces
∫ p N_i are those that the bulk needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_root
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.space import SurfaceSpace


def pressure_of_facets(contact: ContactSurface, state: ContactState) -> Array:
    """Pressure at the points as a function of the facets' space, (points,) (stress); collective.

    Quadratic triangles have more points than nodes: a part of the pressures that penalties make
    there gives no force at any node, and depends on where kinks between facets and the edge of
    contact happen to lie. The nearest function of the facets' space has the same forces without
    that part; it may be a little below 0 beside the edge. Where all points are nodes, and where the
    stiffness is that of a foundation, the pressure is that of the points.

    Args:
        contact: The contact.
        state: What happens at its points.
    """
    if contact.trace.nodal or not contact.has_penalty:
        return state.contact_pressure
    every = np.ones(len(contact.trace.weights), dtype=bool)
    return contact.trace.fitted(state.contact_pressure, every)


def pressure_of_facets_transposed(contact: ContactSurface, values: Array) -> Array:
    """Values times the transposed matrix of ``pressure_of_facets``, (points,); collective.

    It is a projection in the least squares of the points' weights.

    Args:
        contact: The contact.
        values: At the points, 0 but where this rank counts them, (points,).
    """
    trace = contact.trace
    if trace.nodal or not contact.has_penalty:
        return values
    shared, count = values / trace.weights, len(trace.nodes)
    shared[:count] = trace.surface.of_owners(trace.at_all_nodes(shared[:count]))[trace.numbers]
    every = np.ones(len(values), dtype=bool)
    return np.where(trace.owned, trace.weights * trace.fitted(shared, every), 0.0)


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
