"""The tangent of a contact, as entries between the body's displacements."""

from __future__ import annotations

import numpy as np
from dolfinx import fem

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.surface.space import SurfaceSpace

Entries = tuple[Integers, Integers, Array]


class SurfaceMatrix:
    """Assembles K_c of one contact; collective.

    Attributes:
        dofs: The body's global number of every dof of the surface, by its number there.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self.contact = contact
        self._surface = contact.trace.surface
        self._assembled: dict[fem.Form, AssembledForm] = {}
        self.dofs = self._surface.dofs

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them."""
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        found += [(part.rows, part.columns, part.values()) for part in self.parts()]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return rows, columns, values

    def on_body(self, rows: Integers, columns: Integers, values: Array) -> Entries:
        """Entries between dofs of the surface as those between dofs of the body.

        Against a second body w = u − P u', so K_c gives Jᵀ K_c J with J = (1, −P).
        """
        pairing = self.contact.kinematics.pairing
        if pairing is None:
            return self.dofs[rows], self.dofs[columns], values
        return coupled_entries(pairing, self.dofs, rows, columns, values)

    def pattern(self) -> tuple[Integers, Integers]:
        """Pairs of the body's dofs between which a tangent can have entries.

        Of this rank's facets; against a second body all pairs of whole surfaces.
        """
        pairing, surface = self.contact.kinematics.pairing, self._surface
        if pairing is not None:
            return every_pair(np.concatenate([self.dofs, pairing.dofs])[None])
        nodes = surface.numbers[surface.facet_nodes]
        places = nodes[..., None] * surface.components + np.arange(surface.components)
        width = nodes.shape[1] * surface.components
        return every_pair(self.dofs[places.reshape(len(nodes), width)])

    def parts(self) -> list[AssembledForm]:
        """The forms that the contact's terms have at present; collective."""
        forms = [form for term in self.contact.terms for form in term.tangents]
        for form in forms:
            if form not in self._assembled:
                self._assembled[form] = AssembledForm(form, self._surface)
        return [self._assembled[form] for form in forms]


def every_pair(dofs: Integers) -> tuple[Integers, Integers]:
    """All pairs of dofs in each row of an array (groups, dofs)."""
    first = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
    return first.ravel(), np.swapaxes(first, 1, 2).ravel()


def coupled_entries(
    pairing: Pairing,
    dofs: Integers,
    rows: Integers,
    columns: Integers,
    values: Array,
) -> Entries:
    """Jᵀ K_c J of entries of K_c, J = (1, −P); only where K_c has entries."""
    kept = values != 0
    rows, columns, values = rows[kept], columns[kept], values[kept]
    size, masters = len(pairing.blocks), pairing.dofs.reshape(-1, len(pairing.blocks))
    found: list[Entries] = [(dofs[rows], dofs[columns], values)]
    for i in range(size):
        for j in range(size):
            mine = (rows % size == i) & (columns % size == j)
            if not mine.any():
                continue
            used, at = np.unique(rows[mine] // size, return_inverse=True)
            others, there = np.unique(columns[mine] // size, return_inverse=True)
            block = np.zeros((len(used), len(others)))
            np.add.at(block, (at, there), values[mine])
            left, right = pairing.blocks[i][used], pairing.blocks[j][others]
            below, across = left.T @ block, block @ right
            own = dofs[used * size + i], dofs[others * size + j]
            opposite = masters[:, i], masters[:, j]
            found.append((*_grid(opposite[0], own[1]), -below.ravel()))
            found.append((*_grid(own[0], opposite[1]), -across.ravel()))
            found.append((*_grid(*opposite), (below @ right).ravel()))
    merged = (np.concatenate(part) for part in zip(*found, strict=True))
    rows, columns, values = merged
    return rows, columns, values


def _grid(rows: Integers, columns: Integers) -> tuple[Integers, Integers]:
    """All pairs of a row and a column, row by row."""
    return np.repeat(rows, len(columns)), np.tile(columns, len(rows))


class AssembledForm:
    """A form's matrix, whose pattern is worked out once.

    Attributes:
        rows: Dofs of the surface, of every entry of this rank; an entry may come twice.
        columns: Likewise.
    """

    def __init__(self, form: fem.Form, surface: SurfaceSpace) -> None:
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
