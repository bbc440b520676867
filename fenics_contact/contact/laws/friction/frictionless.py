"""A contact without friction."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.contact.laws.friction.law import FrictionLaw


class Frictionless(FrictionLaw):
    """σ_T = 0."""

    kind: ClassVar[str] = "none"
