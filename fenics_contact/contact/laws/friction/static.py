"""The static friction law: it acts on the total displacement along the surface (the paper's)."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.regularised import RegularisedFriction


class Static(RegularisedFriction):
    """σ_T = −g φ_ε′(u_T) (paper, (1.6), (2.8)): what it dissipates is −σ_T · u_T."""

    kind: ClassVar[str] = "static"

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """−σ_T · u_T since the start, less what goes back."""
        return np.asarray(0.0 - np.einsum("ij,ij->i", traction, self.sliding(slip)))
