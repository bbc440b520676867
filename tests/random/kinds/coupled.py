"""Couplings, springs between them, supports along turned axes and contacts, a few at once.

Blocks in a row that springs join, stacks and punches, shafts in hubs, and rings. Now and then faces
share points with something else, or nothing holds a motion: these are refused.
"""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass, field
from math import pi
from typing import Any

from fenics_contact import Contact, Coupling, Load, Material, Obstacle, Path, Spring, Steps, Support
from fenics_contact.scene.loading.couplings import GROUND, ways_of
from fenics_contact.scene.loading.support_axes import SupportAxes
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    AXIAL,
    PLANE,
    Elements,
    Ring,
    Turned,
    held,
    made,
    size_of,
)
from tests.random.scenes import RandomScene

_HEXAHEDRA = Elements("3D", "hexahedron", 1)
_TETRAHEDRA = Elements("3D", "tetrahedron", 2)
_ELEMENTS = (*PLANE, *PLANE, _HEXAHEDRA, _HEXAHEDRA, _TETRAHEDRA)
_RINGS = (
    Elements("plane strain", "quadrilateral", 2, order=2),
    Elements("plane stress", "quadrilateral", 2, order=2),
    Elements("plane strain", "triangle", 2, order=2),
)
_PATHS = (Path((0, 1), (0, 1)), Path((0, 0.5, 1), (0, 1, 0.6)), Path((0,), (1,)))


