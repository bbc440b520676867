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


def growing(start: float, end: float, first: float, cells: int) -> list[float]:
    """Places from start to end, of cells whose lengths grow by a constant ratio from the first."""
    low, high = 1.0 + 1e-12, 10.0
    for _ in range(200):
        ratio = (low + high) / 2
        too_long = first * (ratio**cells - 1) / (ratio - 1) > end - start
        low, high = (low, ratio) if too_long else (ratio, high)
    places = [start + first * (ratio**number - 1) / (ratio - 1) for number in range(cells)]
    return [*places, end]


Problem = Indentation

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
)


def problem_named(name: str) -> Problem:
    """One of ``PROBLEMS``."""
    (found,) = (problem for problem in PROBLEMS if problem.name == name)
    return found
