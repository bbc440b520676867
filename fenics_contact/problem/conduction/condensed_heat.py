"""Conduction condensed onto the surfaces at which contacts conduct.

What contacts conduct changes with their pressures, and nothing else does. So the bodies' matrix is
factorised once, and condensed onto the nodes of these surfaces: other conductances take a dense
matrix of these nodes, and one solve inside the bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.factors.local_factor import LocalFactor
from fenics_contact.problem.conduction.heat_of_bodies import HeatOfBodies
from fenics_contact.problem.conduction.heat_of_contact import PairedHeat
from fenics_contact.problem.loads.disturbance import Disturbance

# Of the largest entry of the bodies' matrix: what conducts less is round-off.
_NOTHING = 1e-13


class CondensedHeat:
    """Temperatures of all nodes by what contacts conduct; on one rank.

    Args:
        bodies: Conduction in these.
        surfaces: Nodes at which contacts may conduct, over all ranks.
        parts: Connected part of the bodies of each node of all ranks.

    Raises:
        FenicsContactError: MUMPS could not factorise the matrix.
    """

    def __init__(self, bodies: HeatOfBodies, surfaces: Integers, parts: Integers) -> None:
        self._bodies, self._parts = bodies, parts
        self._given, _ = bodies.given_at(0.0)
        free = ~bodies.follows
        free[self._given] = False
        self._free = np.flatnonzero(free)
        self._following = bodies.following
        self._folded = csr_matrix(self._following.T @ bodies.matrix @ self._following)
        self._at_contacts = np.unique(surfaces)
        ahead = self._following[self._at_contacts]
        self._surfaces = np.unique(ahead.indices).astype(np.int64)
        self._ahead = csr_matrix(ahead[:, self._surfaces])
        self._moves = free[self._surfaces]  # the others have a given temperature
        self._at_surfaces = np.searchsorted(self._free, self._surfaces[self._moves])
        self._matrix = csr_matrix(self._folded[self._free][:, self._free])
        self._has_datum = self._parts_with_datum()
        self._least = _NOTHING * abs(bodies.matrix).max()
        self._load: tuple[tuple[float, Disturbance | None], Array, Array] | None = None

    def solve(self, time: float, paired: Sequence[PairedHeat], weighted: Sequence[Array]) -> Array:
        """Rise of all nodes (temperature).

        Args:
            time: Pseudo-time.
            paired: Of each contact.
            weighted: Conductance times area at its points of all ranks (power/temperature).

        Raises:
            InputError: Nothing says which temperature a body has.
        """
        conducted = self._conducted(paired, weighted)
        self._require_datum(paired, conducted)
        load, condensed = self._load_at(time)
        rise = np.zeros(self._bodies.count)
        given, held = self._bodies.given_at(time)
        rise[given] = held
        return self._solved(rise, load, condensed, self._of_contacts(paired, conducted))

    def solve_for(
        self, heat: Array, paired: Sequence[PairedHeat], weighted: Sequence[Array]
    ) -> Array:
        """Rise of all nodes by heat alone, none where a temperature is given (temperature).

        Args:
            heat: That flows into all nodes (power).
            paired: As of ``solve``.
            weighted: Likewise.
        """
        load = (self._following.T @ heat)[self._free]
        whole = self._of_contacts(paired, self._conducted(paired, weighted))
        rise = np.zeros(self._bodies.count)
        return self._solved(rise, load, self._at_free_surfaces(load), whole)

    def _conducted(
        self, paired: Sequence[PairedHeat], weighted: Sequence[Array]
    ) -> list[csr_matrix]:
        """Matrix of each contact's conductance between its slave's nodes (power/temperature)."""
        return [
            csr_matrix(pair.points.T.multiply(weights) @ pair.points)
            for pair, weights in zip(paired, weighted, strict=True)
        ]

    def _solved(self, rise: Array, load: Array, condensed: Array, whole: Array) -> Array:
        """Rise of all nodes (temperature).

        Args:
            rise: Of nodes where it is given, 0 elsewhere (temperature).
            load: Heat that flows into the free nodes (power).
            condensed: The same, condensed onto the surfaces (power).
            whole: As ``_of_contacts`` gives it.
        """
        moves, factored = self._moves, self._factored
        right = condensed - whole[moves][:, ~moves] @ rise[self._surfaces[~moves]]
        found = np.zeros(len(self._free))
        try:
            factor = cho_factor(factored.schur + whole[moves][:, moves])
        except LinAlgError:
            raise _no_datum() from None
        found[self._at_surfaces] = cho_solve(factor, right)
        inside = factored.solve(load - self._matrix @ found)
        rise[self._free] = found + inside
        return np.asarray(self._following @ rise)

    @cached_property
    def _factored(self) -> LocalFactor:
        """The bodies' matrix, factorised and condensed onto the surfaces."""
        size = len(self._free)
        found = LocalFactor(
            self._matrix, self._at_surfaces, mumps.fastest(self._bodies.is_plane, size)
        )
        if found.error is not None:
            raise found.error
        return found

    def _load_at(self, time: float) -> tuple[Array, Array]:
        """Heat that flows into the free nodes, and the same condensed onto the surfaces (power)."""
        bodies = self._bodies
        if self._load is None or self._load[0] != (time, bodies.disturbance):
            rise = np.zeros(bodies.count)
            given, held = bodies.given_at(time)
            rise[given] = held
            taken_in = self._following.T @ bodies.taken_in(time)
            load = (taken_in - self._folded @ rise)[self._free]
            self._load = (time, bodies.disturbance), load, self._at_free_surfaces(load)
        return self._load[1:]

    def _at_free_surfaces(self, load: Array) -> Array:
        """Heat into the free nodes, condensed onto the surfaces (power)."""
        left = load - self._matrix @ self._factored.solve(load)
        return np.asarray(left[self._at_surfaces])

    def _of_contacts(self, paired: Sequence[PairedHeat], conducted: Sequence[csr_matrix]) -> Array:
        """Dense matrix of contacts' conductances between surface nodes (power/temperature)."""
        nodes = self._at_contacts
        found = np.zeros((len(nodes), len(nodes)))
        for pair, own in zip(paired, conducted, strict=True):
            slave, master = (np.searchsorted(nodes, n) for n in (pair.slave, pair.master))
            across = own @ pair.opposites
            found[np.ix_(slave, slave)] += own.toarray()
            found[np.ix_(slave, master)] -= across
            found[np.ix_(master, slave)] -= across.T
            found[np.ix_(master, master)] += pair.opposites.T @ across
        if not self._bodies.follows.any():
            return found
        return np.asarray(self._ahead.T @ (self._ahead.T @ found.T).T)

    def _parts_with_datum(self) -> Flags:
        """Whether each part has a given temperature, or a film: one that a uniform rise feeds."""
        matrix, count = self._bodies.matrix, int(self._parts.max(initial=0)) + 1
        out = np.bincount(self._parts, matrix.sum(axis=1).A1, count)
        sizes = np.bincount(self._parts, abs(matrix).sum(axis=1).A1, count)
        found = out > _NOTHING * sizes
        found[self._parts[self._given]] = True
        return np.asarray(found)

    def _require_datum(self, paired: Sequence[PairedHeat], conducted: Sequence[csr_matrix]) -> None:
        """Whether every part has a datum of its own, or heat from one that has.

        Raises:
            InputError: One has not.
        """
        count, least = len(self._has_datum), self._least
        cut = self._following[self._bodies.follows].tocoo()
        rows = [self._parts[self._bodies.follows][cut.row]]
        columns = [self._parts[cut.col]]
        for pair, own in zip(paired, conducted, strict=True):
            met = csr_matrix(pair.coupling)[own.diagonal() > least].tocoo()
            rows.append(self._parts[pair.slave[own.diagonal() > least][met.row]])
            columns.append(self._parts[pair.master[met.col]])
        places = np.concatenate(rows), np.concatenate(columns)
        links = csr_matrix((np.ones(len(places[0])), places), shape=(count, count))
        _, chain = connected_components(links, directed=False)
        if not np.isin(chain, chain[self._has_datum]).all():
            raise _no_datum()


def _no_datum() -> InputError:
    return InputError(
        "heat: nothing says which temperature a body has; give it one, a film, or a "
        "contact that conducts also where nothing presses"
    )
