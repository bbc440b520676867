"""What glue does along a surface: it holds; its traction is part of the glue's energy."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.state import OPEN, STICK


class Stick(FrictionLaw):
    """u_T = 0, whatever the traction."""

    kind: ClassVar[str] = "stick"
    model: ClassVar[str] = "glue along the surface"
    carries_shear: ClassVar[bool] = True

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """STICK where points are glued on, OPEN elsewhere."""
        return np.where(closed, STICK, OPEN)
