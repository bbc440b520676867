"""The tangent of a contact, as entries between the body's displacements."""

from __future__ import annotations

import numpy as np
from dolfinx import fem
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.solve.systems.pair_stiffness import Entries, PairStiffness


class SurfaceMatrix:
    """Assembles K_c of one contact; collective.

    Attributes:
        dofs: The body's global number of every dof of the surface, by its number there.
        pair: The tangent between two bodies, None against an obstacle.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self.contact = contact
        self._surface = contact.trace.surface
        self._assembled: dict[fem.Form, AssembledForm] = {}
        self.dofs = self._surface.dofs
        pairing = contact.kinematics.pairing
        self.pair = None if pairing is None else self._between_bodies(pairing)

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them."""
        none = np.zeros(0, dtype=np.int64)
        found: list[Entries] = [(none, none, np.zeros(0))]
        found += [(part.rows, part.columns, part.values()) for part in self.parts()]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return rows, columns, values

    def _between_bodies(self, pairing: Pairing) -> PairStiffness:
        index_map = self._surface.spaces.displacement_space.dofmap.index_map
        size = self._surface.components
        first, owned = index_map.local_range[0] * size, index_map.size_local * size
        return PairStiffness(pairing, self.dofs, first, owned)

    def pattern(self) -> tuple[Integers, Integers]:
        """Pairs of the body's dofs, on this rank's facets, between which there can be entries."""
        surface = self._surface
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
