"""The part of a scene that says that its bodies have mass and move: steps in real time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field

from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.settings import Steps
from fenics_contact.scene.units.dimensions import RATE, TIME, VELOCITY
from fenics_contact.scene.values import PER_AXIS, Number, Positive, scene_class

# Of a step, by which the last one may end behind the end.
_SAME = 1e-9
MOST_STEPS = 100_000


@scene_class
class Rayleigh:
    """Damping in all of the bodies: mass · M + stiffness · K, times the velocity.

    A mode of angular frequency ω has the damping ratio ½ (mass/ω + stiffness ω).

    >>> Rayleigh(stiffness=1e-3).mass
    0.0
    """

    mass: Annotated[
        Number,
        Field(ge=0),
        RATE,
        Field(description="factor of the masses, which damps slow motions most"),
    ] = 0.0
    stiffness: Annotated[
        Number,
        Field(ge=0),
        TIME,
        Field(description="factor of the stiffness, which damps fast vibrations most"),
    ] = 0.0


@scene_class
class MotionModes:
    """Bodies that move in their lowest modes alone, and else give way as in statics.

    Of a free body its rigid motions come first, and do not count.

    >>> MotionModes().number
    'automatic'
    """

    number: Annotated[
        Annotated[int, Field(gt=0)] | Literal["automatic"],
        Field(
            description="of modes beside the rigid motions; `automatic`: twice as many until the "
            "motion is as accurate as asked"
        ),
    ] = "automatic"
    accuracy: Annotated[
        Positive,
        Field(
            description="of contact forces and kinetic energy in every step, over their largest "
            "in all steps: what half of the modes may change of them, and no mode may have"
        ),
    ] = 1e-2


@scene_class
class Motion:
    """Bodies that have mass and move, in real time: they fly, land, slide and rebound.

    They begin at rest, or with a velocity; without stress, or with that of the static answer. All
    paths are of the time.

    >>> motion = Motion(step=0.01, end=2, velocity={"ball": (0, -3)})
    >>> motion.steps.number, motion.size
    (200, 0.01)
    """

    step: Annotated[
        Annotated[Positive, TIME] | Literal["automatic"],
        Field(
            description="of each step; shortened if need be, so that all are of one length. A wave "
            "should not pass much more than a cell in it; `automatic`: it just passes one"
        ),
    ]
    end: Annotated[Positive, TIME, FREE_AT_RESUME, Field(description="at which it ends")]
    velocity: Annotated[
        Mapping[str, Annotated[tuple[Annotated[Number, VELOCITY], ...], PER_AXIS]],
        Field(
            description="at time 0: physical group of cells → a vector, such as "
            "`{ ball = [0, -3] }`; 0 elsewhere"
        ),
    ] = Field(default_factory=dict)
    start: Annotated[
        Literal["unstressed", "static"],
        Field(
            description="the state at time 0: bodies as meshed, without stress, or the static "
            "answer under what acts then"
        ),
    ] = "unstressed"
    rayleigh: Annotated[
        Rayleigh | None, Field(description="damping in the bodies; without it there is none")
    ] = None
    absorbing: Annotated[
        tuple[str, ...],
        Field(
            description="groups of facets that let waves out, as if the body went on behind: they "
            "resist velocities alone, and drift under loads that last"
        ),
    ] = ()

    modes: Annotated[
        MotionModes | None,
        Field(
            description="move in few modes alone, where contact lasts much longer than waves take "
            "through the bodies; without it all that the mesh can do moves"
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.step == "automatic":
            return
        if self.step > self.end:
            raise ValueError(f"step = {self.step:g} must not exceed end = {self.end:g}")
        if self.end / self.step > MOST_STEPS:
            raise ValueError(f"end / step must be at most {MOST_STEPS} steps")

    @cached_property
    def steps(self) -> Steps:
        """Time steps, all of one length; their number is open while the length is automatic."""
        if self.step == "automatic":
            return Steps(automatic=True, end=self.end)
        return Steps(number=math.ceil(self.end / self.step * (1 - _SAME)), end=self.end)

    @property
    def size(self) -> float:
        """Length of a step as it is taken (time)."""
        return self.end / self.steps.number
