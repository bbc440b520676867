"""Windows about an answer, in which derivatives are averaged, and the answers in them.

A window is as wide as a cell at the edges of contact and of stick. The kernel of the mean is the
convolution of two boxes. Where both edges move, each box is as wide as what moves one of them by a
cell; else both are of the one that moves. What repeats from cell to cell cancels. Where slopes
change along the window by more than in proportion, their mean is off by h²/12 times their second
derivative, h being half its width: so a parabola is fitted to them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.contact_areas import areas_inside, cut_areas
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.quick_answers import QuickAnswers
from fenics_contact.simulation.sweeps.rows import row_of_quick
from fenics_contact.solve.systems.solution import Solution


@dataclass(frozen=True, eq=False)
class WindowAnswer:
    """An answer somewhere in a window.

    Attributes:
        values: Quantities by the names that they are asked for, None where there is none.
        inside: Of each edge, the area of this rank's pieces that lies inside of it.
        strips: Of each edge, the area of the cells that it passes through.
    """

    values: Mapping[str, float | None]
    inside: Sequence[Array]
    strips: Sequence[float]


class WindowAnswers:
    """Quick answers on one body, each solved once; collective.

    Every contact has two edges, that of contact and that of stick.

    Args:
        kept: The body.
        scene: The scene whose numbers change.
    """

    def __init__(self, kept: KeptBody, scene: Scene) -> None:
        self.scene = scene
        self._quick = QuickAnswers(kept)
        self._comm = kept.discrete.spaces.comm
        self._known: dict[tuple[str, float], WindowAnswer | None] = {}

    def at(self, key: str, value: float) -> WindowAnswer | None:
        """The answer with another number; None where the scene has none with it; collective."""
        if (key, value) not in self._known:
            try:
                scene = with_changes(self.scene, {key: value})
                self._known[key, value] = self.of(scene)
            except InputError:  # beyond what the key can be, or what supports and friction hold
                self._known[key, value] = None
        return self._known[key, value]

    def of(self, scene: Scene) -> WindowAnswer | None:
        """The answer of a scene on the same body, None where there is none; collective."""
        inside: list[Array] = []
        strips: list[float] = []

        def watch(problem: Problem, solution: Solution) -> None:
            for contact, state in zip(problem.contacts, solution.states, strict=True):
                inside.extend(areas_inside(contact, state))
                degree = problem.spaces.degree  # pieces end at nodes
                strips.extend(degree * area for area in cut_areas(contact, state))

        answer = self._quick.answer(scene, follow=False, checks=False, watch=watch)
        if not answer.converged:
            return None
        names = [contact.label for contact in scene.contact]
        return WindowAnswer(row_of_quick(answer, names), inside, strips)

    def moved(self, one: WindowAnswer, other: WindowAnswer, strips: Sequence[float]) -> Array:
        """Return by how many cells each edge has moved between two answers; collective.

        Args:
            one: An answer.
            other: The other one.
            strips: Of the answer in the middle.
        """
        pairs = zip(one.inside, other.inside, strict=True)
        areas = total(self._comm, np.array([float(np.abs(a - b).sum()) for a, b in pairs]))
        widths = np.asarray(strips)
        return np.asarray(np.where(widths > 0, areas / np.where(widths > 0, widths, 1.0), 0.0))


# Intervals between the answers of a window; and where an area jumps inside of them.
INTERVALS, INTERVALS_OF_AREAS = 8, 16
# Half of a window at most, over the size of the number.
_WIDEST = 0.25
# Where no edge moves, over the same.
_STILL = 0.01
# The first look is so wide, over the same; and so many looks find how fast the edges move.
_FIRST, _LOOKS = 0.02, 12
# Cells that the faster edge is to move by, in a look that tells how fast.
_FEWEST, _MOST = 0.7, 3.0

# Cells that an edge moves by in the widest window, from which it moves at all.
_MOVES = 0.05

# Answer at a place, None where there is none; collective.
Answers = Callable[[float], WindowAnswer | None]
# Cells that each edge moves between two answers; collective.
Moved = Callable[[WindowAnswer, WindowAnswer], Array]


@dataclass(frozen=True)
class Window:
    """Where answers are asked for, and what of the mean is of each interval between them.

    Attributes:
        places: Increasing, the number itself in the middle, (intervals + 1,).
        shares: Of each interval, 1 in all, (intervals,).
        is_narrow: Whether it is narrower than a cell, though edges move: a wider one would change
            the number by too much.
    """

    places: Array
    shares: Array
    is_narrow: bool = False

    @classmethod
    def of_boxes(
        cls,
        middle: float,
        first: float,
        second: float,
        intervals: int = INTERVALS,
        is_narrow: bool = False,
    ) -> Window:
        """The window of two boxes."""
        half, a, b = (first + second) / 2, first / 2, second / 2
        offsets = np.linspace(-half, half, intervals + 1)
        ramps = [np.maximum(offsets + s, 0.0) ** 2 / 2 for s in (a + b, a - b, b - a, -a - b)]
        below = (ramps[0] - ramps[1] - ramps[2] + ramps[3]) / (4 * a * b)
        return cls(middle + offsets, np.diff(below), is_narrow)

    @property
    def middles(self) -> Array:
        """Middles of the intervals (unit of the number)."""
        return np.asarray(0.5 * (self.places[1:] + self.places[:-1]))

    def mean(self, values: Sequence[float]) -> tuple[float, float]:
        """Mean derivative, and how far the slopes of intervals are off what changes steadily.

        For quantities that jump inside the window, such as areas.

        Args:
            values: Of the answers at the places.
        """
        slopes = np.diff(values) / np.diff(self.places)
        return float(self.shares @ slopes), float(np.abs(self._unsteady(slopes, 1)).max())

    def slope(self, values: Sequence[float]) -> tuple[float, float]:
        """Derivative in the middle, and the spread, of a quantity that is smooth but for cells.

        Args:
            values: Of the answers at the places.
        """
        slopes = np.diff(values) / np.diff(self.places)
        found, spread = self.at_middle(slopes)
        # Over an interval of width w, x² is in the mean w²/12 larger than in the middle.
        of_intervals = self._fit(slopes, 2)[2] * (2 / len(slopes)) ** 2 / 12
        return found - float(of_intervals), spread

    def at_middle(self, slopes: Array | Sequence[float]) -> tuple[float, float]:
        """Derivative in the middle, and the spread, from those at the middles of the intervals.

        They may change steadily along it: that is fitted, and taken at the place in the middle.
        """
        found = np.asarray(slopes)
        residuals, fit = self._unsteady(found, 2), self._fit(found, 2)
        return float(fit[0]), float(np.abs(residuals).max())

    def _fit(self, slopes: Array, degree: int) -> Array:
        """Coefficients of the polynomial that fits slopes best, by shares, about the middle."""
        offsets = self._offsets
        weights = np.sqrt(self.shares)
        powers = np.vander(offsets, degree + 1, increasing=True)
        return np.asarray(np.linalg.lstsq(powers * weights[:, None], slopes * weights)[0])

    def _unsteady(self, slopes: Array, degree: int) -> Array:
        """Return the residuals of slopes from the polynomial that fits them best."""
        powers = np.vander(self._offsets, degree + 1, increasing=True)
        return np.asarray(slopes - powers @ self._fit(slopes, degree))

    @property
    def _offsets(self) -> Array:
        """Middles of the intervals, from -1 to 1."""
        half = 0.5 * (self.places[-1] - self.places[0])
        return np.asarray((self.middles - 0.5 * (self.places[-1] + self.places[0])) / half)


def find_window(
    answers: Answers, moved: Moved, middle: float, size: float, intervals: int = INTERVALS
) -> Window | None:
    """The window about a number; collective.

    Args:
        answers: With the number at a place.
        moved: How far edges move between answers.
        middle: The number.
        size: What changes of it are measured by, > 0.
        intervals: Between the answers of the window.

    Returns:
        None where no answers are to be had on both sides.
    """
    widest, half = _WIDEST * size, _FIRST * size
    cells: Array | None = None
    for _ in range(_LOOKS):
        below, above = answers(middle - half), answers(middle + half)
        if below is None or above is None:
            widest = min(widest, half / 2)
            half, cells = half / 4, None
            continue
        cells = moved(below, above)
        fastest = float(cells.max(initial=0.0))
        wanted = half * float(np.clip(1.5 / max(fastest, 1e-9), 0.05, 20.0))
        if _FEWEST <= fastest <= _MOST or (fastest < _FEWEST and half >= widest):
            break
        half = min(wanted, widest)
    if cells is None:
        return None
    boxes = sorted(2 * half / found for found in cells.tolist() if found > 0)
    moves = bool(boxes) and boxes[0] < 2 * widest / _MOVES
    boxes = [box for box in boxes if box <= 2 * widest]
    is_narrow = moves and not boxes
    boxes = boxes or [min(widest, _STILL * size)]
    first = min(boxes[0], widest)
    second = boxes[-1] if (first + boxes[-1]) / 2 <= widest else first
    return Window.of_boxes(middle, first, second, intervals, is_narrow)
