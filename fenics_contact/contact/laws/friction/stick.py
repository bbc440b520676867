"""What glue does along a surface: it holds; its traction is part of the glue's energy."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.state import OPEN, STICK

Array = NDArray[np.float64]


class Stick(FrictionLaw):
    """u_T = 0, whatever the traction."""

    kind: ClassVar[str] = "stick"
    model: ClassVar[str] = "glue along the surface"
    carries_shear: ClassVar[bool] = True

    def status(self, closed: NDArray[np.bool_], slip: Array, bound: Array) -> NDArray[np.str_]:
        """What is glued on sticks."""
        return np.where(closed, STICK, OPEN)

    def status_at_rest(self, closed: NDArray[np.bool_]) -> NDArray[np.str_]:
        """What is glued on sticks."""
        return np.where(closed, STICK, OPEN)
