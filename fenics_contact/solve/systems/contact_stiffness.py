"""The tangent of a contact, as entries between displacements of its body or two bodies.

The tangent of a contact between two bodies, as entries between displacements of both. With the
jump w = u − P u' it is Jᵀ K_c J, J = (1, −P): full between all displacements of both surfaces. It
is made some rows at a time, by J and its transpose applied; each rank makes its own rows, so that
what it holds beside them grows with the surfaces only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.law import ContactForce
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.mortar.projection import Projection, parts_of
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.contact.surface.point_rule import needs_centres
from fenics_contact.contact.surface.space import SurfaceSpace


class NeighbourStiffness:
    """Entries between dofs of the surface; the same places every time.

    Attributes:
        rows: Dofs of the surface of every entry of this rank; an entry may come several times.
        columns: Likewise.

    Args:
        force: Whose points are coupled.
        neighbours: How.
    """

    def __init__(self, force: ContactForce, neighbours: SurfaceAverage) -> None:
        self._force, trace = force, force.site.trace
        size = trace.surface.components
        self._pairs: Integers = np.flatnonzero(trace.owned[neighbours.rows])
        points = neighbours.rows[self._pairs]
        nodes, shares = neighbours.nodes_of_places
        own, other = neighbours.places[points], neighbours.columns[self._pairs]
        factors = shares[own][:, :, None] * shares[other][:, None, :]
        # A point between nodes moves with all of its facet's; its force is theirs.
        self._pair, first, second = np.nonzero(factors)
        self._factor = factors[self._pair, first, second] * trace.weights[points[self._pair]]
        shape = (len(self._pair), size, size)
        rows = nodes[own[self._pair], first][:, None] * size + np.arange(size)
        columns = nodes[other[self._pair], second][:, None] * size + np.arange(size)
        self.rows: Integers = np.broadcast_to(rows[:, :, None], shape).ravel()
        self.columns: Integers = np.broadcast_to(columns[:, None, :], shape).ravel()

    def values(self) -> Array:
        """Present values of the entries; collective."""
        blocks = self._force.tangent_between_points()[self._pairs]
        return np.asarray((blocks[self._pair] * self._factor[:, None, None]).ravel())


Entries = tuple[Integers, Integers, Array]
_ROWS = 64  # made at a time


class PairStiffness:
    """Jᵀ K_c J of a slave surface and its master.

    Attributes:
        dofs: The body's global numbers of all displacements of the slave, then of the master.
        own: Numbers in ``dofs`` of those that this rank owns, by components.

    Args:
        pairing: The two.
        slave_dofs: The first part of ``dofs``.
        first: The body's global number of the first displacement that this rank owns.
        owned: How many it owns.
    """

    def __init__(self, pairing: Pairing, slave_dofs: Integers, first: int, owned: int) -> None:
        self._pairing, self._slaves = pairing, len(slave_dofs)
        self.dofs = np.concatenate([slave_dofs, pairing.dofs])
        own = np.flatnonzero((self.dofs >= first) & (self.dofs < first + owned))
        self._size = pairing.master.components
        # Those of one component together: P u' of the others is 0.
        self.own = own[np.argsort(own % self._size, kind="stable")]

    def own_rows(self) -> Iterator[Integers]:
        """The body's numbers of this rank's rows, some at a time."""
        return (self.dofs[self.own[part]] for part in parts_of(len(self.own), _ROWS))

    def rows(self, comm: MPI.Comm, entries: Entries) -> Iterator[tuple[Integers, Array]]:
        """This rank's rows of Jᵀ K_c J, some at a time; collective.

        Args:
            comm: Communicator.
            entries: Rows, columns (dofs of the slave) and values of K_c, of this rank.

        Returns:
            The body's numbers of rows, and these, (rows, dofs).
        """
        transposed = csr_matrix(self._on_slave(comm, entries).T)
        return self._made(transposed, self._pairing.whole_projection())

    def _on_slave(self, comm: MPI.Comm, entries: Entries) -> csr_matrix:
        """K_c of the whole slave, (slave dofs, slave dofs), on every rank; collective.

        Args:
            comm: Communicator.
            entries: Rows, columns (dofs of the slave) and values, of this rank.
        """
        rows, columns, values = (
            np.concatenate(parts) for parts in zip(*of_every_rank(comm, entries), strict=True)
        )
        shape = (self._slaves, self._slaves)
        return csr_matrix((values, (rows, columns)), shape=shape)

    def _made(
        self, transposed: csr_matrix, projection: Projection
    ) -> Iterator[tuple[Integers, Array]]:
        """Entries of the transposed tangent, from K_cᵀ and P."""
        for part in parts_of(len(self.own), _ROWS):
            chosen = self.own[part]
            unit = np.zeros((len(self.dofs), len(chosen)))
            unit[chosen, np.arange(len(chosen))] = 1.0
            pulled = transposed @ self._jump(projection, unit)
            acts = pulled.any(axis=0)  # no open point does
            if acts.any():
                yield self.dofs[chosen[acts]], self._forces(projection, pulled[:, acts]).T

    def _jump(self, projection: Projection, displacement: Array) -> Array:
        """J u, (slave dofs, columns), of displacements (dofs, columns)."""
        opposite = displacement[self._slaves :]
        nodal = opposite.reshape(-1, self._size, opposite.shape[1])
        moved = projection.apply(nodal)
        return displacement[: self._slaves] - moved.reshape(self._slaves, -1)

    def _forces(self, projection: Projection, given: Array) -> Array:
        """Jᵀ f, (dofs, columns), of forces (slave dofs, columns)."""
        nodal = given.reshape(-1, self._size, given.shape[1])
        taken = projection.transposed(nodal)
        return np.concatenate([given, -taken.reshape(-1, given.shape[1])])


class SurfaceMatrix:
    """Assembles K_c of one contact; collective.

    Attributes:
        dofs: The body's global number of every dof of the surface, by its number there.
    """

    def __init__(self, contact: ContactSurface) -> None:
        self.contact = contact
        self._surface = contact.trace.surface
        self.dofs = self._surface.dofs

    @cached_property
    def pair(self) -> PairStiffness | None:
        """The tangent between two bodies written out, None against an obstacle; collective."""
        pairing = self.contact.kinematics.pairing
        return None if pairing is None else self._between_bodies(pairing)

    @cached_property
    def assembled(self) -> AssembledForms | None:
        """The forms of its tangents, which share one pattern; None of a contact without any."""
        forms = (
            form for term in self.contact.forces.terms for form in term.forms if form.rank == 2
        )
        first = next(forms, None)
        if first is None:
            return None
        return AssembledForms(first, self._surface, not needs_centres(self._surface.spaces))

    @cached_property
    def between_points(self) -> list[NeighbourStiffness]:
        """Tangents of laws whose forces at a point follow the jump at others; collective."""
        terms = self.contact.forces.terms
        found = [(term, term.neighbours) for term in terms]
        return [NeighbourStiffness(term, by) for term, by in found if by is not None]

    @property
    def places(self) -> tuple[Integers, Integers]:
        """Rows and columns of ``entries``, where laws go by their forms; collective."""
        none = np.zeros(0, dtype=np.int64)
        own = self.assembled
        rows, columns = (none, none) if own is None else (own.rows, own.columns)
        return self._with_neighbours(rows, columns)

    def _with_neighbours(self, rows: Integers, columns: Integers) -> tuple[Integers, Integers]:
        return (
            np.concatenate([rows, *(one.rows for one in self.between_points)]),
            np.concatenate([columns, *(one.columns for one in self.between_points)]),
        )

    def entries(self) -> Entries:
        """Rows, columns (dofs of the surface) and values; every rank has some of them.

        They are at the same places every time; collective.
        """
        rows, columns, values = self._entries_at_points()
        if self.between_points:
            rows, columns = self._with_neighbours(rows, columns)
            values = np.concatenate([values, *(one.values() for one in self.between_points)])
        return rows, columns, values

    def _entries_at_points(self) -> Entries:
        """Entries of the tangent that each point has by itself."""
        forces = self.contact.forces
        if forces.by_points:
            trace = self.contact.trace
            blocks = sum(forces.weight_of(t) * t.tangent_at_points() for t in forces.terms)
            weighted = trace.weights[:, None, None] * np.asarray(blocks)
            rows, columns = self._point_dofs
            return rows, columns, weighted[trace.owned].ravel()
        if self.assembled is None:
            none = np.zeros(0, dtype=np.int64)
            return none, none, np.zeros(0)
        rows, columns = self.assembled.rows, self.assembled.columns
        if forces.friction_weight == 1.0:
            every = [form for term in forces.terms for form in term.tangents]
            return rows, columns, self.assembled.values(every)
        parts = [(forces.weight_of(term), term.tangents) for term in forces.terms]
        values = [weight * self.assembled.values(forms) for weight, forms in parts]
        return rows, columns, np.sum(values, axis=0)

    @cached_property
    def _point_dofs(self) -> tuple[Integers, Integers]:
        """Dofs of the surface at rows and columns of the blocks of this rank's points."""
        trace, size = self.contact.trace, self._surface.components
        nodes = self._surface.numbers[trace.numbers[trace.owned]].astype(np.int64)
        dofs = nodes[:, None] * size + np.arange(size)
        shape = (len(nodes), size, size)
        rows = np.broadcast_to(dofs[:, :, None], shape).ravel()
        return rows, np.broadcast_to(dofs[:, None, :], shape).ravel()

    def _between_bodies(self, pairing: Pairing) -> PairStiffness:
        index_map = self._surface.spaces.displacement_space.dofmap.index_map
        size = self._surface.components
        first, owned = index_map.local_range[0] * size, index_map.size_local * size
        return PairStiffness(pairing, self.dofs, first, owned)


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
