"""The tangent of a contact, as entries between the body's displacements."""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.contact import ContactSurface

Array = NDArray[np.float64]
Entries = tuple[NDArray[np.int64], NDArray[np.int64], Array]


class SurfaceMatrix:
    """Assembles K_c of one contact; collective.

    Attributes:
        dofs: The body's global number of every dof of the surface, by its number there.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self.contact = contact
        self._surface = contact.trace.surface
        spaces = contact.spaces
        mine = self._surface.body_nodes[: self._surface.owned_nodes]
        numbers = spaces.displacement_space.dofmap.index_map.local_to_global(mine)
        nodes = np.concatenate(spaces.comm.allgather(numbers)).astype(np.int64)
        components = spaces.components
        self.dofs = (nodes[:, None] * components + np.arange(components)).ravel()

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them."""
        surface = self._surface
        size = surface.components
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        for form in [form for term in self.contact.terms for form in term.tangents]:
            matrix = fem.assemble_matrix(form)
            matrix.scatter_reverse()
            part = matrix.to_scipy().tocoo()
            kept = part.row < surface.owned_nodes * size
            rows, columns = (
                index_map.local_to_global((local[kept] // size).astype(np.int32)) * size
                + local[kept] % size
                for index_map, local in ((matrix.index_map(0), part.row),
                                         (matrix.index_map(1), part.col))
            )  # fmt: skip
            found.append((rows, columns, part.data[kept]))
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return rows, columns, values
