"""What scenes at random are drawn with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st


class Dice:
    """Small whole numbers of hypothesis, and what is made of them.

    Larger numbers it mixes with those that it reads in the sources of the project: it would draw
    other scenes whenever these change.

    Args:
        draw: Of a composite strategy.
    """

    def __init__(self, draw: Callable[[Any], Any]) -> None:
        self._draw = draw

    def of(self, *options: Any) -> Any:
        """One of the options, each as likely."""
        return options[self.whole(0, len(options) - 1)]

    def whole(self, low: int, high: int) -> int:
        """A whole number, both ends included."""
        return self._draw(st.integers(low, high))

    def between(self, low: float, high: float) -> float:
        """A number of four digits."""
        return short(low + (high - low) * self.whole(0, 98) / 98)

    def logarithmic(self, low: float, high: float) -> float:
        """A number of four digits; every order of magnitude is as likely."""
        return short(low * (high / low) ** (self.whole(0, 98) / 98))

    def chance(self, percent: int) -> bool:
        """Whether it happens that has this chance; it does not in the simplest example."""
        return self.whole(0, 99) >= 100 - percent


def short(value: float) -> float:
    """Rounded to four digits, so that it can be read."""
    return float(f"{value:.4g}")


class SeededDice(Dice):
    """The same from numbers of numpy, which depend on nothing but the seeds.

    Args:
        seeds: Whole numbers ≥ 0.
    """

    def __init__(self, *seeds: int) -> None:
        self._numbers = np.random.default_rng(seeds)

    def whole(self, low: int, high: int) -> int:
        return int(self._numbers.integers(low, high + 1))
