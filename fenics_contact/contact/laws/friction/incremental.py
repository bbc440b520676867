"""Coulomb's friction law: it acts on the slip since the last accepted load step."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.regularised import RegularisedFriction


class Incremental(RegularisedFriction):
    """σ_T = −g φ_ε′(Δu_T), Δu_T the slip of the present load step."""

    kind: ClassVar[str] = "incremental"
    follows_path: ClassVar[bool] = True

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """Return the work that friction has done along the path through the load steps.

        Of slip that goes back, the work less what it stores: that is 0 unless the pressure changes,
        and springs with it. When the pressure falls, a part of what they stored is lost.
        """
        if not self.stores_energy:
            return given
        now, then = self.rule.elastic(self.effective_slip(slip)), self.rule.carried_slip
        return np.asarray(given - 0.5 * np.sum(before * now - traction * then, axis=1))
