"""Places of a contact surface that its points do not see: between them, and off flat facets.

Contact acts at points of a surface, mostly its nodes. What stands opposite may be nearest to the
surface between these: the apex of an obstacle smaller than the cells, or a node of the other body.
Straight facets miss a part of a curved surface besides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import gather_rows, of_every_rank, on_root
from fenics_contact.contact.mortar.facet_mesh import reference_nodes
from fenics_contact.contact.mortar.pairing import gathered
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.contact.surface.trace import Trace

# What cells are to become where an obstacle is not seen, over what they are.
_FINER = 0.25


@dataclass(frozen=True, eq=False)
class BetweenPoints:
    """Where facets of this rank are deepest in what stands opposite.

    Attributes:
        depth: At each place, less what facets of curved surfaces may miss of these (length).
        places: On the undeformed surface, (places, 3) (length).
        facets: Of each place, (places,).
        reference: Where on these, (places, dimension − 1).
        spacing: From one contact point of that facet to the next, about, (places,) (length).
    """

    depth: Array
    places: Array
    facets: AnyIntegers
    reference: Array
    spacing: Array


def nowhere(dimension: int) -> BetweenPoints:
    """No place at all."""
    none = np.zeros(0)
    places, reference = np.zeros((0, 3)), np.zeros((0, dimension - 1))
    return BetweenPoints(none, places, np.zeros(0, dtype=np.int64), reference, none)


class TooCoarseError(InputError):
    """An obstacle stands between the points of a surface: the mesh is too coarse for it.

    Args:
        key: Where the scene describes the obstacle.
        trace: The surface; collective.
        between: Where it lies before this.

    Attributes:
        spaces: Of the body.
        finer: Rows of x, y, z and the size that cells there are to have, of this rank (length).
    """

    def __init__(self, key: str, trace: Trace, between: BetweenPoints) -> None:
        self.spaces: Spaces = trace.spaces
        self.finer = np.column_stack(
            [between.places, _FINER * between.spacing * trace.spaces.degree]
        )
        rows = np.column_stack([-between.depth, between.places, between.spacing])
        rows = gather_rows(trace.spaces.comm, rows[np.lexsort(rows.T[::-1])[:1]])
        nearest = rows[np.lexsort(rows.T[::-1])[0]]
        where = ", ".join(f"{x + 0.0:.4g}" for x in nearest[1 : 1 + trace.spaces.components])
        super().__init__(
            f"{key}: the mesh is too coarse to see it: it stands between the points of the "
            f"surface, near ({where}), which are {nearest[4]:.3g} apart; make cells smaller there, "
            "or ask for an accuracy"
        )


def missed_by_facets(trace: Trace) -> Array:
    """How far a smooth surface is outside of its facets; collective.

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
