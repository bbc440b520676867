"""Scenes at random, small enough to be solved in about a second: hypothesis draws them.

Of each dimension, shape, mesh, load, friction, obstacle and solver. A few have no equilibrium,
or ask for what there is not. ``draw(seed, number)`` gives the same scene again and again with the
same version of hypothesis, whatever was drawn before.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import hypothesis
import numpy as np
from hypothesis import strategies as st
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact import Body, Discretisation, Scene, SolverSettings, Steps
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.verification.boxes import Box, boxes
from tests.random.bodies import parts_of, shape_of
from tests.random.contacts import KINDS, Frame, frictionless_pressed
from tests.random.dice import Dice

PLANE = ("plane strain", "plane stress", "axisymmetric")
CELLS = {2: ("quadrilateral", "triangle"), 3: ("hexahedron", "tetrahedron")}
# Cell, degree and order of cells where few forms are wanted.
_FEW = {
    "plane strain": (("quadrilateral", 2, 1), ("triangle", 1, 1)),
    "plane stress": (("quadrilateral", 1, 1), ("triangle", 2, 2)),
    "axisymmetric": (("quadrilateral", 2, 1), ("triangle", 1, 1)),
    "3D": (("hexahedron", 1, 1), ("tetrahedron", 1, 1), ("hexahedron", 2, 2)),
}
# From .49 on with a mean stress of its own.
_POISSON = (0.0, 0.2, 0.3, 0.3, 0.45, 0.499, 0.49, 0.4999)
_SHARES = (
    *["pressed"] * 11,
    *["prescribed"] * 7,
    *["foundation"] * 2,
    *["floor"] * 3,
    *["pair"] * 4,
    "glued",
    *["impossible"] * 2,
)


@dataclass(frozen=True)
class RandomScene:
    """A scene and how its body is made.

    Attributes:
        scene: Without its mesh.
        parts: Boxes of cells.
        cell: Shape of these.
        order: Of their geometry.
        shape: What is made of the boxes: a map of points, (points, axes) to (points, axes).
        kind: Of scene, in a word.
        known: What statics or a formula say of the answer.
        must_be: ``answered`` or ``refused``, where statics say so; ``seen`` where the cells may be
            too coarse for an answer (exit code 4), but not for a message.
        twin: Another scene with the same answer.
        polygon: Boxes of coarser cells, of which those of these boxes are pieces.
        closed: Names of boxes that the map closes to rings.
        welded: Names of boxes that are one body.
        stress: E α ΔT of a body that expands freely, beside which its stresses are round-off.
    """

    scene: Scene
    parts: tuple[Box, ...]
    cell: str
    order: int
    shape: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    kind: str
    known: tuple[Known, ...] = ()
    must_be: str = ""
    twin: Twin | None = None
    polygon: tuple[Box, ...] = ()
    closed: tuple[str, ...] = ()
    welded: tuple[tuple[str, ...], ...] = ()
    stress: float | None = None

    def body(self, comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
        """Its mesh, with the sides of each box named ``box.x0``, ``box.x1``, …; collective."""
        joined = {"welded": self.welded, "closed": self.closed}
        made = boxes(self.parts, self.cell, comm, self.order, **joined)
        places, dimension = made.mesh.geometry.x, self.scene.dimension
        found = self.shape(places[:, :dimension])
        for part in self.polygon:
            mine = _nodes(made, made.groups[part.name].tags[0])
            found[mine] = between_corners(self.shape, part, places[mine, :dimension])
        places[:, :dimension] = found
        return made

    def refined(self) -> RandomScene:
        """The same with cells of half the size; flat ones stay where they are."""
        finer = tuple(
            dataclasses.replace(part, cells=tuple(2 * count for count in part.cells))
            for part in self.parts
        )
        polygon = (self.polygon or self.parts) if self.order == 1 else ()
        return dataclasses.replace(self, parts=finer, polygon=polygon)


def _nodes(body: Body, tag: int) -> NDArray[np.int32]:
    """Points of the geometry of all cells of a part, on this rank."""
    cells = body.cell_tags.find(tag)
    return np.unique(compat.geometry_nodes(body.mesh)[cells])


def between_corners(shape, part: Box, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where points of a box go if only the corners of its cells go where the shape says.

    Args:
        shape: Map of points.
        part: The box.
        points: Of the box, (points, axes).

    Returns:
        Linear between the corners, along each axis.
    """
    low, size = np.array(part.low), np.subtract(part.high, part.low)
    counts = np.array(part.cells)
    share = (points - low) / size * counts
    first = np.clip(np.floor(share + 1e-9).astype(int), 0, counts - 1)
    found = np.zeros_like(points)
    for corner in np.ndindex(*(2,) * len(counts)):
        weight = np.prod(np.where(corner, share - first, 1 - (share - first)), axis=1)
        found += weight[:, None] * shape(low + (first + corner) / counts * size)
    return found


