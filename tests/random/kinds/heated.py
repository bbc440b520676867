"""Bodies with temperatures: free ones, rows between walls, stacks, fits, bolted plates and rings.

Temperatures are numbers, profiles and functions that are linear in space, over load paths; bodies
of several materials expand by one number or by one an axis, and contacts open or close by it.
"""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from fenics_contact import (
    Conductance,
    Contact,
    Coupling,
    Film,
    Heat,
    Load,
    Material,
    ModulusTable,
    Obstacle,
    Path,
    Preload,
    Profile,
    Spring,
    Steps,
    Support,
    Temperature,
)
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice, short
from tests.random.kinds.common import (
    AXES,
    AXIAL,
    PLANE,
    SPACE,
    Elements,
    Ring,
    Turned,
    held,
    made,
    size_of,
)
from tests.random.scenes import RandomScene

_TETRAHEDRA = Elements("3D", "tetrahedron", 2)
_ELEMENTS = (*PLANE, *PLANE, *SPACE, _TETRAHEDRA)
_RING = Elements("plane strain", "quadrilateral", 2, order=2)
_PATHS = (
    Path((0, 1), (0, 1)),
    Path((0, 0.5, 1), (0, 1, 0.6)),
    Path((0, 0.5, 1), (0, 1, -0.5)),
    Path((0,), (1,)),
)
_SPRINGS = 1e-12  # of E L^(d − 2): what holds bodies that expand freely


@dataclass(frozen=True)
class LinearField:
    """A temperature that is linear in space; other ranks are sent it.

    Attributes:
        base: At the origin (temperature).
        slope: Along each axis (temperature/length).
    """

    base: float
    slope: tuple[float, float, float]

    def __call__(self, x: Any) -> Any:
        return self.base + sum(slope * at for slope, at in zip(self.slope, x, strict=True))


