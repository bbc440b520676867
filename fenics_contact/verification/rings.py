"""Concentric rings, or quarters of them, with meshes of their own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from fenics_contact import Body
from fenics_contact.verification.boxes import COMM, Box, boxes


def quarter_rings(
    parts: Sequence[Box], comm: MPI.Comm = COMM, order: int = 2, cell: str = ""
) -> Body:
    """Quarters of rings around z.

    Args:
        parts: Along the radius, along the angle from 0 to 1 (a right angle), and in 3D along z;
            of ``shaft``, say, ``shaft.x1`` is the outer side, ``shaft.y0`` and ``shaft.y1`` lie in
            the planes y = 0 and x = 0.
        comm: Of the mesh.
        order: Of the cells' geometry.
        cell: Their kind; quadrilaterals or hexahedra by default.
    """
    cell = cell or ("quadrilateral" if len(parts[0].cells) == 2 else "hexahedron")
    body = boxes(parts, cell, comm, order)
    places = body.mesh.geometry.x
    radii, angles = places[:, 0].copy(), 0.5 * np.pi * places[:, 1]
    places[:, 0], places[:, 1] = radii * np.cos(angles), radii * np.sin(angles)
    return body
