"""A law across a contact that is not the program's: springs that harden, all in one file."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from fenics_contact.contact.laws import normal
from fenics_contact.contact.laws.normal.energy_law import EnergyLaw
from fenics_contact.contact.laws.normal.spring import positive
from fenics_contact.scene.laws.law_tables import NormalLawTable
from fenics_contact.scene.units.dimensions import LENGTH, STIFFNESS
from fenics_contact.scene.values import Positive, scene_class

KIND = "hardening springs"


@scene_class
class HardeningSprings(NormalLawTable):
    """Springs that are twice as stiff, as a chord, at the depth at which they have hardened.

    >>> HardeningSprings(kind="hardening springs", stiffness=1e3, depth=0.1).depth
    0.1
    """

    kind: Annotated[Literal["hardening springs"], Field(description="which law it is")]
    stiffness: Annotated[Positive, STIFFNESS, Field(description="k, at first")]
    depth: Annotated[Positive, LENGTH, Field(description="h, at which p = 2 k h")]


class Hardening(EnergyLaw):
    """p = k d (1 + d²/h²)."""

    kind: ClassVar[str] = KIND
    model: ClassVar[str] = "springs that harden"

    @classmethod
    def parameters(cls, contact):
        """k and h as the scene gives them."""
        return {"stiffness": contact.normal_law.stiffness, "depth": contact.normal_law.depth}

    def fields(self):
        """k and h at the points."""
        count = len(self.site.trace.weights)
        return {
            "stiffness": np.full(count, self.site.contact.normal_law.stiffness),
            "depth_of_hardening": np.full(count, self.site.contact.normal_law.depth),
        }

    def field_slopes(self, key, unit):
        """That of h has another name than its key, as ``density`` has a depth of its own."""
        if key == "normal_law.depth":
            return {"depth_of_hardening": self.site.given(unit, key)}
        return super().field_slopes(key, unit)

    @staticmethod
    def density(depth, jump, stiffness, depth_of_hardening):
        """k d²/2 (1 + d²/2h²)."""
        square = positive(depth) ** 2
        return stiffness * square / 2 * (1 + square / (2 * depth_of_hardening**2))


def register():
    """Make it known."""
    normal.register(Hardening, HardeningSprings)


def unregister():
    """Make it unknown again."""
    normal.unregister(Hardening)
