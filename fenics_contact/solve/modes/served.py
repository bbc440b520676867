"""Solves with the kept factorisation for eigenvalues of a body about a state.

Products with M and solves with K for an eigenvalue solver that runs on rank 0 alone. The other
ranks serve these two until rank 0 is done.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence

from fenics_contact.body.spaces import Spaces, of_owners
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import from_root, gathered_on_root, of_every_rank
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
        on_scalars = body.scalars.from_loads(load, np.zeros_like(load))
        at_contacts, scalars = system.change(condensed, on_scalars)
        for value, one in zip(scalars, body.scalars.loads, strict=True):
            load += value * one
        return body.stiffness.at_nodes(body.bulk.expand(load, at_contacts))
