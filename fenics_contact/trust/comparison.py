"""Shared by several checks: the worst of many values, its place, and tolerances of round-off."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.results.result import Check

Place = tuple[float, ...]

# Round-off of traces, beside the imbalance that the solver accepted.
TRACE = 1e-6
# Round-off of sums over a body, beside the imbalance that the solver accepted.
ROUND_OFF = 1e-9
# Newton's method accepts no larger share of the forces since the start, whatever its round-off.
_LARGEST_IMBALANCE = 1e-6


def nearer_to_failing(first: Check | None, second: Check) -> Check:
    """The one that fails, is not a number, or uses more of its limit."""
    if first is None:
        return second
    if first.value != first.value:
        return first
    return first if second.value / second.limit <= first.value / first.limit else second


def worst_of(comm: MPI.Comm, values: Array, places: Array) -> tuple[float, Place]:
    """The largest of values, or one that is not a number, and where it is; collective.

    Of equal ones the same on any number of ranks is named.

    Args:
        comm: Communicator.
        values: On this rank, shape (points,).
        places: Where, shape (points, 3) (length).

    Returns:
        0 and nowhere if no rank has a value.
    """
    peak = largest(comm, values)
    tied = places[np.isnan(values) if np.isnan(peak) else values >= peak - 1e-9 * abs(peak)]
    size = largest(comm, np.abs(tied).ravel()) or 1.0
    rows = gather_rows(comm, _first(tied, size))  # all may be tied: one of each rank is enough
    return peak, tuple(_first(rows, size)[0].tolist()) if len(rows) else ()


def _first(places: Array, size: float) -> Array:
    """The first of places by their coordinates, rounded, (1, 3), or none (length)."""
    return places[np.lexsort(np.round(places / size, 9).T[::-1])[:1]]


def balance(
    left: float, carried: float, imbalance: float, contact: str = "", kind: str = "", part: str = ""
) -> Check:
    """Return the check of forces that must add up to zero: what is left, over their sum.

    Of a body that has been unloaded to nearly nothing, the accepted imbalance is most of what it
    carries: then over the forces that this has been accepted for.

    Args:
        left: The resultant (force).
        carried: Sum of the forces' sizes (force).
        imbalance: That the solver accepted (force).
        contact: As of ``Check``, like the rest.
        kind: Which comparison.
        part: Which part of the body.
    """
    size = max(float(carried), imbalance / _LARGEST_IMBALANCE) or 1.0
    limit = ROUND_OFF + 2 * imbalance / size
    return Check(abs(float(left)) / size, limit, contact, kind=kind, part=part)


def size_of(contact: ContactSurface, area: float) -> float:
    """Length of a piece of a contact surface, but a cell's at least.

    Args:
        contact: It tells what an area is in the model.
        area: Per unit thickness in plane models.
    """
    spaces = contact.spaces
    in_plane = spaces.components == 2 and spaces.kinematics != "axisymmetric"
    return max(area if in_plane else float(np.sqrt(area)), contact.facet_size)
