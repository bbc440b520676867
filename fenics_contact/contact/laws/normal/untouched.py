"""An obstacle that no force drives onto the body: it stands there, and exerts nothing."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.contact.laws.normal.law import NormalLaw


class Untouched(NormalLaw):
    """p = 0: what the body may leave, and no force drives, is where it just touches."""

    kind: ClassVar[str] = "untouched"
    model: ClassVar[str] = "an obstacle that nothing drives"
    pressure_is_known: ClassVar[bool] = True
