"""The part of a scene that asks for fretting: what the stress near contacts does to a material."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.units.dimensions import LENGTH, STRESS
from fenics_contact.scene.values import Number, Positive, scene_class


@scene_class
class FatigueLimits:
    """Amplitudes of stress that a material endures for ever, loaded to and fro.

    >>> FatigueLimits(torsion=250, tension=400).torsion
    250.0
    """

    torsion: Annotated[Positive, STRESS, Field(description="τ₋₁, of the shear stress in torsion")]
    tension: Annotated[
        Positive,
        STRESS,
        Field(description="σ₋₁, of the stress in tension and compression, from τ₋₁ to √3 τ₋₁"),
    ]

    def __post_init__(self) -> None:
        if not self.torsion <= self.tension <= np.sqrt(3) * self.torsion * (1 + 1e-3):
            raise ValueError(
                f"tension = {self.tension:g}: must lie between torsion, {self.torsion:g}, and √3 "
                f"times it, {np.sqrt(3) * self.torsion:g}, or mean stresses would do good"
            )


@scene_class
class StrainLifeLine:
    """The line of Coffin, Manson and Basquin, Δε/2 = (σ_f'/E)(2N)^b + ε_f' (2N)^c.

    >>> StrainLifeLine(strength=900, strength_exponent=-0.09, ductility=0.4).ductility_exponent
    -0.6
    """

    strength: Annotated[Positive, STRESS, Field(description="σ_f', fatigue strength coefficient")]
    strength_exponent: Annotated[
        Number, Field(ge=-1, lt=0, description="b < 0, fatigue strength exponent")
    ]
    ductility: Annotated[Positive, Field(description="ε_f', fatigue ductility coefficient")]
    ductility_exponent: Annotated[
        Number, Field(ge=-2, lt=0, description="c < 0, fatigue ductility exponent")
    ] = -0.6


@scene_class
class Fretting:
    """Criteria of fatigue by the history of stress near contacts, over the last cycle of loads.

    >>> Fretting(depth=0.5).begin
    0.0
    """

    depth: Annotated[
        Positive,
        LENGTH,
        Field(
            description="how far from where a contact touches, along the surface and below it, "
            "stress is looked at"
        ),
    ]
    begin: Annotated[
        Number,
        Field(
            ge=0,
            description="pseudo-time from which on, where there are no `[cycles]`, load steps "
            "count as one cycle; at 0 with the unloaded body, before the first of them",
        ),
    ] = 0.0
    limits: Annotated[
        FatigueLimits | None,
        Field(
            description="fatigue limits, for Crossland and Dang Van: `{ torsion = 250, "
            "tension = 400 }`"
        ),
    ] = None
    life: Annotated[
        StrainLifeLine | None,
        Field(
            description="constants of the material for lives by Smith, Watson and Topper: "
            "`{ strength = 900, strength_exponent = -0.09, ductility = 0.4 }`"
        ),
    ] = None


class _AskingForFretting(CoreScene):
    """A scene with this table."""

    fretting: Fretting


def require(scene: _AskingForFretting) -> None:
    """Refuse to look for fretting where there is none, or without the numbers that it takes.

    Raises:
        ValueError: In words.
    """
    fretting = scene.fretting
    if not scene.contact:
        raise ValueError("fretting: the scene has no contact; give it one, or leave fretting out")
    if fretting.begin > 0 and cycles_of(scene) is not None:
        raise ValueError(
            f"fretting.begin = {fretting.begin:g}: is for scenes without cycles; of those the last "
            "one counts, so leave it out"
        )
    if fretting.begin >= scene.steps.last:
        raise ValueError(
            f"fretting.begin = {fretting.begin:g}: must be less than the end of the last load "
            f"step, {scene.steps.last:g}"
        )
    stiff = [n for n, material in enumerate(scene.material) if material.stiffness is not None]
    if fretting.life is not None and stiff:
        raise ValueError(
            f"fretting.life: needs Young's modulus, and material[{stiff[0]}] has a stiffness; "
            "leave life out"
        )