@dataclass
class _Draft:
    """What a scene has so far.

    Attributes:
        dice: What is thrown.
        elements: Kinematics, cells and degree.
        shape: Where the points of boxes go.
        modulus: Young's modulus (stress).
        poisson: Poisson's ratio.
    """

    dice: Dice
    elements: Elements
    shape: Any
    modulus: float
    poisson: float
    coupling: list[Coupling] = field(default_factory=list)
    spring: list[Spring] = field(default_factory=list)
    support: list[Support] = field(default_factory=list)
    contact: list[Contact] = field(default_factory=list)
    load: list[Load] = field(default_factory=list)

    @property
    def dimension(self) -> int:
        return self.elements.dimension

    @property
    def length(self) -> float:
        return self.shape.length

    @property
    def force(self) -> float:
        """Of a size that strains the bodies by some 1e-4 to 1e-2 (force)."""
        scale = self.modulus * self.length ** (self.dimension - 1)
        if self.elements.kinematics == "axisymmetric":
            scale *= 2 * pi * self.length
        return short(scale * self.dice.logarithmic(1e-4, 1e-2)) * self.dice.of(1, -1)

    def vector(self, *components: float) -> tuple[float, ...]:
        """Turned as the bodies are."""
        turned = getattr(self.shape, "vector", lambda *same: same)
        return tuple(short(value) for value in turned(*components))

    def path(self) -> Path:
        return self.dice.of(_PATHS[0], *_PATHS)

    def couple(self, on: str, name: str, pushed: tuple[float, ...] = (), **given: Any) -> None:
        """A face as a coupling, loaded, moved or left to its springs."""
        dice, keys = self.dice, dict(given)
        chance = 0 if pushed else 20
        for kind, axis in ways_of(self.elements.kinematics):
            if not dice.chance(chance):
                continue
            amount = 1e-3 * dice.between(-1, 1)
            size = self.length if kind == "displacement" else 1.0
            keys.setdefault(kind, {})[axis] = short(size * dice.of(0.0, amount))
        fixed = keys.get("displacement", {})
        if pushed or dice.chance(70):
            forces = pushed or tuple(
                0.0 if self._is_radial(axis) else dice.of(0.0, self.force)
                for axis in range(self.dimension)
            )
            force = [0.0 if AXES[k] in fixed else value for k, value in enumerate(forces)]
            keys["force"] = tuple(force)
        if self.elements.kinematics != "axisymmetric" and dice.chance(40) and not pushed:
            arm = short(self.force * self.length * 0.3)
            turns = keys.get("rotation", {})
            if self.dimension == 2:
                keys["moment"] = 0.0 if "z" in turns else arm
            else:
                keys["moment"] = tuple(0.0 if a in turns else dice.of(0.0, arm) for a in AXES)
        if dice.chance(50) and self.elements.kinematics != "axisymmetric":
            keys["at"] = tuple(
                short(self.length * dice.between(-1, 3)) for _ in range(self.dimension)
            )
        self.coupling.append(Coupling(on, name=name, path=self.path(), **keys))

    def drive(self, on: str, name: str, *moved: float, kind: str = "rigid") -> None:
        """A face as a coupling whose motion is given."""
        displacement = dict(zip(AXES, self.vector(*moved), strict=False))
        if self.elements.kinematics == "axisymmetric":
            del displacement["x"]
        turns = [axis for kind, axis in ways_of(self.elements.kinematics) if kind == "rotation"]
        rotation = {axis: short(1e-4 * self.dice.between(-1, 1)) for axis in turns}
        keys = {"displacement": displacement, "rotation": rotation, "path": self.path()}
        self.coupling.append(Coupling(on, kind=kind, name=name, **keys))

    def kind(self) -> str:
        """Rigid, or distributing where something else holds the body as well."""
        return self.dice.of("rigid", "rigid", "distributing")

    def push(self, on: str, name: str, friction: dict[str, Any]) -> None:
        """A face that is pressed down, and along by less than friction holds: driven, or loaded."""
        dice, between, kind = self.dice, (0.0,) * (self.dimension - 2), self.kind()
        axial = self.elements.kinematics == "axisymmetric"
        share = dice.between(-0.5, 0.5) * friction.get("friction_coefficient", 0.0)
        along = 0.0 if axial or dice.chance(30) else share
        if dice.chance(50):
            depth = 1e-3 * self.length * dice.between(0.2, 2)
            self.drive(on, name, along * depth, *between, -depth, kind=kind)
        elif dice.chance(85):
            force = abs(self.force)
            pushed = self.vector(along * force, *between, -force)
            self.couple(on, name, pushed, kind=kind)
        else:
            self.couple(on, name, kind=kind)

    def _is_radial(self, axis: int) -> bool:
        return self.elements.kinematics == "axisymmetric" and axis == 0

    def join(self, one: str, other: str, firmly: bool) -> None:
        """A spring, along and about everything where it is to hold."""
        dice, keys = self.dice, {}
        turns = self.elements.kinematics != "axisymmetric"
        stiff = abs(self.force) / self.length * 100
        choices = ["both"] if firmly else ["both", "along", "one", "about"]
        what = dice.of(*choices) if turns else "along"
        if what in ("both", "along"):
            keys["stiffness"] = short(stiff)
        if what == "one":
            axes = [axis for kind, axis in ways_of(self.elements.kinematics) if kind != "rotation"]
            keys["stiffness"] = {dice.of(*axes): short(stiff)}
        if what in ("both", "about"):
            keys["rotational_stiffness"] = short(stiff * self.length**2)
        if "stiffness" in keys and not firmly and dice.chance(40):
            keys["gap"] = short(1e-3 * self.length * dice.of(1, -1) * dice.logarithmic(1e-2, 1))
        self.spring.append(Spring(between=(one, other), **keys))

    def hold(self, on: str, flat: bool = True) -> bool:
        """A support of one of many kinds; whether it holds every rigid motion."""
        dice, size = self.dice, self.dimension
        kind = dice.of("clamp", "frame", "normal", "elastic", "foundation", "turned frame", "slide")
        stiff = short(self.modulus / self.length * dice.logarithmic(0.01, 10))
        if kind == "clamp":
            self.support.append(held(on, size))
        elif kind == "normal" and flat:
            amount = short(1e-3 * self.length * dice.of(0.0, dice.between(-1, 1)))
            self.support.append(Support(on, normal=amount, path=self.path()))
            return False
        elif kind == "foundation":
            self.support.append(Support(on, foundation_stiffness=stiff))
        elif kind == "elastic":
            total = short(stiff * self.length ** (size - 1))
            self.support.append(Support(on, stiffness=total))
        else:
            axes = self.frame(dice.between(-1, 1) if kind == "turned frame" else 0.0)
            names = axes.names(size)
            which = names if kind != "slide" else names[-1:]
            values = {name: short(1e-3 * self.length * dice.of(0.0, 0.5)) for name in which}
            self.support.append(Support(on, values, axes=axes, path=self.path()))
            return kind != "slide"
        return True

    def frame(self, angle: float) -> SupportAxes:
        """Turned as the bodies are, and by an angle more."""
        turned = Turned(getattr(self.shape, "angle", 0.0) + angle)
        if self.dimension == 2:
            return SupportAxes(x=turned.vector(1.0, 0.0))
        return SupportAxes(x=turned.vector(1.0, 0.0, 0.0), y=turned.vector(0.0, 1.0, 0.0))

    def rub(self) -> dict[str, Any]:
        """Friction, or none."""
        if self.dice.chance(25):
            return {}
        law = self.dice.of("static", "incremental")
        return {"friction_coefficient": self.dice.logarithmic(0.1, 0.8), "law": law}

    def press(self, on: str) -> None:
        """A pressure on a side, now and then."""
        if self.dice.chance(30):
            pressure = short(self.modulus * self.dice.logarithmic(1e-5, 1e-3))
            self.load.append(Load(on, pressure=pressure, path=self.path()))

    def scene(self, kind: str, parts: tuple[Box, ...], must: str, **more: Any) -> RandomScene:
        """All of it."""
        steps = self.dice.of(1, 1, 2, 3)
        names = ("coupling", "spring", "support", "contact", "load")
        keys = {name: tuple(getattr(self, name)) for name in names}
        return made(
            f"coupled: {kind}", self.elements, parts, self.shape, (), must,
            material=Material(self.modulus, self.poisson), steps=Steps(steps), **keys, **more,
        )  # fmt: skip


