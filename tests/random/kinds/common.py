"""What the kinds of scenes share: elements, materials, maps of points, bodies of boxes."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact import Discretisation, Material, Point, Scene, Support
from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice
from tests.random.scenes import Known, RandomScene, Twin

Array = NDArray[np.float64]
AXES = "xyz"


@dataclass(frozen=True)
class Elements:
    """Of which forms are compiled; each new one takes some seconds."""

    kinematics: str
    cell: str
    degree: int
    order: int = 1

    @property
    def dimension(self) -> int:
        return 3 if self.kinematics == "3D" else 2


PLANE = (
    Elements("plane strain", "quadrilateral", 2),
    Elements("plane strain", "triangle", 1),
    Elements("plane strain", "triangle", 2),
    Elements("plane stress", "quadrilateral", 1),
)
SPACE = (Elements("3D", "hexahedron", 1), Elements("3D", "tetrahedron", 1))
AXIAL = (
    Elements("axisymmetric", "quadrilateral", 2),
    Elements("axisymmetric", "triangle", 1),
)


@dataclass(frozen=True)
class Turned:
    """Points of boxes turned in the plane of the first and the last axis, then scaled.

    Attributes:
        angle: From the first towards the last axis (radian).
        length: Scale.
    """

    angle: float = 0.0
    length: float = 1.0

    def __call__(self, points: Array) -> Array:
        return self.length * points @ self._matrix(points.shape[1]).T

    def vector(self, *components: float) -> tuple[float, ...]:
        """The vector in the mesh's axes; its length stays."""
        return tuple((self._matrix(len(components)) @ components).tolist())

    def point(self, *coordinates: float) -> tuple[float, ...]:
        """Where a point of the boxes goes."""
        return tuple(self(np.array([coordinates]))[0].tolist())

    def _matrix(self, dimension: int) -> Array:
        matrix = np.eye(dimension)
        cosine, sine = np.cos(self.angle), np.sin(self.angle)
        matrix[np.ix_([0, -1], [0, -1])] = [[cosine, -sine], [sine, cosine]]
        return matrix


@dataclass(frozen=True)
class Ring:
    """Boxes of angles (from the vertical) and radii as pieces of a ring; a third axis stays.

    Attributes:
        length: Scale.
    """

    length: float = 1.0

    def __call__(self, points: Array) -> Array:
        angle, radius, *others = points.T
        places = [radius * np.sin(angle), radius * np.cos(angle), *others]
        return self.length * np.stack(places, axis=1)


def size_of(dice: Dice) -> float:
    """Scale of lengths: mostly 1."""
    return dice.logarithmic(1e-3, 1e3) if dice.chance(25) else 1.0


def modulus_of(dice: Dice) -> float:
    """Young's modulus, mostly 1000."""
    return dice.logarithmic(1e-3, 1e11) if dice.chance(25) else 1000.0


def material_of(dice: Dice, **keys: Any) -> Material:
    """Isotropic, now and then nearly incompressible."""
    return Material(modulus_of(dice), dice.of(0.0, 0.2, *[0.3] * 8, 0.45, 0.499), **keys)


def friction_of(dice: Dice, low: float = 0.05, high: float = 0.8) -> dict[str, Any]:
    """Coulomb friction of either law; now and then none."""
    if dice.chance(10):
        return {}
    law = dice.of("static", "static", "incremental")
    return {"friction_coefficient": dice.logarithmic(low, high), "law": law}


def held(side: str, dimension: int) -> Support:
    """Clamped."""
    return Support(side, dict.fromkeys(AXES[:dimension], 0.0))


def cells_of(dice: Dice, elements: Elements, *spans: float) -> tuple[int, ...]:
    """Of a box of these side lengths, about as many as are solved in a second."""
    most = (26 if elements.degree == 1 else 14) if elements.dimension == 2 else 8
    fine = dice.between(0.5, 1.0) * most / max(spans)
    return tuple(max(2, round(fine * span)) for span in spans)


def made(
    kind: str,
    elements: Elements,
    parts: tuple[Box, ...],
    shape: Callable[[Array], Array] = Turned(),
    known: tuple[Known, ...] = (),
    must_be: str = "",
    twin: Twin | None = None,
    closed: tuple[str, ...] = (),
    **scene: Any,
) -> RandomScene:
    """A scene of boxes.

    Args:
        kind: In a word.
        elements: Kinematics, cells and degree.
        parts: Boxes of cells.
        shape: Where their points go.
        known: What is known of the answer.
        must_be: ``answered``, ``refused``, ``seen`` or nothing.
        twin: Another scene with the same answer.
        closed: Names of boxes that the map closes to rings.
        scene: Keys of the scene.
    """
    found = Scene(
        kinematics=elements.kinematics, discretisation=Discretisation(elements.degree), **scene
    )
    return RandomScene(
        found, parts, elements.cell, elements.order, shape, kind, known, must_be, twin, (), closed
    )


def completed(dice: Dice, random: RandomScene) -> RandomScene:
    """With a solver, mostly the automatic one, and now and then a point whose way is asked for."""
    last = "condensed" if random.scene.heat else "full"
    solvers = ["auto", "auto", "auto", "condensed", last]
    settings = dataclasses.replace(
        random.scene.solver,
        solver=dice.of(*solvers),
        strategy=dice.of(*["auto"] * 8, "lagged", "monolithic"),
    )
    points = (_inside(random),) if dice.chance(40) else ()
    scene = dataclasses.replace(random.scene, solver=settings, point=points)
    return dataclasses.replace(random, scene=scene)


def _inside(random: RandomScene) -> Point:
    """The middle of the first box."""
    middle = np.add(random.parts[0].low, random.parts[0].high) / 2
    return Point("inside", tuple(random.shape(middle[None])[0].tolist()))
