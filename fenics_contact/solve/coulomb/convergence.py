"""Whether the loop on the contact pressure comes nearer, and how fast."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.solve.newton.status_cycling import Chatter

# The loop is left where it has not come nearer in this many passes.
_PATIENCE = 8
# Changes from which the contraction is still taken, over the peak: smaller ones are round-off.
_ROUND_OFF = 1e-11
# Pairs of passes that the contraction is the largest of.
_LATEST = 3


class OuterMonitor:
    """Follows the map from pressures to pressures; all calls are collective.

    Attributes:
        change: Of the pressures in the last pass, over their peak.

    Args:
        chatter: What the contact points do.
        comm: Communicator.
    """

    def __init__(self, chatter: Chatter, comm: MPI.Comm) -> None:
        self._chatter, self._comm = chatter, comm
        self.change = np.inf
        self._best, self._since = np.inf, 0
        self._last: tuple[Array, Array] | None = None
        self._ratios: list[float] = []
        chatter.clear()

    @property
    def contraction(self) -> float | None:
        """Estimate of the map's Lipschitz constant, by secants; None before two passes.

        ‖G(p) − G(p')‖ over ‖p − p'‖, in the largest norm, of successive passes: it does not
        depend on how p is accelerated. The loop by itself needs a value below 1.
        """
        return max(self._ratios[-_LATEST:]) if self._ratios else None

    @property
    def is_stalled(self) -> bool:
        """Whether the pressures have come no nearer for some passes."""
        return self._since >= _PATIENCE

    def see(self, before: list[Array], after: list[Array]) -> float:
        """Take a pass from pressures at the contacts to new ones (stress).

        Returns:
            The change over the peak.
        """
        self._chatter.note()
        x, image = np.concatenate(before), np.concatenate(after)
        peak = largest(self._comm, image)
        self.change = largest(self._comm, np.abs(image - x)) / peak if peak > 0 else 0.0
        if self._last is not None:
            moved = largest(self._comm, np.abs(x - self._last[0]))
            answered = largest(self._comm, np.abs(image - self._last[1]))
            if moved > _ROUND_OFF * peak:
                self._ratios.append(answered / moved)
        self._last = x, image
        if self.change < 0.9 * self._best:
            self._best, self._since = self.change, 0
        else:
            self._since += 1
        return self.change

    def words(self) -> str:
        """How the loop went, for who reads that it failed."""
        words = f"no progress in {_PATIENCE} passes: " if self.is_stalled else ""
        words += f"the pressures still change by {self.change:.1e} of their peak"
        if self.contraction is not None:
            words += f", and a pass multiplies differences by {self.contraction:.2g}"
        return words + self._chatter.words("passes")
