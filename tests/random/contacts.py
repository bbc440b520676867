"""Contacts at random on a body: obstacles, given pressures, foundations, floors, other bodies."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from fenics_contact import Contact, Load, Material, Obstacle, Path, Profile, Scene, Support
from tests.random.bodies import Shape
from tests.random.dice import Dice, short

AXES = "xyz"


@dataclass(frozen=True)
class Wave:
    """A gap of a wave along x, in UFL."""

    length: float
    height: float

    def __call__(self, x: object) -> object:
        """Gap at a place."""
        return self.height * (x[0] / self.length) ** 2 * (1 - x[0] / self.length) ** 2


@dataclass(frozen=True)
class Frame:
    """What all parts of a scene need to know of the others."""

    kinematics: str
    shape: Shape
    modulus: float
    poisson: float

    @property
    def axial(self) -> bool:
        return self.kinematics == "axisymmetric"

    @property
    def dimension(self) -> int:
        return len(self.shape.low)

    @property
    def normal(self) -> str:
        return AXES[self.dimension - 1]

    @property
    def width(self) -> float:
        """Of the contact surface (length)."""
        return self.shape.length * (self.shape.high[0] - self.shape.low[0])

    @property
    def tips_at(self) -> float:
        """Shear over pressure on top of a body that stands on a floor, somewhat less."""
        return 0.35 / (self.shape.high[-1] - self.shape.low[-1])

    def clamp(self, side: str) -> Support:
        return Support(side, dict.fromkeys(AXES[: self.dimension], 0.0))

    def vector(self, along: float, across: float) -> tuple[float, ...]:
        """In the mesh's axes; along the surface, in space with a part in both directions."""
        parts = [along] if self.dimension == 2 else [0.8 * along, 0.6 * along]
        return self.shape.turned(*parts, across)


_ONE_WAY = (Path((0, 1), (0, 1)), Path((0,), (1,)))
_THERE_AND_BACK = Path((0, 0.25, 0.5, 1), (0, 0.5, 1, -0.5))


def path_along(dice: Dice) -> Path:
    """Of what moves or pulls along the surface."""
    return dice.of(*_ONE_WAY, Path((0, 0.5, 1), (0, 0, 1)), _THERE_AND_BACK)


def friction(dice: Dice, coefficient: float) -> dict:
    law = dice.of("static", "incremental")
    return {"friction_coefficient": coefficient, "law": law}


def scene_of(frame: Frame, **keys) -> Scene:
    return Scene(
        kinematics=frame.kinematics, material=Material(frame.modulus, frame.poisson), **keys
    )


