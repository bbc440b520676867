"""A friction law that is not the program's: Coulomb's up to a largest traction, all in one file."""

from typing import Annotated, ClassVar, Literal

import ufl
from pydantic import Field

from fenics_contact.contact.laws.friction import rules
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.scene.laws.law_tables import FrictionLawTable
from fenics_contact.scene.units.dimensions import STRESS
from fenics_contact.scene.values import Positive, scene_class

KIND = "shear limit"


@scene_class
class ShearLimitFriction(FrictionLawTable):
    """Coulomb's friction up to the shear strength of the softer body, which bounds it from there.

    >>> ShearLimitFriction(kind="shear limit", strength=30.0).shown
    'shear limit: strength 30'
    """

    kind: Annotated[Literal["shear limit"], Field(description="which law it is")]
    strength: Annotated[Positive, STRESS, Field(description="the largest friction traction τ")]


class ShearLimit(FrictionRule):
    """g = min(μ p, τ)."""

    kind: ClassVar[str] = KIND

    @property
    def constants(self):
        """τ."""
        return {"strength": self.site.contact.friction_law.strength}

    @staticmethod
    def bound(pressure, coefficient, strength):
        """min(μ p, τ)."""
        return ufl.min_value(coefficient * pressure, strength)

    @property
    def largest_coefficient(self):
        """μ, that of small pressures."""
        return self.coefficient


def register():
    """Make it known."""
    rules.register(ShearLimit, ShearLimitFriction)


def unregister():
    """Make it unknown again."""
    rules.unregister(ShearLimit)