@dataclass
class _Draft:
    """What the bodies of a scene share.

    Attributes:
        dice: What is thrown.
        elements: Kinematics, cells and degree.
        shape: Where the points of boxes go.
        modulus: Young's modulus of the first material (stress).
        strain: By which bodies expand, about.
        rise: Of the temperature, over the reference (temperature).
        reference: Of all materials (temperature).
    """

    dice: Dice
    elements: Elements
    shape: Any
    modulus: float
    strain: float
    rise: float
    reference: float

    @classmethod
    def drawn(cls, dice: Dice, elements: Elements, shape: Any = None) -> _Draft:
        if shape is None:
            turns = elements.kinematics != "axisymmetric" and dice.chance(30)
            shape = Turned(dice.between(-1.5, 1.5) if turns else 0.0)
        shape = dataclasses.replace(shape, length=size_of(dice))
        modulus = dice.logarithmic(1e-3, 1e11) if dice.chance(20) else 1000.0
        strain, rise = dice.logarithmic(1e-5, 2e-3), short(dice.logarithmic(1, 1000))
        return cls(dice, elements, shape, modulus, strain, rise, dice.of(0.0, 20.0, -50.0))

    @property
    def dimension(self) -> int:
        return self.elements.dimension

    @property
    def axial(self) -> bool:
        return self.elements.kinematics == "axisymmetric"

    @property
    def last(self) -> str:
        return AXES[self.dimension - 1]

    def vector(self, *components: float) -> tuple[float, ...]:
        """Turned as the bodies are."""
        turned = getattr(self.shape, "vector", lambda *same: same)
        return tuple(short(value) for value in turned(*components))

    def material(self, on: str = "", by_axis: bool = True) -> Material:
        """Of some stiffness and expansion, by one number or by one an axis."""
        dice = self.dice
        alpha = short(self.strain / self.rise * dice.of(1, 1, 2, 0.5, -1))
        expansion: Any = alpha
        if by_axis and dice.chance(25):
            expansion = tuple(short(alpha * dice.of(1, 0.5, 0, -1)) for _ in AXES)
        return Material(
            short(self.modulus * (dice.of(1, 0.3, 3) if on else 1)),
            dice.of(0.0, 0.2, 0.3, 0.3, 0.45, 0.499),
            on=on,
            thermal_expansion=expansion,
            reference_temperature=self.reference if dice.chance(80) else 0.0,
        )

    def materials(self, *names: str, by_axis: bool = True) -> tuple[Material, ...]:
        """One of all bodies, or one of each."""
        if len(names) > 1 and self.dice.chance(60):
            return tuple(self.material(name, by_axis) for name in names)
        return (self.material(by_axis=by_axis),)

    def temperature(self, on: str = "", linear: bool = True, sign: float = 0.0) -> Temperature:
        """A number, or where that is wanted a profile or a function."""
        dice, rise = self.dice, self.rise * (sign or self.dice.of(1, -1))
        hot = short(self.reference + rise)
        kind = dice.of("number", "number", "profile", "function") if linear else "number"
        value: Any = hot
        if kind == "profile":
            far, middle = 20 * self.shape.length, dice.chance(20)
            at = (-far, 0.3 * self.shape.length, far) if middle else (-far, far)
            ends = [short(hot + rise * dice.between(-5, 5)) for _ in at]
            axis = dice.of(*AXES[: self.dimension])
            value = Profile(along=axis, at=tuple(map(short, at)), values=tuple(ends))
        if kind == "function":
            slopes = [short(rise / self.shape.length * dice.between(-1, 1)) for _ in AXES]
            slopes[self.dimension :] = [0.0] * (3 - self.dimension)
            value = LinearField(hot, tuple(slopes))
        return Temperature(on, value=value, path=dice.of(_PATHS[0], *_PATHS))

    def some(self, *names: str, linear: bool = True) -> tuple[Temperature, ...]:
        """Of all bodies, or of some of them."""
        if self.dice.chance(30):
            return (self.temperature(linear=linear),)
        chosen = [name for name in names if self.dice.chance(60)] or [names[0]]
        return tuple(self.temperature(name, linear) for name in chosen)

    def rub(self) -> dict[str, Any]:
        """Friction, or none."""
        if self.dice.chance(25):
            return {}
        law = self.dice.of("static", "incremental")
        return {"friction_coefficient": self.dice.logarithmic(0.1, 0.8), "law": law}

    def block(self, name: str, low: tuple[float, float], size: tuple[float, float]) -> Box:
        """A block from its corner in the plane; in space half as deep as it is wide."""
        degree = self.elements.degree
        most = (6 if degree == 1 else 4) if self.dimension == 2 else (4 if degree == 1 else 2)
        counts = [max(2, round(most * side)) for side in size]
        if self.dimension == 2:
            return Box(name, low, (low[0] + size[0], low[1] + size[1]), tuple(counts))
        start, end = (low[0], 0.0, low[1]), (low[0] + size[0], 0.5, low[1] + size[1])
        return Box(name, start, end, (counts[0], 2, counts[1] + self.dice.whole(0, 1)))

    def hold(self, on: str) -> Support:
        """A clamp, or springs that hold every motion."""
        stiff = self.modulus / self.shape.length * self.dice.logarithmic(0.1, 10)
        if self.dice.chance(30):
            return Support(on, foundation_stiffness=short(stiff))
        return held(on, self.dimension)

    def scene(self, kind: str, parts: tuple[Box, ...], must: str = "", **keys: Any) -> RandomScene:
        """All of it."""
        keys.setdefault("steps", Steps(self.dice.of(1, 1, 2, 3)))
        return made(f"heated: {kind}", self.elements, parts, self.shape, (), must, **keys)


def heated(dice: Dice) -> RandomScene:
    """One of them."""
    return dice.of(_free, _free, _row, _row, _stack, _stack, _fit, _fit, _bolted, _ring)(dice)


