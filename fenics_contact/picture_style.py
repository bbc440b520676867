"""What all pictures share: how contact points are marked, and how far around them one looks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Legible in grey as well: stick dark and filled, slip light and open.
COLOURS = {"STICK": "#1b4f72", "SLIP": "#e67e22", "OPEN": "#aab7b8"}
COLOUR_MAP = "viridis"
# Curves that share a panel: colour and dashes.
LINES = (
    ("#1b4f72", "-"),
    ("#e67e22", "--"),
    ("#1e8449", "-."),
    ("#7d3c98", ":"),
    ("#616a6b", "-"),
    ("#c0392b", "--"),
)

# A view of the neighbourhood of a contact zone is this many times as wide as the zone.
_NEIGHBOURHOOD = 2.5


@dataclass(frozen=True)
class Mark:
    """How contact points of some kind look.

    Attributes:
        label: What legends call them.
        status: Those that it stands for.
        colour: A colour of ``COLOURS``.
        shape: Matplotlib's marker.
        filled: Whether it is filled.
    """

    label: str
    status: tuple[str, ...]
    colour: str
    shape: str
    filled: bool


_STICK = Mark("stick", ("STICK",), COLOURS["STICK"], "o", True)
_SLIP = Mark("slip", ("SLIP",), COLOURS["SLIP"], "s", False)
_CLOSED = Mark("in contact", ("STICK", "SLIP"), COLOURS["STICK"], "o", True)
_OPEN = Mark("open", ("OPEN",), COLOURS["OPEN"], "o", False)


def marks(law: str) -> tuple[Mark, ...]:
    """The marks of a friction law of ``result.json``: without friction nothing sticks or slips."""
    return (_CLOSED, _OPEN) if law == "none" else (_STICK, _SLIP, _OPEN)


def neighbourhood(points: Array, closed: NDArray[np.bool_]) -> tuple[Array, Array]:
    """A square or cube around the closed points, or around all where that is nothing.

    Args:
        points: Shape (points, axes).
        closed: Which of them are closed, (points,).

    Returns:
        Its lowest and its highest coordinates, (axes,) each.
    """
    zone = points[closed]
    if len(zone) == 0 or np.ptp(zone, axis=0).max() == 0:
        zone = points
    low, high = zone.min(axis=0), zone.max(axis=0)
    reach = 0.5 * _NEIGHBOURHOOD * (high - low).max()
    return (low + high) / 2 - reach, (low + high) / 2 + reach
