"""State variables of laws at the points, for pictures."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.contact_points import ContactTable, PointArray
from fenics_contact.results.records.contacts import ContactRecord


def shown_arrays(rows: ContactTable, contact: ContactRecord) -> dict[str, PointArray]:
    """Return the arrays that are not zero everywhere, by their names in pictures.

    Args:
        rows: Points of a contact.
        contact: Its entry in ``result.json``.
    """
    arrays = contact.own_arrays
    return {array.words: array for array in arrays if np.nan_to_num(sizes(rows, array)).any()}


def sizes(rows: ContactTable, array: PointArray) -> Array:
    """Return an array's values at the points, or the lengths of its vectors, (points,)."""
    values = rows.vectors(*array.columns)
    return np.linalg.norm(values, axis=1) if array.is_vector else values[:, 0]


def label(array: PointArray) -> str:
    """Return the label of an array's axis or colour bar."""
    return labelled(f"{array.words}, size" if array.is_vector else array.words, array.unit)
