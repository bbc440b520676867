"""The inertia of a problem: none of bodies at rest, a step of motion of those that move.

A problem asks its inertia the same of both: what load is in balance, what an imbalance is small
against, and what there is when the load steps begin.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.inertia.states import FirstState, StepStiffness


class Inertia(ABC):
    """Masses of a problem, or none.

    Attributes:
        moves: Whether bodies move, so that masses take what loads and contacts leave.
        size: Length of a step (time); None of bodies at rest.
        stiffness: The matrix of a step; None where it is K.
        first: What there is at time 0.
        most_open: Share of the energy brought in that steps may leave open at the most.
    """

    moves: bool
    size: float | None
    stiffness: StepStiffness | None
    first: FirstState
    most_open: float

    @property
    @abstractmethod
    def displacement(self) -> Array | float:
        """Where the present step begins, (nodes, components), or 0 of a body at rest (length)."""

    @property
    @abstractmethod
    def motions(self) -> Array:
        """How far what stands opposite has moved when the step begins, (contacts, components)."""

    @property
    @abstractmethod
    def energy(self) -> float:
        """Energy stored at time 0, and kinetic energy when the step begins (energy); collective."""

    @abstractmethod
    def follow_velocities(self) -> None:
        """Let friction count from where no velocity is left at the end of the step; collective."""

    @abstractmethod
    def effective_load(self, load: Array) -> Array:
        """The right-hand side of the balance, but for contacts that press and rub (force).

        Args:
            load: That is given, at the end of a step of motion (force).
        """

    @abstractmethod
    def applied(self, effective: Array, load: Array) -> Array:
        """Sizes of the forces at the nodes that an imbalance is small against (force).

        Args:
            effective: The load of the balance that is solved.
            load: The one that is given.
        """


class AtRest(Inertia):
    """The inertia of bodies that have none: loads, contacts and supports are in balance.

    Args:
        contacts: Those of the problem.
        spaces: Those of the body.
    """

    moves = False
    size = None
    stiffness = None
    most_open = math.inf

    def __init__(self, contacts: Sequence[ContactSurface], spaces: Spaces) -> None:
        count = len(contacts)
        self.first = FirstState(0.0, np.zeros((count, spaces.components)), (0.0,) * count)

    @property
    def displacement(self) -> float:
        """0: load steps begin where the body is undeformed (length)."""
        return 0.0

    @property
    def energy(self) -> float:
        """None (energy)."""
        return 0.0

    @property
    def motions(self) -> Array:
        """None, (contacts, components) (length)."""
        return np.zeros_like(self.first.pressures)

    def follow_velocities(self) -> None:
        """There are none."""

    def effective_load(self, load: Array) -> Array:
        """The load itself."""
        return load

    def applied(self, effective: Array, load: Array) -> Array:
        """Sizes of the loads."""
        return np.abs(effective)
