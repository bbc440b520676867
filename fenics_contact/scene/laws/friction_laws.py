"""How large friction may be: tables of their own in a scene, ``contact.friction_law``.

A new one is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fenics_contact.scene.laws.kinds import chosen_by_kind
from fenics_contact.scene.values import scene_class


class FrictionLawTable:
    """What all of them have: the kind by which results and messages name the law."""

    kind: str


@scene_class
class CoulombFriction(FrictionLawTable):
    """Coulomb's friction, bounded by the friction coefficient times the pressure: the default.

    >>> CoulombFriction(kind="coulomb").kind
    'coulomb'
    """

    kind: Annotated[Literal["coulomb"], Field(description="which law it is")]


if TYPE_CHECKING:
    AnyFrictionLaw = FrictionLawTable
else:
    AnyFrictionLaw = chosen_by_kind(*FrictionLawTable.__subclasses__())
