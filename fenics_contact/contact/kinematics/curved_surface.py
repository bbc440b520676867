"""Curved surfaces of which facets are straight: what they miss, and where they have an edge."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank, on_root
from fenics_contact.contact.mortar.facet_mesh import reference_nodes
from fenics_contact.contact.mortar.pairing import gathered
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.contact.surface.trace import Trace


def missed_by_facets(trace: Trace) -> Array:
    """How far a smooth surface is outside of its facets; collective.

    Args:
        trace: The contact points.

    Returns:
        At the points, < 0 where it is inside, (points,) (length).
    """
    whole, comm = gathered(trace), trace.spaces.comm
    smooth = SmoothSurface(whole)

    def find() -> tuple[Array, Array]:
        facets = np.arange(0 if trace.nodal else len(whole.nodes))
        middle = reference_nodes(whole.shape, 1).mean(axis=0)
        return smooth.at_nodes(), smooth.offsets(facets, np.tile(middle, (len(facets), 1)))

    at_nodes, at_centres = on_root(comm, find)
    counts = of_every_rank(comm, len(trace.centres))
    first = sum(counts[: comm.rank])
    mine = at_centres[first : first + len(trace.centres)]
    return np.concatenate([at_nodes[trace.surface.numbers][trace.numbers], mine])


def require_smooth(trace: Trace, key: str) -> None:
    """Refuse a surface with a sharp edge, where no normal is its own.

    Args:
        trace: The contact points.
        key: Of the surface, for messages.

    Raises:
        InputError: On every rank.
    """
    corner = trace.averaged.sharp_corner()
    if corner is not None:
        where = ", ".join(f"{x:.4g}" for x in corner[: trace.spaces.components])
        raise InputError(
            f"{key}: the surface has a sharp edge, at ({where}), where no normal is its "
            "own; give each side a contact of its own"
        )
