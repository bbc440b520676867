"""The tangent of a contact, as entries between the body's displacements."""

from __future__ import annotations

from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.contact import ContactSurface
from fenics_contact.surface_space import SurfaceSpace

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
        self._assembled: dict[Any, AssembledForm] = {}
        spaces = contact.spaces
        mine = self._surface.body_nodes[: self._surface.owned_nodes]
        numbers = spaces.displacement_space.dofmap.index_map.local_to_global(mine)
        nodes = np.concatenate(spaces.comm.allgather(numbers)).astype(np.int64)
        components = spaces.components
        self.dofs = (nodes[:, None] * components + np.arange(components)).ravel()

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them."""
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        found += [(part.rows, part.columns, part.values()) for part in self.parts()]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return rows, columns, values

    def parts(self) -> list[AssembledForm]:
        """The forms that the contact's terms have at present; collective."""
        forms = [form for term in self.contact.terms for form in term.tangents]
        for form in forms:
            if form not in self._assembled:
                self._assembled[form] = AssembledForm(form, self._surface)
        return [self._assembled[form] for form in forms]


class AssembledForm:
    """A form's matrix, whose pattern is worked out once.

    Attributes:
        rows: Dofs of the surface, of every entry of this rank; an entry may come twice.
        columns: Likewise.
    """

    def __init__(self, form: Any, surface: SurfaceSpace) -> None:
        self._form = form
        self._matrix = fem.create_matrix(form)
        self._matrix.data[:] = np.arange(len(self._matrix.data))
        pattern = self._matrix.to_scipy().tocoo()
        size = surface.components
        own = pattern.row < surface.owned_nodes * size
        self._order = pattern.data[own].astype(np.int64)
        self.rows, self.columns = (
            index_map.local_to_global((local[own] // size).astype(np.int32)) * size
            + local[own] % size
            for index_map, local in (
                (self._matrix.index_map(0), pattern.row),
                (self._matrix.index_map(1), pattern.col),
            )
        )

    def values(self) -> Array:
        """Assemble; collective."""
        self._matrix.set_value(0.0)
        fem.assemble_matrix(self._matrix, self._form)
        self._matrix.scatter_reverse()
        return np.asarray(self._matrix.data[self._order])