def _free(dice: Dice) -> RandomScene:
    """A block that nothing keeps from expanding: no stress in the plane, and in space none."""
    draft = _Draft.drawn(dice, dice.of(*_ELEMENTS))
    linear = draft.elements.degree == 2 and dice.chance(60)
    sides = not linear and not draft.shape.angle
    parts = (draft.block("body", (0.0, 0.0), (1.0, dice.between(0.4, 0.8))),)
    material = draft.material(by_axis=sides)
    if sides:  # which may slide along themselves
        support = tuple(Support(f"body.{a}0", {a: 0.0}) for a in AXES[: draft.dimension])
    else:
        stiff = _SPRINGS * draft.modulus * draft.shape.length ** (draft.dimension - 2)
        support = (Support("body.x0", stiffness=stiff),)
    temperature = draft.temperature(linear=linear)
    found = draft.scene(
        "free", parts, "answered", material=material, support=support, temperature=(temperature,)
    )
    return dataclasses.replace(found, stress=_hottest(found) if sides or linear else None)


def _hottest(random: RandomScene) -> float | None:
    """E α ΔT of a body at its hottest; None of a temperature with a kink."""
    (material,), (given,) = random.scene.material, random.scene.temperature
    corners = np.array([random.parts[0].low, random.parts[0].high])
    places = np.zeros((2 ** len(corners[0]), 3))
    grid = np.stack(np.meshgrid(*corners.T, indexing="ij"), axis=-1)
    places[:, : corners.shape[1]] = random.shape(grid.reshape(-1, corners.shape[1]))
    value: Any = given.value
    if isinstance(value, Profile):
        if len(value.at) > 2:
            return None
        value = np.interp(places[:, AXES.index(value.along)], value.at, value.values)
    elif callable(value):
        value = value(places.T)
    alpha = np.abs(material.thermal_expansion).max()
    hottest = np.abs(np.subtract(value, material.reference_temperature)).max()
    return float(material.youngs_modulus * alpha * hottest)


def _row(dice: Dice) -> RandomScene:
    """One to three blocks between walls, glued, touching or a little apart."""
    draft = _Draft.drawn(dice, dice.of(*_ELEMENTS))
    names, parts, contacts, start = "abc"[: dice.whole(1, 3)], [], [], 0.0
    high = dice.between(0.4, 0.8)
    for name in names:
        parts.append(draft.block(name, (start, 0.0), (1.0, high)))
        start += 1.0
    apart = dice.of(0.0, 0.3) * draft.strain * draft.shape.length
    for one, other in itertools.pairwise(names):
        contact = dice.of({"contact": "bonded"}, {"interference": -short(apart), **draft.rub()})
        contacts.append(Contact(f"{one}.x1", against=f"{other}.x0", **contact))
    support = [draft.hold(f"{names[0]}.x0"), draft.hold(f"{names[-1]}.x1")]
    support += [draft.hold(f"{name}.{draft.last}0") for name in names[1:-1]]
    return draft.scene(
        "row", tuple(parts), material=draft.materials(*names), support=tuple(support),
        contact=tuple(contacts), temperature=draft.some(*names),
    )  # fmt: skip


def _stack(dice: Dice) -> RandomScene:
    """A block on another one or on a plane, pressed, which slips as one of them expands."""
    draft = _Draft.drawn(dice, dice.of(*_ELEMENTS, *AXIAL))
    last, start = draft.last, dice.of(0.0, 0.4) if draft.axial else 0.0
    upper = draft.block("upper", (start, 0.0), (1.0, dice.between(0.4, 0.8)))
    parts, rubs = [upper], draft.rub()
    if dice.chance(60):
        parts.insert(0, draft.block("lower", (start, -0.6), (1.0, 0.6)))
        contact = Contact(f"upper.{last}0", against=f"lower.{last}1", **rubs)
        support = (draft.hold(f"lower.{last}0"),)
    else:
        up = draft.vector(*(0.0,) * (draft.dimension - 1), 1.0)
        under = draft.shape.point(0.0 if draft.axial else start, *(0.0,) * (draft.dimension - 1))
        plane = Obstacle("plane", position=under, normal=up)
        contact, support = Contact(f"upper.{last}0", obstacle=plane, **rubs), ()
    pressure = short(draft.modulus * draft.strain * dice.between(0.2, 3))
    load = Load(f"upper.{last}1", pressure=pressure, path=dice.of(_PATHS[0], _PATHS[-1]))
    names = [part.name for part in parts]
    by_axis = not draft.axial or start > 0  # on the axis, radius and circle expand alike
    return draft.scene(
        "stack", tuple(parts), material=draft.materials(*names, by_axis=by_axis), support=support,
        contact=(contact,), load=(load,), temperature=draft.some(*names),
    )  # fmt: skip


