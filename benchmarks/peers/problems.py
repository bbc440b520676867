"""The problems that all programs solve, as plain numbers; read in each program's own Python.

Only the standard library is imported here: the Python of a peer need not have more.
"""

from __future__ import annotations

import dataclasses

# A family's meshes, coarse to fine: cells of 1/2^level at the contact.
LEVELS = (1, 2, 3, 4)


@dataclasses.dataclass(frozen=True)
class Compared:
    """What all problems have.

    Attributes:
        name: In rows and file names.
        title: On the page.
        references: By quantity, of the whole body where a half or a quarter is modelled.
        source: Where the references come from.
    """

    name: str
    title: str
    references: dict[str, float]
    source: str


@dataclasses.dataclass(frozen=True)
class Indentation(Compared):
    """A rigid paraboloid pressed into a cylinder that is held at its side and its bottom.

    Axisymmetric: x is the radius, the body lies below y = 0. Lengths and stresses in any units.

    Attributes:
        friction: Coefficient of Coulomb's law; 0 without.
        steps: Equal load steps to the whole indentation.
    """

    friction: float
    steps: int
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
        return graded(self.fine, self.extent, self.size(level), self.cells_outside(level))


@dataclasses.dataclass(frozen=True)
class Slab(Compared):
    """A slab in plane stress, pressed by a given pressure on a rough ceiling and pushed sideways.

    Its corner is the origin; it stands on a smooth floor, and a smooth wall at x = 0. Example 1 of
    Campos, Oden and Kikuchi (1982).
    """

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


@dataclasses.dataclass(frozen=True)
class HalfSpace(Compared):
    """A rigid paraboloid pressed on a half-space by a force, without friction."""

    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    radius: float = 8.0  # of curvature of the paraboloid
    contact_radius: float = 2.8  # by Hertz's formula
    width: float = 4.0  # beyond which nothing touches
    levels: tuple[int, ...] = LEVELS

    @property
    def modulus(self) -> float:
        """E/(1 − ν²)."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)

    @property
    def force(self) -> float:
        """By which it is pressed."""
        return 4 * self.modulus * self.contact_radius**3 / (3 * self.radius)

    def size(self, level: int) -> float:
        """Of cells at the contact."""
        return 0.5**level


@dataclasses.dataclass(frozen=True)
class Block(Compared):
    """A rigid paraboloid pressed into a block that is held at its sides and its bottom, in 3D.

    A quarter: planes of symmetry at x = 0 and y = 0; the body lies below z = 0.

    Attributes:
        friction: Coefficient of Coulomb's law; 0 without.
        steps: Equal load steps to the whole indentation.
    """

    friction: float
    steps: int
    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    radius: float = 8.0  # of curvature of the paraboloid
    indentation: float = 1.0
    extent: float = 10.0  # of the quarter, along each axis
    fine: float = 4.0  # cube of uniform cells at the contact
    levels: tuple[int, ...] = (4, 6, 8)

    def size(self, level: int) -> float:
        """Of cells at the contact; the level is how many there are along the fine cube."""
        return self.fine / level

    def lines(self, level: int) -> list[float]:
        """Of the mesh, along all axes alike."""
        return graded(self.fine, self.extent, self.size(level), round(0.75 * level))


@dataclasses.dataclass(frozen=True)
class Pair(Compared):
    """A round body pressed onto a flat one, without friction; plane strain, half of it.

    A plane of symmetry at x = 0. The lower body lies below y = 0 and is held at its side and its
    bottom; the upper one lies above y = x²/(2 R), and its top is pushed down. The upper one has
    more cells along the contact, so that their meshes do not match.
    """

    youngs_modulus: float = 1000.0
    poissons_ratio: float = 0.3
    # So flat that it does not matter along which of both normals a gap is measured.
    radius: float = 200.0
    pushed: float = 0.012
    extent: float = 10.0  # of the lower body
    width: float = 4.0  # of the upper one, and of the uniform cells of the lower one
    height: float = 5.0  # of the upper one
    levels: tuple[int, ...] = LEVELS

    def size(self, level: int) -> float:
        """Of the lower body's cells at the contact."""
        return 0.5**level

    def lines(self, level: int) -> list[float]:
        """Of the lower mesh, along x and downwards alike."""
        size = self.size(level)
        return graded(self.width, self.extent, size, round(2.4 / size))

    def upper_cells(self, level: int) -> tuple[int, int]:
        """Along x and y: four where the lower body has three."""
        size = 0.75 * self.size(level)
        return -round(-self.width / size // 1), -round(-self.height / size // 1)

    def upper_place(self, along: float, up: float) -> tuple[float, float]:
        """Of a point of the upper body, by shares of its width and height."""
        x = along * self.width
        low = x**2 / (2 * self.radius)
        return x, low + up * (self.height - low)


def graded(fine: float, end: float, size: float, outside: int) -> list[float]:
    """Places from 0 to the end, of equal cells as far as they are fine, and of others that grow."""
    near = [size * number for number in range(round(fine / size))]
    return near + growing(fine, end, size, outside)


def growing(start: float, end: float, first: float, cells: int) -> list[float]:
    """Places from start to end, of cells whose lengths grow by a constant ratio from the first."""
    low, high = 1.0 + 1e-12, 10.0
    for _ in range(200):
        ratio = (low + high) / 2
        too_long = first * (ratio**cells - 1) / (ratio - 1) > end - start
        low, high = (low, ratio) if too_long else (ratio, high)
    places = [start + first * (ratio**number - 1) / (ratio - 1) for number in range(cells)]
    return [*places, end]


Problem = Indentation | HalfSpace | Block | Pair | Slab

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
    HalfSpace(
        "half-space",
        "Paraboloid on a half-space",
        references={"peak pressure": 244.8537586, "contact radius": 2.8},
        source="Hertz's formulas, 2 E a/(π (1 − ν²) R) and a",
    ),
    Block(
        "block",
        "Paraboloid on a block in 3D",
        friction=0.0,
        steps=1,
        references={"force": 5626.4, "peak pressure": 276.42},
        source="fenics_contact with 12, 16 and 20 cells along the fine cube, up to 1,074,000 "
        "unknowns (forces 5626.0, 5626.1 and 5626.5; peaks 276.78, 276.62 and 276.55, which fall "
        "with the square of the cells' size)",
    ),
    Block(
        "rough block",
        "Paraboloid on a block in 3D, ten steps of Coulomb friction",
        friction=0.6,
        steps=10,
        references={"force": 5729.0, "peak pressure": 298.7},
        source="fenics_contact with 12 and 16 cells along the fine cube (forces 5732.1 and 5730.2, "
        "peaks 299.04 and 298.89), carried on: the force to about 4e-4, so that smaller errors of "
        "it say nothing",
    ),
    Pair(
        "pair",
        "Round body on a flat one",
        references={"force": 4.4811, "peak pressure": 2.0188, "half-width": 1.4154},
        source="fenics_contact with cells of 1/16 and 1/32 (forces 4.48106 and 4.48117, peaks "
        "2.01894 and 2.01881, half-widths 1.41556 and 1.41533); forces of GetFEM and NGSolve with "
        "1/8 are .007 % above and .012 % below it",
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
