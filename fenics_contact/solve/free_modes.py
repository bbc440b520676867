"""Modes of bodies that no contact touches, by solves with the static factorisation.

Rigid motions are among them. Where nothing holds a body, springs at as few contact dofs as it has
rigid motions do. What is in balance with itself does not feel them; and what they push is just
these motions.

An eigenvalue solver runs on rank 0 alone; the other ranks serve its products with M and its solves
with K until it is done.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fenics_contact.body.spaces import Spaces, of_owners
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import from_root, gathered_on_root, of_every_rank, total
from fenics_contact.problem.massless import ContactMasses, FreeModes
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem

Nodal = Callable[[Array], Array]
Vectors = Mapping[str, Callable[[Array], Array]]
Found = TypeVar("Found")


class ServedOperators:
    """Operators on nodal values, asked for on rank 0; collective, as all its methods.

    Attributes:
        size: Number of displacements of all ranks.

    Args:
        spaces: Of the body.
        operators: Each by its name, of nodal values (nodes, components).
    """

    def __init__(self, spaces: Spaces, operators: Mapping[str, Nodal]) -> None:
        self._spaces, self._comm, self._operators = spaces, spaces.comm, operators
        self._ends = np.cumsum(of_every_rank(self._comm, spaces.owned_nodes * spaces.components))
        self.size = int(self._ends[-1])

    def run(self, find: Callable[[Vectors], Found], key: str) -> Found:
        """Run a function on rank 0, with operators of all ranks; its result is on every rank.

        Args:
            find: Is given the operators, of vectors of all ranks; called on rank 0.
            key: Of the scene, for messages.

        Raises:
            NotConvergedError: The eigenvalue solver found nothing.
        """
        found: Found | None = None
        error = "nothing"
        if self._comm.rank == 0:
            try:
                names = self._operators
                found = find({name: partial(self._ask, name) for name in names})
            except (ArpackNoConvergence, np.linalg.LinAlgError) as caught:
                error = " ".join(str(caught).split())
            finally:
                from_root(self._comm, "end")
        else:
            while (order := from_root(self._comm, "")) != "end":
                self._serve(order, None)
        found, error = from_root(self._comm, (found, error))
        if found is None:
            raise NotConvergedError(f"{key}: the eigenvalue solver gave none: {error}")
        return found

    def _ask(self, order: str, vector: Array) -> Array:
        """All ranks work, as rank 0 wants it."""
        from_root(self._comm, order)
        found = self._serve(order, vector)
        assert found is not None
        return found

    def _serve(self, order: str, vector: Array | None) -> Array | None:
        """A product or a solve, of a vector on rank 0."""
        nodal = self._operators[order](self.at_nodes(vector))
        parts = gathered_on_root(self._comm, nodal[: self._spaces.owned_nodes].reshape(-1))
        return None if parts is None else np.concatenate(parts)

    def at_nodes(self, vector: Array | None) -> Array:
        """The part of a vector of all ranks that this one has, (nodes, components).

        Args:
            vector: On rank 0, on others None.
        """
        whole = np.asarray(from_root(self._comm, vector)).reshape(-1)
        spaces, rank = self._spaces, self._comm.rank
        count = spaces.owned_nodes * spaces.components
        own = whole[self._ends[rank] - count : self._ends[rank]]
        index_map = spaces.displacement_space.dofmap.index_map
        return of_owners(index_map, own.reshape(-1, spaces.components))


class LinearisedBody:
    """A body by the tangents that its contacts have; collective, as all its methods.

    Args:
        system: In the state.
        body: Its body.
    """

    def __init__(self, system: CondensedSystem, body: CondensedBody) -> None:
        self._system, self._body = system, body
        system.linearise(system.state)

    def solve(self, nodal: Array) -> Array:
        """Change of the displacement by small forces.

        Args:
            nodal: At the nodes of this rank, (nodes, components) (force).

        Returns:
            Likewise (length); 0 where supports hold.
        """
        system, body = self._system, self._body
        load = body.stiffness.load(nodal, np.zeros_like(nodal), body.held)
        condensed = body.bulk.condense(load)
        problem = system.problem
        on_scalars = body.scalars.from_loads(load, np.zeros_like(load))
        on_scalars = on_scalars - problem.on_moved(nodal)
        at_contacts, scalars = system.change(condensed, on_scalars)
        for value, one in zip(scalars, body.scalars.loads, strict=True):
            load += value * one
        found = body.stiffness.at_nodes(body.bulk.expand(load, at_contacts))
        moved = problem.moved_by_scalars(scalars)
        return found if moved is None else found + moved


# Of eigenvalues: nearly round-off, as what modes leave is told from them by that.
_ACCURATE = 1e-12
# Lanczos vectors beside two a mode, and the share of all displacements that may be modes.
_MORE, _MOST = 6, 0.25


class PinnedBody:
    """A body that is held by its supports, and by as few springs as it needs; collective.

    Attributes:
        compliance: Of the contact dofs, on rank 0, else none of them (length/force).

    Args:
        body: Condensed, of K as in statics.
    """

    def __init__(self, body: CondensedBody) -> None:
        self._body = body
        of_schur = body.of_schur
        springs = np.zeros(0)
        self.compliance = np.zeros((0, 0))
        if of_schur is not None:
            self.compliance, springs = of_schur.compliance
        self._springs: Array = from_root(body.bulk.comm, springs)

    def solve(self, load: Array) -> Array:
        """Displacements, at this rank's unknowns of the stiffness (length).

        Args:
            load: As of ``CondensedBulk.condense``; or several at once, (…, unknowns).
        """
        bulk = self._body.bulk
        condensed = bulk.condense(load)
        at_contacts = condensed
        if bulk.comm.rank == 0:
            at_contacts = np.asarray(condensed @ self.compliance)  # which is symmetric
        return bulk.expand(load, at_contacts)

    def rigid_motions(self) -> Array:
        """Rigid motions that nothing holds, at this rank's unknowns, (motions, unknowns)."""
        pins = np.flatnonzero(self._springs)
        at_contacts = np.zeros((len(pins), 0))
        if self._body.bulk.comm.rank == 0:
            at_contacts = self.compliance[pins] * self._springs[pins, None]
        none = np.zeros((len(pins), len(self._body.stiffness.numbers)))
        return self._body.bulk.expand(none, at_contacts) if len(pins) else none