def _fit(dice: Dice) -> RandomScene:
    """A shaft in a hub that is colder, or warmer, until it comes off."""
    draft = _Draft.drawn(dice, dice.of(*AXIAL))
    bore, longer = dice.of(0.0, 0.5), dice.of(0.0, 0.2)
    shaft = draft.block("shaft", (bore, 0.0), (1.0 - bore, 0.6 + longer))
    hub = draft.block("hub", (1.0, 0.0), (dice.between(0.5, 1.0), 0.6))
    tight = short(draft.strain * draft.shape.length * dice.of(0.0, 0.5, 1.5))
    support = [Support("shaft.y0", {"y": 0.0})]
    rubs = draft.rub()
    if not rubs or dice.chance(70):
        support.append(Support("hub.y0", {"y": 0.0}))
    contact = Contact("hub.x0", against="shaft.x1", interference=tight, **rubs)
    sign = dice.of(-1, -1, 1)
    return draft.scene(
        "fit", (shaft, hub), material=draft.materials("shaft", "hub", by_axis=False),
        support=tuple(support), contact=(contact,),
        temperature=(draft.temperature("hub", linear=dice.chance(30), sign=sign),),
    )  # fmt: skip


def _bolted(dice: Dice) -> RandomScene:
    """A bolt beside what it clamps, a spring between their heads: tightened, locked, warmed."""
    draft = _Draft.drawn(dice, dice.of(*PLANE, SPACE[0]), Turned())
    size, last = draft.dimension, draft.last
    bolt = draft.block("bolt", (0.0, 0.0), (0.4, 1.0))
    plate = draft.block("plate", (0.6, 0.0), (1.0, 1.0))
    length = draft.shape.length
    force = short(draft.modulus * draft.strain * 0.4 * length ** (size - 1) * dice.between(0.3, 2))
    axis = tuple(1 if a == last else 0 for a in AXES[:size])
    preload = Preload(
        "bolt", axis, force, path=Path((0, 1), (0, 1)), locked_from=dice.of(1.0, 1.0, None)
    )
    turns = {"z": 0.0} if size == 2 else dict.fromkeys(AXES, 0.0)
    sideways = dict.fromkeys(AXES[: size - 1], 0.0)
    heads = tuple(
        Coupling(f"{name}.{last}1", name=f"{name} head", displacement=sideways, rotation=turns)
        for name in ("bolt", "plate")
    )
    warm = tuple(
        dataclasses.replace(each, path=Path((1, 2), (0, 1))) for each in draft.some("bolt", "plate")
    )
    support = [held(f"{name}.{last}0", size) for name in ("bolt", "plate")]
    stiff = short(draft.modulus * length ** (size - 2) * dice.logarithmic(1, 100))
    return draft.scene(
        "bolted", (bolt, plate), "answered", material=draft.materials("bolt", "plate"),
        support=tuple(support), preload=(preload,), coupling=heads, temperature=warm,
        spring=(Spring(between=("bolt head", "plate head"), stiffness={last: stiff}),),
        steps=Steps(times=(1.0, 2.0)),
    )  # fmt: skip


