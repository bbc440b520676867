"""State that load steps keep besides their last one, with which another run goes on."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from fenics_contact.common.arrays import Array


@dataclass(frozen=True, eq=False)
class AuxiliaryState:
    """State that is kept besides the last load step, such as where a motion's step began.

    Attributes:
        said: What is no array, as JSON has it.
        at_points: Of each contact, by name: values at its points, (points,); none of none.
        nodal: By name: values at the body's nodes of this rank, (nodes, components).
    """

    said: dict[str, Any] = field(default_factory=dict)
    at_points: list[dict[str, Array]] = field(default_factory=list)
    nodal: dict[str, Array] = field(default_factory=dict)

    def of_contact(self, number: int) -> dict[str, Array]:
        """The values at the points of a contact."""
        return self.at_points[number] if self.at_points else {}