@dataclass(frozen=True)
class Known:
    """A quantity that statics or a formula give.

    Attributes:
        name: As in ``random_rows``: ``quantity``, or ``contact.quantity`` of one of several.
        value: Vectors in the mesh's axes.
        size: What an error is compared with, if larger than the value.
    """

    name: str
    value: float | tuple[float, ...]
    size: float = 0.0


@dataclass(frozen=True)
class Twin:
    """Another scene with the same answer, but for factors.

    Attributes:
        scene: The other one.
        factors: Quantity → its value here over that of the other scene.
        exact: Whether the other answer is that of ``variational_inequality``.
    """

    scene: RandomScene
    factors: Mapping[str, float]
    exact: bool = False


@st.composite
def scenes(draw, dimension: int, few_forms: bool = False, frictionless: bool = False):
    """Strategy of ``RandomScene``.

    Args:
        dimension: 2 or 3.
        few_forms: With few kinds of forms, for each is compiled for some seconds.
        frictionless: Pressed by a driven plane or parabola, without friction, a flat top.
    """
    return thrown(Dice(draw), dimension, few_forms, frictionless)


def thrown(
    dice: Dice, dimension: int, few_forms: bool = False, frictionless: bool = False
) -> RandomScene:
    """As ``scenes``, with any dice."""
    kind = "pressed" if frictionless else dice.of(*_SHARES)
    kinematics = "3D" if dimension == 3 else dice.of(*PLANE)
    if few_forms:
        cell, degree, order = dice.of(*_FEW[kinematics])
    else:
        cell, degree = dice.of(*CELLS[dimension]), dice.whole(1, 2)
        order = 2 if degree == 2 and dice.chance(35) else 1
    if frictionless:
        order = 1
        # Rules of integration differ on triangles around an axis, where nothing is polynomial.
        cell = "quadrilateral" if kinematics == "axisymmetric" else cell
        degree = 1 if cell == "tetrahedron" else degree  # whose points of contact are nodes
    parts = parts_of(dice, dimension, degree, kind == "pair", kinematics == "axisymmetric")
    shape = shape_of(dice, parts, order, kinematics, kind, frictionless)
    frame = Frame(
        kinematics,
        shape,
        modulus=dice.logarithmic(1e-6, 1e12) if dice.chance(40) else 1000.0,
        poisson=dice.of(*(_POISSON[:5] if frictionless else _POISSON)),
    )
    # With much friction all sticks, so that is rarer; around an axis nothing is dragged along.
    most = 0.5 if dice.chance(80 if frame.axial else 60) else 10.0
    coefficient = 0.0 if frictionless or dice.chance(6) else dice.logarithmic(0.03, most)
    make = frictionless_pressed if frictionless else KINDS[kind]
    scene = make(dice, frame, coefficient)
    scene = dataclasses.replace(
        scene,
        discretisation=Discretisation(degree),
        solver=_solver(dice, frame, _is_loose(scene)),
        steps=_steps(dice, scene, few_forms),
    )
    return RandomScene(scene, parts, cell, order, shape, kind)


def draw(seed: int, number: int, **choices: bool) -> RandomScene:
    """The scene of a number; two in five are in space.

    Args:
        seed: Of all.
        number: Of this one.
        choices: Of ``scenes``.
    """
    found: list[RandomScene] = []
    dimension = 3 if number % 5 in (1, 3) else 2

    # The first example is always the simplest one.
    @hypothesis.seed(1_000_003 * seed + number)
    @hypothesis.settings(
        max_examples=2,
        database=None,
        deadline=None,
        phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    @hypothesis.given(scenes(dimension, **choices))
    def collect(scene: RandomScene) -> None:
        found.append(scene)

    collect()
    return found[-1]


def _steps(dice: Dice, scene: Scene, few_forms: bool) -> Steps:
    """One to four; now and then as many as it takes."""
    number = dice.of(1, 2, 3, 4)
    return Steps(number=number, automatic=number > 1 and dice.chance(10))


def _is_loose(scene: Scene) -> bool:
    """Whether a force drives a body or an obstacle that only contact holds."""
    obstacles = [contact.obstacle for contact in scene.contact]
    return bool(scene.load) or any(o is not None and o.force is not None for o in obstacles)


def _solver(dice: Dice, frame: Frame, loose: bool) -> SolverSettings:
    """Mostly the automatic one; the paper's passes hold nothing that is loose."""
    solvers = ["auto", "auto", "auto", "condensed", "full"]
    if frame.dimension == 3 and frame.poisson < 0.49:
        solvers.append("iterative")
    return SolverSettings(
        solver=dice.of(*solvers),
        strategy=dice.of(*["auto"] * 9, "auto" if loose else "campos", "lagged", "monolithic"),
    )