def _draft(dice: Dice, elements: Elements, shape: Any = None) -> _Draft:
    length = size_of(dice)
    if shape is None:
        turns = elements.kinematics != "axisymmetric" and dice.chance(35)
        shape = Turned(dice.between(-1.5, 1.5) if turns else 0.0)
    shape = dataclasses.replace(shape, length=length)
    modulus = dice.logarithmic(1e-3, 1e11) if dice.chance(20) else 1000.0
    return _Draft(dice, elements, shape, modulus, dice.of(0.0, 0.2, 0.3, 0.3, 0.45, 0.499))


def coupled(dice: Dice) -> RandomScene:
    """One of them."""
    return dice.of(_row, _row, _stack, _stack, _punch, _punch, _hub, _ring, _shared)(dice)


def _block(draft: _Draft, name: str, low: tuple[float, float], size: tuple[float, float]) -> Box:
    """A block from its corner in the plane; in space half as deep as it is wide."""
    dice, degree = draft.dice, draft.elements.degree
    most = (6 if degree == 1 else 4) if draft.dimension == 2 else (4 if degree == 1 else 2)
    counts = [max(2, round(most * side)) for side in size]
    if draft.dimension == 2:
        high = (low[0] + size[0], low[1] + size[1])
        return Box(name, low, high, (counts[0], counts[1]))
    start, end = (low[0], 0.0, low[1]), (low[0] + size[0], 0.5, low[1] + size[1])
    return Box(name, start, end, (counts[0], 2, counts[1] + dice.whole(0, 1)))


def _last(draft: _Draft) -> str:
    return AXES[draft.dimension - 1]


