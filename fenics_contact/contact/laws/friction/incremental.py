"""Coulomb's friction law: it acts on the slip since the last accepted load step."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.regularised import RegularisedFriction


class Incremental(RegularisedFriction):
    """σ_T = −g φ_ε′(Δu_T), Δu_T the slip of the present load step."""

    kind: ClassVar[str] = "incremental"
    follows_path: ClassVar[bool] = True

    def work(self, given: Array, traction: Array, slip: Array) -> Array:
        """As its path through the load steps tells it."""
        return given
