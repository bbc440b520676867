"""Some displacement dofs of a body, whose values every rank knows."""

from __future__ import annotations

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import total


class GatheredDofs:
    """Dofs by their numbers over all ranks, and where they are on this one.

    Attributes:
        numbers: Over all ranks, the same on each, (dofs,).
        here: Which of them this rank knows, as owner or as ghost.
        local: Of these, the local indices into the flat displacement array.

    Args:
        numbers: The attribute.
        spaces: Those of the body.
    """

    def __init__(self, numbers: Integers, spaces: Spaces) -> None:
        self._comm, self.numbers = spaces.comm, numbers
        index_map, size = spaces.displacement_space.dofmap.index_map, spaces.components
        nodes = np.arange(len(spaces.coordinates), dtype=np.int32)
        every = np.asarray(index_map.local_to_global(nodes), dtype=np.int64)
        every = (every[:, None] * size + np.arange(size)).ravel()
        order = np.argsort(every)
        places = np.minimum(np.searchsorted(every[order], numbers), max(len(every) - 1, 0))
        found = order[places] if len(every) else np.zeros(len(numbers), dtype=np.int64)
        self.here = np.flatnonzero(every[found] == numbers) if len(every) else found[:0]
        self.local: Integers = found[self.here]
        self._own = self.local < spaces.owned_nodes * size

    def gathered(self, flat: Array) -> Array:
        """Values at the dofs, (dofs, …), on every rank; collective.

        Args:
            flat: At the displacement dofs of this rank, (dofs of the rank, …).
        """
        found = np.zeros((len(self.numbers), *flat.shape[1:]))
        found[self.here[self._own]] = flat[self.local[self._own]]
        return np.asarray(total(self._comm, found))

    def place(self, values: Array, flat: Array) -> None:
        """Write values at the dofs into an array of this rank's displacement dofs, in place."""
        flat[self.local] = values[self.here]
