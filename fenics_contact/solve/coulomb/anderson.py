"""Anderson's acceleration of a fixed-point iteration on arrays spread over the ranks.

D. G. Anderson, J. ACM 12 (1965) 547-560; H. F. Walker and P. Ni, SIAM J. Numer. Anal. 49
(2011) 1715-1735.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total

_MEMORY = 5
# Steps whose residuals depend on each other to this are not used together.
_CUT = 1e-10


class Anderson:
    """Next iterates x from pairs (x, G(x)), arrays of non-negative numbers.

    G has kinks, where points begin to slip: pairs from beyond one mislead. So all earlier
    ones are forgotten whenever the residual grows.

    Args:
        comm: Communicator; ``next`` is collective.
        counted: Which entries of each array this rank counts.
    """

    def __init__(self, comm: MPI.Comm, counted: list[Flags]) -> None:
        self._comm = comm
        self._counted = np.concatenate(counted)
        self._pairs: list[tuple[Array, Array]] = []
        self._size = np.inf

    def next(self, arrays: list[Array], images: list[Array]) -> list[Array]:
        """The combination of the last images whose residual is least."""
        x, image = np.concatenate(arrays), np.concatenate(images)
        mine = (image - x)[self._counted]
        size = float(total(self._comm, mine @ mine))
        kept = self._pairs[-_MEMORY:] if size <= self._size else []
        self._pairs, self._size = [*kept, (image, image - x)], size
        differences = [
            (self._pairs[-1][0] - old, self._pairs[-1][1] - residual)
            for old, residual in self._pairs[:-1]
        ]
        found = image
        if differences:
            residuals = np.array([r for _, r in differences])
            counted = residuals[:, self._counted]
            gram = total(self._comm, counted @ counted.T)
            right = total(self._comm, counted @ mine)
            shares = np.linalg.lstsq(gram, right, rcond=_CUT)[0]
            found = image - shares @ np.array([d for d, _ in differences])
        found = np.maximum(found, 0.0)
        return np.split(found, np.cumsum([len(array) for array in arrays])[:-1])