class _Lowest:
    """Modes by M^½ K⁻¹ M^½, whose largest eigenvalues are 1/ω²; collective, as all its methods.

    What has no mass is nothing to it. As M K⁻¹ M beside M it would grow in Lanczos' method, as M
    does not see it.

    Args:
        body: Condensed, of K as in statics.
        masses: Of its nodes.
        held: What supports hold, (nodes, components).
    """

    def __init__(self, body: CondensedBody, masses: ContactMasses, held: Flags) -> None:
        self._body, self._masses, self._free = body, masses, ~held
        self._spaces = body.discrete.spaces
        self._pinned = PinnedBody(body)
        values, ways = np.linalg.eigh(masses.blocks)
        scaled = ways * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        self._roots = np.einsum("nik,njk->nij", scaled, ways)
        self.rigid = self._rigid_motions()
        self._moved = self.forces(self.rigid)

    def forces(self, shapes: Array) -> Array:
        """M times shapes at the nodes, (shapes, nodes, components); 0 where supports hold."""
        rows = [self._masses.times(row * self._free) * self._free for row in shapes]
        return np.array(rows).reshape(shapes.shape)

    def _rigid_motions(self) -> Array:
        """M-orthonormal, (motions, nodes, components)."""
        found = [self._body.stiffness.at_nodes(row) for row in self._pinned.rigid_motions()]
        rigid = np.array(found).reshape(-1, *self._free.shape)
        if not len(rigid):
            return rigid
        inverse = np.linalg.inv(np.linalg.cholesky(self._dots(rigid, self.forces(rigid))))
        return np.asarray(np.tensordot(inverse, rigid, 1))

    def _dots(self, one: Array, other: Array) -> Array:
        own = slice(self._spaces.owned_nodes)
        size = self._free[own].size
        flat, others = (each[:, own].reshape(len(each), size) for each in (one, other))
        return np.asarray(total(self._spaces.comm, flat @ others.T))

    def _solve(self, nodal: Array) -> Array:
        """The part of the answer that is not rigid, of the forces without their rigid part."""
        stiffness = self._body.stiffness
        nodal = nodal - np.tensordot(self._dots(self.rigid, nodal[None])[:, 0], self._moved, 1)
        load = stiffness.load(nodal, np.zeros_like(nodal), self._body.held)
        found = stiffness.at_nodes(self._pinned.solve(load))
        rigid = np.tensordot(self._dots(self._moved, found[None])[:, 0], self.rigid, 1)
        return np.asarray(found - rigid)

    def _rooted(self, nodal: Array) -> Array:
        return np.asarray(np.einsum("nij,nj->ni", self._roots, nodal * self._free) * self._free)

    def elastic(self, number: int) -> tuple[Array, Array]:
        """ω² of the lowest modes, and their shapes (modes, nodes, components)."""
        count = self._dots(self._free[None].astype(float), self._free[None].astype(float)).item()
        if number > count * _MOST:
            raise InputError(
                f"motion.modes.number = {number}: a model of {count:.0f} free displacements has "
                f"not so many that few would do; at most {count * _MOST:.0f}"
            )
        served = ServedOperators(
            self._spaces, {"times": lambda v: self._rooted(self._solve(self._rooted(v)))}
        )

        def find(of: Vectors) -> tuple[Array, Array]:
            size = (served.size, served.size)
            times = LinearOperator(size, matvec=of["times"], dtype=np.float64)
            start = of["times"](np.random.default_rng(0).normal(size=served.size))
            vectors = 2 * number + _MORE
            found = eigsh(times, k=number, which="LA", v0=start, ncv=vectors, tol=_ACCURATE)
            return np.asarray(found[0]), np.asarray(found[1])

        values, vectors = served.run(find, "motion.modes")
        order = np.argsort(-values)
        shapes = [
            self._solve(self._rooted(served.at_nodes(vectors[:, n]))) / values[n] for n in order
        ]
        return 1 / values[order], np.array(shapes)


def free_modes(body: CondensedBody, masses: ContactMasses, held: Flags, number: int) -> FreeModes:
    """Rigid motions, and the lowest other modes; collective.

    Args:
        body: Condensed, of K as in statics.
        masses: Of its nodes.
        held: What supports hold, (nodes, components).
        number: Of modes beside the rigid motions.

    Raises:
        InputError: There are not so many.
        NotConvergedError: They were not found.
    """
    lowest = _Lowest(body, masses, held)
    squares, elastic = lowest.elastic(number)
    shapes = np.concatenate([lowest.rigid, elastic])
    forces = np.moveaxis(lowest.forces(shapes), 0, 2)
    none = np.zeros(len(lowest.rigid))
    return FreeModes(np.moveaxis(shapes, 0, 2), forces, np.concatenate([none, squares]))
