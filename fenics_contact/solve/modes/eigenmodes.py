"""The lowest modes of M and K by SciPy's ARPACK, of which rank 0 has the vectors.

Shift and invert about 0: a step of Lanczos' method is a product with M and a solve with K. The
other ranks serve these two until rank 0 is done.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fenics_contact.body.spaces import Spaces, of_owners
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    largest,
    of_every_rank,
    total,
)

# Of eigenvalues: beyond what meshes are worth, and within what round-off allows.
_ACCURATE = 1e-9
# Lanczos vectors beside two a mode: the lowest modes lie far apart, and each vector is a solve.
_MORE = 6
# Of an eigenvalue over the largest: a rigid motion that nothing holds.
_NONE = 1e-10

Nodal = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Mode:
    """A natural mode.

    Attributes:
        circular_frequency: ω (1/time).
        shape: Displacements at the nodes of this rank, (nodes, components); the largest is 1 long.
        forces: M times that (mass).
        mass: Of a unit amplitude of the largest displacement (mass).
    """

    circular_frequency: float
    shape: Array
    forces: Array
    mass: float


class Eigenmodes:
    """Modes of a body; collective, as all its methods.

    Args:
        spaces: Of the body.
        times_mass: M u of nodal displacements, with no rows and columns of what is held.
        solve: K⁻¹ f of nodal forces.
    """

    def __init__(self, spaces: Spaces, times_mass: Nodal, solve: Nodal) -> None:
        self._spaces, self._comm = spaces, spaces.comm
        self._serving: dict[str, Nodal] = {"mass": times_mass, "solve": solve}
        self._ends = np.cumsum(of_every_rank(self._comm, spaces.owned_nodes * spaces.components))

    def lowest(self, number: int, free: int) -> list[Mode]:
        """The modes of the lowest frequencies, in their order.

        Args:
            number: How many.
            free: Number of displacements of all ranks that nothing holds.

        Raises:
            InputError: There are not so many.
            NotConvergedError: ARPACK did not find them, or a rigid motion is free.
        """
        if number > free // 2:
            raise InputError(
                f"modes.number = {number}: a model of {free} free displacements has not so many; "
                f"at most {free // 2}"
            )
        found: tuple[Array, Array] | str | None = None
        if self._comm.rank == 0:
            try:
                found = self._on_root(number)
            except (ArpackNoConvergence, np.linalg.LinAlgError) as error:
                found = " ".join(str(error).split())
            finally:
                from_root(self._comm, "end")
        else:
            while (order := from_root(self._comm, "")) != "end":
                self._serve(order, None)
        found = from_root(self._comm, found)
        if isinstance(found, str) or found is None:
            raise NotConvergedError(f"modes: the eigenvalue solver gave none: {found}")
        values, vectors = found
        if not np.isfinite(values).all() or values.min() <= _NONE * values.max():
            raise NotConvergedError(
                "modes: a rigid motion is held by nothing, so that its frequency is 0; hold it "
                "by a support"
            )
        return [self._mode(*pair) for pair in zip(values, vectors.T, strict=True)]

    def _on_root(self, number: int) -> tuple[Array, Array]:
        """ω² and the shapes, by rank 0 alone."""
        size = int(self._ends[-1])
        operators = {
            name: LinearOperator(
                (size, size), matvec=lambda x, name=name: self._ask(name, x), dtype=np.float64
            )
            for name in self._serving
        }
        start = self._ask("solve", self._ask("mass", np.random.default_rng(0).normal(size=size)))
        values, vectors = eigsh(
            operators["mass"],  # of K only the shape is asked
            k=number,
            M=operators["mass"],
            sigma=0.0,
            OPinv=operators["solve"],
            v0=start,
            ncv=min(size, 2 * number + _MORE),
            tol=_ACCURATE,
        )
        order = np.argsort(values)
        return np.asarray(values[order]), np.asarray(vectors[:, order])

    def _ask(self, order: str, vector: Array) -> Array:
        """All ranks work, as rank 0 wants it."""
        from_root(self._comm, order)
        found = self._serve(order, vector)
        assert found is not None
        return found

    def _serve(self, order: str, vector: Array | None) -> Array | None:
        """A product or a solve, of a vector on rank 0."""
        nodal = self._serving[order](self._at_nodes(vector))
        parts = gathered_on_root(self._comm, nodal[: self._spaces.owned_nodes].reshape(-1))
        return None if parts is None else np.concatenate(parts)

    def _at_nodes(self, vector: Array | None) -> Array:
        """The part of a vector of all ranks that this one has, (nodes, components)."""
        whole = np.asarray(from_root(self._comm, vector)).reshape(-1)
        spaces, rank = self._spaces, self._comm.rank
        count = spaces.owned_nodes * spaces.components
        own = whole[self._ends[rank] - count : self._ends[rank]]
        index_map = spaces.displacement_space.dofmap.index_map
        return of_owners(index_map, own.reshape(-1, spaces.components))

    def _mode(self, value: float, vector: Array) -> Mode:
        """With the largest displacement 1 long, and its largest component > 0."""
        shape = self._at_nodes(vector)
        owned = shape[: self._spaces.owned_nodes]
        shape = shape / largest(self._comm, np.linalg.norm(owned, axis=1))
        most = largest(self._comm, owned.max(initial=0.0).reshape(1))
        least = largest(self._comm, -owned.min(initial=0.0).reshape(1))
        shape = shape if most >= least * (1 - 1e-6) else -shape
        forces = self._serving["mass"](shape)
        work = np.sum(shape * forces, axis=1)[: self._spaces.owned_nodes]
        mass = float(total(self._comm, work.sum()))
        return Mode(float(np.sqrt(value)), shape, forces, mass)
