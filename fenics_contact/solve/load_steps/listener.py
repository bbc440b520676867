"""Listeners of load steps while these are taken, such as a history or a state file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.newton.solution import Solution


class StepListener:
    """Listener of accepted load steps; a subclass overrides the events that it needs.

    What happens after the last step follows the call of ``LoadSteps.solve``: the system is still
    there then, and no listener is needed for it.
    """

    def accepted(self, step: AcceptedStep) -> None:
        """A load step is accepted, in whose state the problem still is; collective.

        Args:
            step: The load step. Friction does not yet count its slip from there.
        """

    def completed(self) -> None:
        """The last load step is done with, and the next one's size known; collective.

        Another run can go on from here.
        """


@dataclass(frozen=True, eq=False)
class AtEachStep(StepListener):
    """Calls a function at each load step that is accepted.

    Attributes:
        call: Gets the pseudo-time and the solution; collective.
    """

    call: Callable[[float, Solution], None]

    def accepted(self, step: AcceptedStep) -> None:
        """Call the function; collective."""
        self.call(step.time, step.solution)
