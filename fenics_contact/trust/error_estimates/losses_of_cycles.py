"""Errors of what cycles lose, where a source of errors is looked at in one load step alone.

What that does to the friction work, it does at each turn of a cycle, or in each of its load steps.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence

from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.quantity_names import LossOfCycle

# The work to which a turn adds has such an error at the begin of the cycle and at its end.
_ENDS = 2.0
# Points that stick at one turn are loaded to and fro, each time from the other turn.
_SWINGS = 4.0

Errors = Mapping[Hashable, float]


class OfCycles:
    """Errors of the loss of a cycle, from errors of the friction work in load steps.

    Args:
        cycles: Of the scene, if any.
        times: Pseudo-times of all load steps.
    """

    def __init__(self, cycles: Cycles | None, times: Sequence[float]) -> None:
        period = 0.0 if cycles is None else cycles.repetition.period
        self._steps = sum(time > times[-1] - period * (1 - 1e-9) for time in times)

    def of_ends(self, errors: Errors) -> dict[Hashable, float]:
        """Where edges, or peaks, are at the end of a load step.

        Args:
            errors: Of all quantities.
        """
        return _with_losses(errors, _ENDS)

    def of_steps(self, errors: Errors) -> dict[Hashable, float]:
        """Where each load step adds its own."""
        return _with_losses(errors, float(self._steps))

    def of_swings(self, errors: Errors, losses: Sequence[LossOfCycle]) -> dict[Hashable, float]:
        """Where all that touches sticks.

        Args:
            errors: Of some quantities.
            losses: All that are asked for.
        """
        found = dict(errors)
        for loss in losses:
            found[loss] = _SWINGS * errors.get(loss.friction_work, 0.0)
        return found


def _with_losses(errors: Errors, factor: float) -> dict[Hashable, float]:
    found = dict(errors)
    for key in errors:
        if isinstance(key, LossOfCycle):
            found[key] = factor * errors[key.friction_work]
    return found


def without_losses(errors: Errors) -> dict[Hashable, float]:
    """Without those of cycles: a load step alone tells nothing of them."""
    return {key: error for key, error in errors.items() if not isinstance(key, LossOfCycle)}