def _row(dice: Dice) -> RandomScene:
    """One to three blocks side by side, of which springs join the couplings."""
    draft = _draft(dice, dice.of(*_ELEMENTS))
    names, parts, stands = "abc"[: dice.whole(1, 3)], [], True
    for number, name in enumerate(names):
        parts.append(_block(draft, name, (2.0 * number, 0.0), (1.0, dice.between(0.4, 0.8))))
        foot, tip = (f"{name}.x{end}" for end in (0, 1))
        if dice.chance(60):
            stands &= draft.hold(foot)
        else:
            draft.couple(foot, f"{name}_foot")
            firmly = dice.chance(80)
            draft.join(f"{name}_foot", GROUND, firmly)
            stands &= firmly
        if dice.chance(85):
            draft.couple(tip, f"{name}_tip", kind=draft.kind())
        draft.press(f"{name}.{_last(draft)}1")
    labels = [one.label for one in draft.coupling]
    for one, other in itertools.pairwise(labels):
        if dice.chance(50):
            draft.join(one, other, firmly=False)
    return draft.scene("row", tuple(parts), "answered" if stands else "")


def _stack(dice: Dice) -> RandomScene:
    """A block on another one, pressed and pushed by its upper face."""
    draft = _draft(dice, dice.of(*_ELEMENTS, *AXIAL))
    axial, last = draft.elements.kinematics == "axisymmetric", _last(draft)
    start = dice.of(0.0, 0.4) if axial else 0.0
    inset = 0.0 if axial else dice.of(0.0, 0.15)
    parts = (
        _block(draft, "lower", (start, -0.6), (1.0, 0.6)),
        _block(draft, "upper", (start + inset, 0.0), (1.0 - 2 * inset, dice.between(0.4, 0.8))),
    )
    foot, top = f"lower.{last}0", f"upper.{last}1"
    friction = draft.rub()
    draft.contact.append(Contact(f"upper.{last}0", against=f"lower.{last}1", **friction))
    if dice.chance(70):
        stands = draft.hold(foot)
    else:
        stands = dice.chance(80)
        draft.couple(foot, "foot")
        draft.join("foot", GROUND, firmly=stands)
    draft.push(top, "head", friction)
    if dice.chance(50):
        draft.join("head", dice.of(GROUND, *[one.label for one in draft.coupling[:-1]]), False)
    if not axial:
        draft.press(f"lower.x{dice.of(0, 1)}")
    return draft.scene("stack", parts, "")


def _punch(dice: Dice) -> RandomScene:
    """A block whose upper face is a coupling, on a plane, a parabola or a foundation."""
    draft = _draft(dice, dice.of(*_ELEMENTS, *AXIAL))
    axial, last = draft.elements.kinematics == "axisymmetric", _last(draft)
    size = draft.dimension
    parts = [_block(draft, "body", (0.0, 0.0), (1.0, dice.between(0.5, 1.0)))]
    under = (0.0 if axial else 0.5, *(0.25,) * (size - 2), 0.0)
    shape = dice.of("plane", "parabola" if size == 2 and not axial else "paraboloid")
    keys = {} if shape == "plane" else {"radius": short(draft.length * dice.between(30, 150))}
    up = (0.0,) * (size - 1) + (1.0,)
    obstacle = Obstacle(shape, position=draft.shape.point(*under), normal=draft.vector(*up), **keys)
    friction = draft.rub()
    draft.contact.append(Contact(f"body.{last}0", obstacle=obstacle, **friction))
    symmetric = not draft.shape.angle and not axial and dice.chance(15)
    if symmetric:
        draft.couple(f"body.{last}1", "punch", (*(0.0,) * (size - 1), -abs(draft.force)))
    else:
        draft.push(f"body.{last}1", "punch", friction)
    if dice.chance(50):
        draft.join("punch", GROUND, firmly=False)
    if dice.chance(40):  # another block, whose coupling a spring joins to the punch
        parts.append(_block(draft, "beam", (2.0, 0.5), (1.0, 0.5)))
        draft.hold("beam.x1")
        draft.couple("beam.x0", "lever", kind=draft.kind())
        draft.join("punch", "lever", firmly=False)
    more = {"symmetry": ("body.x0",)} if symmetric else {}
    return draft.scene("punch", tuple(parts), "", **more)