def pressed(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """An obstacle is pressed onto the top of a body that is held below, and moved along it."""
    obstacle, depth = obstacle_on(dice, frame)
    slide = 0.0 if dice.chance(10) else dice.between(0.1, 0.9) * min(coefficient, 3.0) * depth
    if frame.axial:
        slide = 0.0
    keys: dict = {}
    if slide and not (obstacle.gap is not None and frame.shape.turn):
        keys = {
            "displacement": frame.vector(short(slide), 0.0),
            "displacement_path": path_along(dice),
            "path": dice.of(Path((0, 0.5, 1), (0, 1, 1)), Path((0, 1), (0, 1)), Path((0,), (1,))),
        }
    contact = Contact(
        f"body.{frame.normal}1",
        obstacle=dataclasses.replace(obstacle, **keys),
        **friction(dice, coefficient),
    )
    return scene_of(frame, support=held_below(dice, frame), contact=(contact,))


def frictionless_pressed(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """A plane or a parabola is pressed onto a flat top, without friction."""
    return scene_of(
        frame,
        support=(frame.clamp(f"body.{frame.normal}0"),),
        contact=(Contact(f"body.{frame.normal}1", obstacle=_smooth(dice, frame)[0]),),
    )


def _smooth(dice: Dice, frame: Frame) -> tuple[Obstacle, float]:
    """A plane or a parabola that is driven by an indentation."""
    apex = frame.shape.place(*middle_of_top(frame))
    apex = (0.0, *apex[1:]) if frame.axial else apex
    half = dice.between(0.2, 0.45) * frame.width
    radius = short(half * dice.between(4, 20))
    depth = short(half**2 / (2 * radius))
    keys = {"position": apex, "indentation": depth}
    if dice.chance(20):
        return Obstacle("plane", **keys), depth
    if frame.dimension == 2 and not frame.axial:
        return Obstacle("parabola", radius=radius, **keys), depth
    return Obstacle("paraboloid", radius=radius, **keys), depth


def middle_of_top(frame: Frame) -> list[float]:
    """The middle of the top, among the boxes."""
    low, high = np.array(frame.shape.low), np.array(frame.shape.high)
    middle = (low + high) / 2
    if frame.axial:
        middle[0] = 0.0
    middle[-1] = high[-1]
    return middle.tolist()


def obstacle_on(dice: Dice, frame: Frame) -> tuple[Obstacle, float]:
    """Of any shape, driven by an indentation or a force; and about how deep it goes."""
    width, hollow = frame.width, frame.shape.low[0] > 0
    if frame.axial:
        shapes = ("plane", "annular punch") if hollow else ("paraboloid", "sphere", "flat punch")
    elif frame.dimension == 2:
        shapes = ("parabola", "cylinder", "parabola", "flat punch")
    else:
        shapes = ("paraboloid", "sphere", "parabola", "cylinder", "flat punch")
    shape = dice.of(*shapes, "plane", "gap")
    half = dice.between(0.2, 0.45) * width
    radius = short(half * dice.between(4, 20))
    depth = short(half**2 / (2 * radius))
    if shape == "gap":
        return _gap(dice, frame, depth), depth
    keys: dict = {"position": frame.shape.place(*middle_of_top(frame))}
    if frame.axial:
        keys["position"] = (0.0, *keys["position"][1:])
    if shape == "annular punch":
        keys |= {"radius": short(1.2 * width), "inner_radius": short(0.7 * width)}
    elif shape == "flat punch":
        keys["radius"] = short(half)
    elif shape != "plane":
        keys["radius"] = radius
    if shape in ("parabola", "cylinder") and frame.dimension == 3:
        keys["along"] = frame.shape.turned(*dice.of((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    if frame.shape.bulge or frame.shape.turn or frame.axial:
        keys["normal"] = frame.shape.turned(*[0.0] * (frame.dimension - 1), -1.0)
    if dice.chance(30):
        keys["force"] = short(
            frame.modulus * depth * (half if frame.dimension == 3 or frame.axial else 1.0)
        )
    else:
        keys["indentation"] = depth
    return Obstacle(shape, **keys), depth


def _gap(dice: Dice, frame: Frame, depth: float) -> Obstacle:
    width = frame.width
    wedge = Profile("x", (0.0, 0.5 * width, width), (2 * depth, 0.0, depth))
    gap = dice.of(0.0, -0.5 * depth, wedge, wedge, Wave(width, 30 * depth))
    if frame.shape.turn and not isinstance(gap, float):
        gap = 0.0
    down = frame.shape.turned(*[0.0] * (frame.dimension - 1), -1.0)
    return Obstacle(gap=gap, indentation=depth, direction=down)


def held_below(dice: Dice, frame: Frame) -> tuple[Support, ...]:
    """From below: clamped, or on rollers with one side held as well."""
    below = f"body.{frame.normal}0"
    if frame.shape.turn or dice.chance(70):
        return (frame.clamp(below),)
    return (
        Support(below, {frame.normal: 0.0}),
        *(Support(f"body.{axis}0", {axis: 0.0}) for axis in AXES[: frame.dimension - 1]),
    )


def prescribed(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """Friction under a given pressure; pulled along, held at the far end or below."""
    pressure = pressure_for(dice, frame)
    height = frame.shape.high[-1] - frame.shape.low[-1]
    pull = dice.between(0.2, 1.2) * min(coefficient, 1.0) * pressure / min(height, 1.0)
    vector = frame.vector(short(pull), 0.0)
    held = f"body.{frame.normal}0" if frame.axial or dice.chance(25) else "body.x0"
    contact = Contact(
        f"body.{frame.normal}1", pressure=pressure, **friction(dice, coefficient or 0.3)
    )
    load = Load("body.x1", traction=vector, path=path_along(dice))
    return scene_of(frame, support=(frame.clamp(held),), load=(load,), contact=(contact,))


def pressure_for(dice: Dice, frame: Frame) -> float:
    return short(frame.modulus * dice.logarithmic(1e-5, 2e-2))


def foundation(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """On springs that push and do not pull; loaded above on one side and from a side."""
    pressure = pressure_for(dice, frame)
    stiffness = short(frame.modulus / frame.width * dice.logarithmic(0.05, 50))
    contact = Contact(
        f"body.{frame.normal}0", foundation_stiffness=stiffness, **friction(dice, coefficient)
    )
    return scene_of(
        frame,
        support=() if frame.axial else (_aside(frame),),
        load=(_weight(frame, pressure), *_shear(dice, frame, pressure * min(coefficient, 1.0))),
        contact=(contact,),
    )


def _aside(frame: Frame) -> Support:
    """Nothing but sideways motion is held, at one end."""
    axes = AXES[: frame.dimension] if frame.shape.turn else AXES[: frame.dimension - 1]
    return Support("body.x0", dict.fromkeys(axes, 0.0))


def _weight(frame: Frame, pressure: float) -> Load:
    """From the start, so that friction can hold what pushes then."""
    traction = frame.vector(0.0, -pressure)
    return Load(f"body.{frame.normal}1", traction=traction, path=_ONE_WAY[1])


def _shear(dice: Dice, frame: Frame, most: float) -> tuple[Load, ...]:
    """Along the top, up to and somewhat beyond what friction can hold."""
    if frame.axial or most == 0:
        return ()
    shear = short(dice.between(0.6, 1.05) * most)
    return (
        Load(f"body.{frame.normal}1", traction=frame.vector(shear, 0.0), path=path_along(dice)),
    )


def floor(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """Stands on a floor, held by friction alone or by one side; pressed down and pushed."""
    pressure = pressure_for(dice, frame)
    free = frame.axial or (coefficient > 0 and dice.chance(50))
    most = pressure * min(coefficient, frame.tips_at)
    contact = Contact(f"body.{frame.normal}0", **friction(dice, coefficient))
    return scene_of(
        frame,
        support=() if free else (_aside(frame),),
        load=(_weight(frame, pressure), *_shear(dice, frame, most)),
        contact=(contact,),
    )


def pair(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """Two bodies; the upper one is pressed onto the lower one and moved along it."""
    above = f"upper.{frame.normal}1"
    contact = Contact(
        f"upper.{frame.normal}0",
        against=f"body.{frame.normal}1",
        slave=dice.of("auto", "auto", "on", "against"),
        **friction(dice, coefficient),
    )
    depth = frame.width * dice.logarithmic(1e-4, 0.02)
    slide = 0.0 if frame.axial else dice.between(0.5, 5) * min(coefficient, 0.6) * depth
    support, load = [frame.clamp(f"body.{frame.normal}0")], []
    if frame.axial or frame.shape.turn or dice.chance(70):
        down = frame.vector(short(slide), -short(depth))
        support.append(Support(above, dict(zip(AXES, down, strict=False)), path=dice.of(*_ONE_WAY)))
    else:
        load.append(Load(above, traction=frame.vector(0.0, -short(frame.modulus * depth))))
        moved = frame.vector(short(slide), 0.0)[:-1]
        support.append(Support(above, dict(zip(AXES, moved, strict=False)), path=path_along(dice)))
    return scene_of(frame, support=tuple(support), load=tuple(load), contact=(contact,))


def glued(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """Glued below, pressed and rubbed above."""
    below = Contact(f"body.{frame.normal}0", contact="bonded")
    scene = pressed(dice, frame, coefficient)
    return dataclasses.replace(scene, support=(), contact=(*scene.contact, below))


def impossible(dice: Dice, frame: Frame, coefficient: float) -> Scene:
    """Without equilibrium, or asking for what there is not."""
    side = f"body.{frame.normal}0"
    pressure = pressure_for(dice, frame)
    lifted = (Load(f"body.{frame.normal}1", traction=frame.vector(0.0, pressure)),)
    on_floor = Contact(side, **friction(dice, coefficient))
    wrong = dice.of("lifted", "lying", "group", "pulled", "held", "none", "iterative")
    if wrong == "lifted":
        return scene_of(frame, load=lifted, contact=(on_floor,))
    if wrong == "lying":  # nothing says where
        return scene_of(frame, contact=(dataclasses.replace(on_floor, friction_coefficient=0.0),))
    if wrong == "group":
        return scene_of(frame, support=(frame.clamp("body.w0"),), contact=(on_floor,))
    if wrong == "pulled":  # beyond what friction under a given pressure can hold
        above = Contact(f"body.{frame.normal}1", pressure=pressure, friction_coefficient=0.1)
        pull = Load(side, traction=frame.vector(pressure, pressure))
        return scene_of(frame, load=(pull,), contact=(above,))
    if wrong == "held":
        return scene_of(frame, load=lifted, contact=())
    if wrong == "none":
        return scene_of(frame, support=(frame.clamp(side),), contact=(on_floor,))
    return dataclasses.replace(
        scene_of(frame, support=(frame.clamp(side),), load=lifted),
        material=(Material(frame.modulus, 0.4999),),
    )


KINDS = {
    "pressed": pressed,
    "prescribed": prescribed,
    "foundation": foundation,
    "floor": floor,
    "pair": pair,
    "glued": glued,
    "impossible": impossible,
}
