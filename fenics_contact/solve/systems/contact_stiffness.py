"""The tangent of a contact, as entries between the body's displacements."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from dolfinx import fem
from scipy.sparse import csr_matrix, hstack, identity

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.point_rule import needs_centres
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
        self._paired: list[Array] | None = None
        self._over_dofs = csr_matrix((0, 0))
        self.dofs = self._surface.dofs

    @cached_property
    def assembled(self) -> AssembledForms | None:
        """The forms of its tangents, which share one pattern; None of a contact without any."""
        forms = (form for term in self.contact.terms for form in term.forms if form.rank == 2)
        first = next(forms, None)
        if first is None:
            return None
        return AssembledForms(first, self._surface, not needs_centres(self._surface.spaces))

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them.

        They are at the same places every time.
        """
        if self.assembled is None:
            none = np.zeros(0, dtype=np.int64)
            return none, none, np.zeros(0)
        forms = [form for term in self.contact.terms for form in term.tangents]
        return self.assembled.rows, self.assembled.columns, self.assembled.values(forms)

    def on_body(self, rows: Integers, columns: Integers, values: Array) -> Entries:
        """Entries between dofs of the surface as those between dofs of the body.

        Against a second body w = u − P u', so K_c gives Jᵀ K_c J with J = (1, −P).
        """
        if self.contact.kinematics.pairing is None:
            return self.dofs[rows], self.dofs[columns], values
        dofs, jump = self._jump
        rows, columns, values = congruent((rows, columns, values), jump, jump)
        return dofs[rows], dofs[columns], values

    @property
    def _jump(self) -> tuple[Integers, csr_matrix]:
        """Dofs of the body, of slave and master; and J over them. Of two bodies."""
        pairing = self.contact.kinematics.pairing
        assert pairing is not None
        if self._paired is not pairing.blocks:  # else as before
            size, count = len(pairing.blocks), len(self.dofs)
            shape = (count, len(pairing.dofs))
            opposite = sum(
                (_of_component(csr_matrix(block), axis, size, shape))
                for axis, block in enumerate(pairing.blocks)
            )
            self._paired = pairing.blocks
            self._over_dofs = csr_matrix(hstack([identity(count), -opposite]))
        return np.concatenate([self.dofs, pairing.dofs]), self._over_dofs

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


def every_pair(dofs: Integers) -> tuple[Integers, Integers]:
    """All pairs of dofs in each row of an array (groups, dofs)."""
    first = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
    return first.ravel(), np.swapaxes(first, 1, 2).ravel()


def congruent(entries: Entries, left: csr_matrix, right: csr_matrix) -> Entries:
    """Entries of Lᵀ K R; each place comes once.

    Args:
        entries: Of K; those at the same place add up.
        left: L.
        right: R.
    """
    rows, columns, values = entries
    kept = values != 0
    places = (rows[kept], columns[kept])
    matrix = csr_matrix((values[kept], places), shape=(left.shape[0], right.shape[0]))
    found = (left.T @ (matrix @ right)).tocoo()
    return found.row.astype(np.int64), found.col.astype(np.int64), found.data


def _of_component(block: csr_matrix, axis: int, size: int, shape: tuple[int, int]) -> csr_matrix:
    """A block between nodes as one between the dofs of a component."""
    entries = block.tocoo()
    places = (entries.row * size + axis, entries.col * size + axis)
    return csr_matrix((entries.data, places), shape=shape)


class AssembledForms:
    """The matrix of forms on a surface, whose pattern is worked out once.

    Attributes:
        rows: Dofs of the surface, of every entry of this rank; an entry may come twice.
        columns: Likewise.

    Args:
        form: Any of the forms.
        surface: The surface.
        at_nodes: Whether their points are the nodes, so that no two of these are coupled.
    """

    def __init__(self, form: fem.Form, surface: SurfaceSpace, at_nodes: bool) -> None:
        self._matrix = fem.create_matrix(form)
        self._matrix.data[:] = np.arange(len(self._matrix.data))
        pattern = self._matrix.to_scipy().tocoo()
        size = surface.components
        own = pattern.row < surface.owned_nodes * size
        if at_nodes:
            own &= pattern.row // size == pattern.col // size
        self._order = pattern.data[own].astype(np.int64)
        self.rows, self.columns = (
            index_map.local_to_global((local[own] // size).astype(np.int32)) * size
            + local[own] % size
            for index_map, local in (
                (self._matrix.index_map(0), pattern.row),
                (self._matrix.index_map(1), pattern.col),
            )
        )

    def values(self, forms: Sequence[fem.Form]) -> Array:
        """Assemble the sum of forms; collective."""
        self._matrix.set_value(0.0)
        for form in forms:
            fem.assemble_matrix(self._matrix, form)
        self._matrix.scatter_reverse()
        return np.asarray(self._matrix.data[self._order])