def _ring_parts(dice: Dice, *radii: tuple[str, float, float]) -> tuple[Box, ...]:
    around = dice.whole(20, 28) if len(radii) > 1 else dice.whole(8, 12)
    return tuple(
        Box(name, (0.0, inner), (2 * pi, outer), (around, dice.whole(1, 2)))
        for name, inner, outer in radii
    )


def _around(dice: Dice, draft: _Draft, on: str) -> None:
    """Hold a circle by its normal, by cylindrical axes, or by springs along these."""
    kind = dice.of("normal", "around", "springs", "clamp")
    axes = SupportAxes(cylindrical=(0, 0, 1))
    if kind == "normal":
        draft.support.append(Support(on, normal=0.0))
    elif kind == "around":
        swell = short(1e-3 * draft.length * dice.of(0.0, dice.between(-1, 1)))
        draft.support.append(Support(on, {"radial": swell, "around": 0.0}, axes=axes))
    elif kind == "springs":
        stiff = short(draft.modulus / draft.length * dice.logarithmic(0.1, 10))
        springs = {"radial": stiff, "around": short(0.3 * stiff)}
        draft.support.append(Support(on, foundation_stiffness=springs, axes=axes))
    else:
        draft.support.append(held(on, 2))


def _hub(dice: Dice) -> RandomScene:
    """A hollow shaft in a hub, turned at its bore, which is a coupling."""
    draft = _draft(dice, dice.of(*_RINGS), Ring())
    parts = _ring_parts(dice, ("shaft", 0.4, 1.0), ("hub", 1.0, dice.between(1.4, 2.0)))
    overlap = short(1e-3 * draft.length)
    contact = Contact("shaft.y1", against="hub.y0", interference=overlap, **draft.rub())
    draft.contact.append(contact)
    _around(dice, draft, "hub.y1")
    draft.couple("shaft.y0", "bore", pushed=draft.vector(0.1 * draft.force, 0.0))
    if dice.chance(60):
        draft.join("bore", GROUND, firmly=dice.chance(50))
    return dataclasses.replace(draft.scene("hub", parts, ""), closed=("shaft", "hub"))


def _ring(dice: Dice) -> RandomScene:
    """A ring between a rigid bore and a circle that is held along its own axes."""
    draft = _draft(dice, dice.of(*_RINGS), Ring())
    parts = _ring_parts(dice, ("ring", 0.5, 1.2))
    _around(dice, draft, "ring.y1")
    draft.couple("ring.y0", "bore")
    if dice.chance(60):
        draft.join("bore", GROUND, firmly=dice.chance(50))
    return dataclasses.replace(draft.scene("ring", parts, ""), closed=("ring",))


def _shared(dice: Dice) -> RandomScene:
    """A coupling beside another one, a support or a contact, whose corner is theirs, too."""
    draft = _draft(dice, dice.of(*_ELEMENTS))
    parts, last = (_block(draft, "body", (0.0, 0.0), (1.0, 0.6)),), _last(draft)
    draft.couple(f"body.{last}1", "head")
    beside = dice.of("coupling", "support", "contact")
    if beside == "coupling":
        draft.couple("body.x1", "side")
        draft.hold(f"body.{last}0")
    elif beside == "support":
        draft.hold("body.x1")
    else:
        draft.hold(f"body.{last}0")
        wall = Obstacle(
            "plane",
            position=draft.shape.point(1.0, *(0.0,) * (draft.dimension - 1)),
            normal=draft.vector(-1.0, *(0.0,) * (draft.dimension - 1)),
        )
        draft.contact.append(Contact("body.x1", obstacle=wall, **draft.rub()))
    return draft.scene("shared", parts, "refused")
