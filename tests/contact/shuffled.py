"""A wrong projection between two bodies, for tests of what notices it."""

import dataclasses

import numpy as np

from fenics_contact.contact.mortar.projection import Projection


class Shuffled:
    """A projection whose columns are shuffled: resultants balance, moments do not.

    Args:
        pairing: Whose projection it is.
    """

    def __init__(self, pairing) -> None:
        self._pairing = pairing
        self._straight, self._comm = pairing.projection, pairing.master.comm
        count = pairing.master.space.dofmap.index_map.size_global
        self._order = np.random.default_rng(7).permutation(count)
        self._mine = pairing.master.numbers[: pairing.master.owned_nodes]

    def take_over(self):
        """Be the projection of the pairing."""
        present = dataclasses.replace(self._pairing._present, projection=self)
        present.__dict__["whole"] = self.whole(self._pairing.whole_projection())
        self._pairing._present = present

    def apply(self, values):
        return self._straight.apply(self._whole(values)[self._order][self._mine])

    def transposed(self, forces):
        whole = self._whole(self._straight.transposed(forces))
        found = np.empty_like(whole)
        found[self._order] = whole
        return found[self._mine]

    def whole(self, projection):
        """The same of the projection of the whole surfaces."""
        parts = []
        for part in projection.components:
            rows, back = np.arange(part.shape[0]), np.argsort(self._order)
            parts.append(part.restricted(rows, back))
        return Projection(parts)

    def _whole(self, own):
        return np.concatenate(self._comm.allgather(own))
