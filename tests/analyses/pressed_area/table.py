"""The table of a scene that asks for the area that carries a high pressure."""

from typing import Annotated

from pydantic import Field

from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.units.dimensions import STRESS
from fenics_contact.scene.values import Positive, scene_class


@scene_class
class PressedArea:
    """Which area carries more than a pressure, along the load steps."""

    above: Annotated[Positive, STRESS, Field(description="the pressure")]


PRESSED_AREA = Annotated[
    PressedArea | None,
    FREE_AT_RESUME,
    Field(description="the area that carries more than a pressure"),
]


def require(scene):
    """Refuse a scene in which nothing presses."""
    if not scene.contact:
        raise ValueError("pressed_area: there is no contact")
