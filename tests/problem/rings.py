"""Plates and tubes with a round hole, of straight or curved cells, whole or a part of the turn."""

import numpy as np

from fenics_contact.verification.boxes import Box, boxes


def ring(
    around, inner=10.0, outer=30.0, layers=2, order=2, turn=1.0, cell="", length=None, along=2
):
    """A ring about z: ``ring.y0`` is its hole, ``ring.y1`` its rim.

    Args:
        around: Cells around.
        inner: Radius of the hole (length).
        outer: Radius of the rim (length).
        layers: Cells along the radius.
        order: Of the cells' geometry.
        turn: Share of the whole turn, from the x axis on; ``ring.x0`` and ``ring.x1`` are its ends.
        cell: Kind of the cells, by default quadrilaterals or hexahedra.
        length: Along z, for a tube in space of two cells along it.
    """
    flat = length is None
    start, end, more = ((), (), ()) if flat else ((0.0,), (length,), (2,))
    part = Box(
        "ring", (0.0, inner, *start), (2 * np.pi * turn, outer, *end), (around, layers, *more)
    )
    closed = ("ring",) if turn == 1 else ()
    cell = cell or ("quadrilateral" if flat else "hexahedron")
    body = boxes([part], cell, order=order, closed=closed)
    places = body.mesh.geometry.x
    angle, radius = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0], places[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    return body
