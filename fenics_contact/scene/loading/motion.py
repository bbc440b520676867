"""The part of a scene that says that its bodies have mass and move: steps in real time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fenics_contact.analyses import registry
from fenics_contact.scene.contact import Contact, kinds_in_motion
from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.steps import Steps
from fenics_contact.scene.units.dimensions import RATE, TIME, VELOCITY
from fenics_contact.scene.values import PER_AXIS, RAMP, Number, Positive, scene_class

if TYPE_CHECKING:
    from fenics_contact.scene.scene import Scene

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


def require_motion(scene: Scene) -> None:
    """Refuse what has no meaning, or cannot be had yet, where bodies move, and laws that need it.

    Raises:
        ValueError: In words.
    """
    motion = scene.motion
    if motion is None:
        for number, contact in enumerate(scene.contact):
            law = contact.friction_law
            if law is not None and law.needs_motion:
                raise ValueError(
                    f"contact[{number}].friction_law: {law.kind} friction follows velocities, and "
                    "nothing moves here: give [motion]"
                )
        return
    others = {
        "steps": scene.steps != Steps(),
        "cycles": scene.cycles is not None,
        "half_space": scene.half_space is not None,
        "accuracy": scene.accuracy is not None,
        **dict.fromkeys(registry.tables_not_with(scene, "motion"), True),
        "solver.branches": scene.solver.branches,
        "solver.stabilisation": scene.solver.stabilisation,
    }
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"motion: bodies that move have no {key}; leave one of the two out")
    if scene.solver.solver not in ("auto", "condensed"):
        raise ValueError(
            f"motion: it is solved by 'condensed', not by solver.solver = '{scene.solver.solver}'"
        )
    for group, velocity in motion.velocity.items():
        if len(velocity) != scene.dimension:
            raise ValueError(
                f"motion.velocity.{group} has {len(velocity)} entries; a {scene.kinematics} model "
                f"needs {scene.dimension}"
            )
    if scene.preload and motion.rayleigh is not None and motion.rayleigh.stiffness > 0:
        raise ValueError(
            "motion.rayleigh.stiffness: not beside a preload, whose shortening it would resist as "
            "if it were a strain; give motion.rayleigh.mass"
        )
    _require_paths(scene)
    _require_free_modes(scene, motion)
    for number, contact in enumerate(scene.contact):
        _require_contact(contact, f"contact[{number}]")


def _require_free_modes(scene: Scene, motion: Motion) -> None:
    """Modes are those of bodies alone: nothing damps, rubs or ties them."""
    if motion.modes is None:
        return
    others = {
        "motion.rayleigh": motion.rayleigh is not None,
        "motion.absorbing": bool(motion.absorbing),
        "preload": bool(scene.preload),
    }
    for number, contact in enumerate(scene.contact):
        others[f"contact[{number}] with friction"] = contact.is_rough
        others[f"contact[{number}].kind = 'bonded'"] = contact.kind == "bonded"
    for key, is_there in others.items():
        if is_there:
            raise ValueError(f"motion.modes: not beside {key} yet; leave one of the two out")


def _require_paths(scene: Scene) -> None:
    """Refuse loads without a path of their own: the ramp of load steps would end at time 1."""
    acting = {
        **{f"load[{number}].path": load.path for number, load in enumerate(scene.load)},
        **{
            f"support[{number}].path": support.path
            for number, support in enumerate(scene.support)
            if any(value != 0 for value in support.displacement.values())
        },
        **{
            f"preload[{number}].path": preload.path
            for number, preload in enumerate(scene.preload)
            if preload.locked_from is None
        },
    }
    for number, contact in enumerate(scene.contact):
        obstacle = contact.obstacle
        if obstacle is not None and obstacle.indentation:
            acting[f"contact[{number}].obstacle.path"] = obstacle.path
        if obstacle is not None and obstacle.displacement is not None:
            acting[f"contact[{number}].obstacle.displacement_path"] = obstacle.displacement_path
    for key, path in acting.items():
        if path == RAMP:
            raise ValueError(
                f"motion: {key} is missing, or is the ramp of load steps from 0 to 1: say how it "
                "acts in time; what always acts has { time = [0], factor = [1] }, a ramp goes on "
                "as long as the motion"
            )


def _require_contact(contact: Contact, key: str) -> None:
    if contact.obstacle is not None and contact.obstacle.force is not None:
        raise ValueError(f"motion: {key}.obstacle.force: an obstacle has no mass; move it instead")
    if contact.wear is not None:
        raise ValueError(f"motion: {key}.wear: bodies that move do not wear yet; leave it out")
    if not contact.fits_motion:
        kinds = ", ".join(kinds_in_motion())
        raise ValueError(f"motion: {key}: only contacts that are {kinds} can move yet")
    law = contact.friction_law
    follows = contact.law != "static" and (law is None or law.fits_motion)
    if contact.is_rough and not follows:
        raise ValueError(
            f"motion: {key}: only Coulomb's friction of law = 'incremental', or with a "
            "friction_law of kind = 'speed dependent', follows velocities yet"
        )