def _ring(dice: Dice) -> RandomScene:
    """A ring in one that is colder, both held by springs."""
    draft = _Draft.drawn(dice, _RING, Ring())
    around = dice.whole(20, 28)
    parts = tuple(
        Box(name, (0.0, inner), (2 * pi, outer), (around, dice.whole(1, 2)))
        for name, inner, outer in (("shaft", 0.4, 1.0), ("hub", 1.0, dice.between(1.4, 2.0)))
    )
    springs = short(draft.modulus / draft.shape.length * dice.logarithmic(0.1, 10))
    contact = Contact(
        "shaft.y1",
        against="hub.y0",
        interference=short(2 * draft.strain * draft.shape.length),
        **draft.rub(),
    )
    found = draft.scene(
        "ring", parts, material=draft.materials("shaft", "hub"), contact=(contact,),
        support=(
            Support("hub.y1", foundation_stiffness=springs),
            Support("shaft.y0", foundation_stiffness=springs),
        ),
        temperature=(draft.temperature("hub", linear=False, sign=-1),),
    )  # fmt: skip
    return dataclasses.replace(found, closed=("shaft", "hub"))


def conducting(dice: Dice) -> RandomScene:
    """Bodies in touch whose temperatures conduction finds together with the pressures."""
    found = dice.of(_row, _row, _stack, _stack, _fit)(dice)
    scene, names = found.scene, [part.name for part in found.parts]
    reference = scene.material[0].reference_temperature
    strain = dice.logarithmic(1e-5, 2e-3)
    alpha = max(np.abs(one.thermal_expansion).max() for one in scene.material) or 1e-5
    rise, softens = short(strain / alpha), dice.chance(20)
    pressure = scene.material[0].youngs_modulus * strain
    contacts = tuple(
        contact
        if contact.against is None or dice.chance(10)
        else dataclasses.replace(contact, conductance=_conductance(dice, pressure))
        for contact in scene.contact
    )
    low, high = ("x0", "x1") if found.kind == "heated: row" else ("y0", "y1")
    if scene.dimension == 3 and low == "y0":
        low, high = "z0", "z1"
    heat = [_bound(dice, f"{names[0]}.{low}", reference, rise, is_datum=True)]
    heat += [_bound(dice, f"{name}.{high}", reference, rise, is_datum=True) for name in names[1:]]
    if dice.chance(30) and len(names) == 1:
        heat.append(_bound(dice, f"{names[0]}.{high}", reference, rise, is_datum=False))
    made = dataclasses.replace(
        scene,
        material=tuple(
            _that_conducts(dice, one, reference, rise if softens else 0.0) for one in scene.material
        ),
        contact=contacts,
        temperature=(),
        heat=tuple(heat),
    )
    kind = found.kind.replace("heated", "conducting")
    return dataclasses.replace(found, kind=kind, scene=made, must_be="", stress=None)


def _that_conducts(dice: Dice, one: Material, reference: float, soft: float) -> Material:
    """A material that conducts, and is softer by this rise of the temperature, if by any."""
    modulus: Any = one.youngs_modulus
    if soft:
        modulus = ModulusTable(
            (reference - abs(soft), reference + abs(soft)), (modulus, short(0.6 * modulus))
        )
    return dataclasses.replace(
        one,
        youngs_modulus=modulus,
        conductivity=short(dice.logarithmic(0.01, 100)),
        reference_temperature=reference,
    )


def _conductance(dice: Dice, pressure: float) -> Any:
    """A number, or one that grows with the pressure, or falls."""
    size = dice.logarithmic(0.01, 100)
    if dice.chance(30):
        return short(size)
    least = dice.of(0.0, 0.0, 0.1, 2.0)
    values = tuple(short(size * share) for share in (least, 0.6, 1.0))
    return Conductance((0.0, short(0.3 * pressure), short(2 * pressure)), values)


def _bound(dice: Dice, on: str, reference: float, rise: float, is_datum: bool) -> Heat:
    """A temperature or a film, which say how warm a body is, or a flux."""
    path, hot = dice.of(_PATHS[0], *_PATHS), short(reference + rise * dice.between(-1, 1))
    kind = dice.of("temperature", "temperature", "film") if is_datum else "flux"
    if kind == "temperature":
        return Heat(on, temperature=hot, path=path)
    if kind == "film":
        film = Film(coefficient=short(dice.logarithmic(0.01, 10)), temperature=hot)
        return Heat(on, film=film, path=path)
    return Heat(on, flux=short(rise * dice.logarithmic(0.01, 10)), path=path)
