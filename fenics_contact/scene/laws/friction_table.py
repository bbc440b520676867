"""Base class of the tables of friction laws, and conditions on their numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, ClassVar

from fenics_contact.scene.values import Value


class FrictionLawTable:
    """Base class of the tables of friction laws.

    Attributes:
        kind: By which results and messages name the law.
        is_proportional: Whether it is one coefficient times the pressure.
        needs_steps: Whether it follows the slip of load steps, as the incremental law has it.
        needs_motion: Whether it follows velocities, which there are where bodies move.
        is_regular: Whether its surfaces give way along each other, so that it needs no
            regularisation.
    """

    kind: str
    is_proportional: ClassVar[bool] = False
    needs_steps: ClassVar[bool] = False
    needs_motion: ClassVar[bool] = False
    is_regular: ClassVar[bool] = False

    @property
    def fits_motion(self) -> bool:
        """Whether it follows velocities, so that bodies in motion may have it."""
        return self.is_proportional or self.needs_motion

    @property
    def at_rest(self) -> FrictionLawTable | None:
        """The law between bodies that do not slide; None where that is Coulomb's."""
        return self

    @property
    def shown(self) -> str:
        """The law and its numbers in words, for results."""
        keys: Any = self
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(keys)}
        values |= values.pop("parameters", {})
        words = [f"{key} {_shown(value)}" for key, value in values.items() if key != "kind"]
        return f"{self.kind}: {', '.join(words)}" if words else self.kind

    def require_model(self, kinematics: str, key: str) -> None:
        """See that it fits the model.

        Args:
            kinematics: Of the scene.
            key: Of the contact, for messages.

        Raises:
            ValueError: It does not.
        """

    def require_fit(self, kind: str, coefficient: Value) -> None:
        """See that it fits the contact that it is of.

        Args:
            kind: The law across the contact, as results name it.
            coefficient: The contact's friction_coefficient.

        Raises:
            ValueError: It does not.
        """


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_shown, value))}]"
    return f"{value:.4g}" if isinstance(value, float) else "varies" if callable(value) else value


def require_increase(key: str, places: Sequence[float], shares: Sequence[float]) -> None:
    """See that a table has as many places as shares, from 0 or more, one after the other.

    Args:
        key: Of the places.
        places: At which shares are given.
        shares: Given there.

    Raises:
        ValueError: It has not.
    """
    if len(places) != len(shares):
        raise ValueError(f"{key} has {len(places)} entries and shares {len(shares)}")
    if places[0] < 0 or any(b <= a for a, b in pairwise(places)):
        raise ValueError(f"{key} must be ≥ 0 and increase")
