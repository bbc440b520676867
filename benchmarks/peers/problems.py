"""The problems that all programs solve, as plain numbers; read in each program's own Python.

Only the standard library is imported here: the Python of a peer need not have more.
"""

from __future__ import annotations

import dataclasses

# A family's meshes, coarse to fine: cells of 1/2^level at the contact.
LEVELS = (1, 2, 3, 4)


@dataclasses.dataclass(frozen=True)
class Indentation:
    """A rigid paraboloid pressed into a cylinder that is held at its side and its bottom.

    Axisymmetric: x is the radius, the body lies below y = 0. Lengths and stresses in any units.

    Attributes:
        name: In rows and file names.
        title: On the page.
        friction: Coefficient of Coulomb's law; 0 without.
        steps: Equal load steps to the whole indentation.
        references: By quantity.
        source: Where the references come from.
    """

    name: str
    title: str
    friction: float
    steps: int
    references: dict[str, float]
    source: str
    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    radius: float = 8.0  # of curvature of the paraboloid
    indentation: float = 1.0
    extent: float = 60.0  # radius and height of the cylinder
    fine: float = 4.0  # square of uniform cells at the contact
    levels: tuple[int, ...] = LEVELS

    def size(self, level: int) -> float:
        """Of cells at the contact."""
        return 0.5**level

    def cells_outside(self, level: int) -> int:
        """From the fine square to the boundary; they grow by a constant ratio."""
        return round(2.4 / self.size(level))

    def lines(self, level: int) -> list[float]:
        """Of the mesh, along the radius and downwards alike."""
        size = self.size(level)
        near = [size * number for number in range(round(self.fine / size))]
        return near + growing(self.fine, self.extent, size, self.cells_outside(level))


@dataclasses.dataclass(frozen=True)
class Slab:
    """A slab in plane stress, pressed by a given pressure on a rough ceiling and pushed sideways.

    Its corner is the origin; it stands on a smooth floor, and a smooth wall at x = 0. Example 1 of
    Campos, Oden and Kikuchi (1982).

    Attributes:
        name: In rows and file names.
        title: On the page.
        references: By quantity.
        source: Where the references come from.
    """

    name: str
    title: str
    references: dict[str, float]
    source: str
    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    length: float = 8.0
    height: float = 1.0
    pressure: float = 300.0  # of the ceiling, and of what pushes at the right end
    friction: float = 0.3
    levels: tuple[int, ...] = (2, 3, 4, 5)

    def size(self, level: int) -> float:
        """Of all cells."""
        return 0.5**level

    def lines(self, level: int) -> tuple[list[float], list[float]]:
        """Of the mesh, along the slab and upwards."""
        size = self.size(level)
        along, up = round(self.length / size), round(self.height / size)
        return [size * n for n in range(along + 1)], [size * n for n in range(up + 1)]


def growing(start: float, end: float, first: float, cells: int) -> list[float]:
    """Places from start to end, of cells whose lengths grow by a constant ratio from the first."""
    low, high = 1.0 + 1e-12, 10.0
    for _ in range(200):
        ratio = (low + high) / 2
        too_long = first * (ratio**cells - 1) / (ratio - 1) > end - start
        low, high = (low, ratio) if too_long else (ratio, high)
    places = [start + first * (ratio**number - 1) / (ratio - 1) for number in range(cells)]
    return [*places, end]


Problem = Indentation | Slab

PROBLEMS: tuple[Problem, ...] = (
    Indentation(
        "indentation",
        "Paraboloid, without friction",
        friction=0.0,
        steps=1,
        references={"force": 4337.26, "peak pressure": 251.125, "contact radius": 2.8717},
        source="force: fenics_contact with cells of 1/32 and GetFEM with 1/16 (4337.26, 4337.13); "
        "peak pressure and contact radius: Hertz's formulas at this force, since what holds the "
        "cylinder from afar only changes the depth",
    ),
    Indentation(
        "friction",
        "Paraboloid, ten steps of Coulomb friction",
        friction=0.6,
        steps=10,
        references={
            "force": 4413.41,
            "peak pressure": 272.846,
            "contact radius": 2.836,
            "stick radius": 2.712,
        },
        source="fenics_contact with cells of 1/32 and 1/48 (forces 4413.42, 4413.38); GetFEM with "
        "1/8 is .02 % and .05 % above its force and peak pressure, NGSolve .04 % and .1 % below "
        "with the stiffer penalty. The radii are of fenics_contact alone: the others tell them to "
        "half a cell",
    ),
    Slab(
        "slab",
        "Slab with given pressure",
        references={"friction force": 209.9751, "strain energy": 352.713, "stick length": 6.404},
        source="as in [error against time](benchmarks.md#error-against-time)",
    ),
)


def problem_named(name: str) -> Problem:
    """One of ``PROBLEMS``."""
    (found,) = (problem for problem in PROBLEMS if problem.name == name)
    return found
