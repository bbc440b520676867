"""The part of a scene that asks whether bodies slide steadily, or begin to squeal."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.loading.motion import Rayleigh
from fenics_contact.scene.values import Integer, Positive, scene_class


@scene_class
class Stability:
    """Complex modes about the last state, in which all that touches slides steadily.

    >>> Stability(up_to=1.0).coefficients[:3]
    (0.0, 0.05, 0.1)
    """

    number: Annotated[
        Integer,
        Field(ge=1, le=200, description="how many modes, those of the lowest frequencies"),
    ] = 10
    up_to: Annotated[
        Positive | None,
        Field(
            description="friction coefficient up to which modes are followed, from 0 on, and the "
            "smallest one is searched at which one of them grows; of several contacts it is the "
            "largest, and all are changed in proportion"
        ),
    ] = None
    points: Annotated[
        Integer,
        Field(ge=2, le=1000, description="how many coefficients from 0 to `up_to`"),
    ] = 21
    rayleigh: Annotated[
        Rayleigh | None,
        Field(description="damping in the bodies, as of `[motion]`; without it there is none"),
    ] = None

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Friction coefficients at which modes are found, from 0 on; none without ``up_to``."""
        if self.up_to is None:
            return ()
        last = self.points - 1
        return tuple(round(self.up_to * number / last, 12) for number in range(self.points))


def require(scene: CoreScene) -> None:
    """Refuse a scene whose steady sliding cannot be examined.

    Raises:
        ValueError: In words.
    """
    others = {
        "half_space": scene.half_space is not None,
        "coupling": bool(scene.coupling),
        "cycles": scene.cycles is not None,
        "solver.stabilisation": scene.solver.stabilisation,
    }
    for key, is_there in others.items():
        if is_there:
            raise ValueError(
                f"stability: is of bodies of finite size that slide steadily; leave {key} out"
            )
    for number, material in enumerate(scene.material):
        if material.density is None:
            key = f"material[{number}]" if len(scene.material) > 1 else "material"
            raise ValueError(f"stability: {key}.density is missing: the mass of a unit of volume")
    for number, contact in enumerate(scene.contact):
        if not contact.is_rough:
            continue
        key = f"contact[{number}]"
        is_coulomb = contact.friction_law is None or contact.friction_law.is_proportional
        if not is_coulomb or contact.law != "incremental":
            raise ValueError(
                f"stability: {key}: only Coulomb's friction of law = 'incremental' tells in which "
                "direction it slides"
            )
        if not isinstance(contact.friction_coefficient, float | int):
            raise ValueError(f"stability: {key}.friction_coefficient must be a number here")
    if not any(contact.is_rough for contact in scene.contact):
        raise ValueError("stability: no contact has friction, and nothing else can make it squeal")
