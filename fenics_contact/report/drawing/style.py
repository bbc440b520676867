"""Style of all pictures: marks of contact points, surroundings, colours, and units of labels."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import UnitsRecord

if TYPE_CHECKING:
    from PIL.Image import Image

# Widths in inches: of one column of a journal, of one and a half, and of two.
COLUMN, WIDE, DOUBLE = 3.5, 5.5, 7.2

# For matplotlib. Text has its size in print where a figure is as wide as its column.
STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.labelsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "legend.fontsize": 7.5,
    "legend.title_fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.borderaxespad": 0.3,
    "legend.labelspacing": 0.3,
    "legend.columnspacing": 1.2,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.5,
    "lines.markeredgewidth": 0.8,
    "hatch.linewidth": 0.5,
    "savefig.dpi": 200,
    "pdf.fonttype": 42,
}

# Apart from each other also in grey, by a quarter of the way from black to white; a test measures.
COLOURS = {"STICK": "#08306b", "SLIP": "#e07b00", "OPEN": "#c7d0d4"}
# Round points that are open have this edge, or they would fade on white.
EDGE = "0.45"
COLOUR_MAP = "viridis"
# Of the largest value: values that differ by less are the same but for round-off.
_ROUND_OFF = 1e-6
# What a formula gives, whatever it stands beside.
FORMULA = {"color": "black", "linewidth": 1.0}
# Curves that share a panel: colour and dashes.
LINES: tuple[tuple[str, Any], ...] = (
    ("#08306b", "-"),
    ("#e07b00", "--"),
    ("#1b7f5c", "-."),
    ("#9e4f96", ":"),
    ("#616a6b", (0, (6, 1, 1, 1, 1, 1))),
    ("#b03a2e", (0, (3, 1))),
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

    @property
    def look(self) -> dict[str, Any]:
        """For matplotlib's ``plot``, with the label."""
        edge = EDGE if self.status == ("OPEN",) else self.colour
        return {
            "linestyle": "none",
            "marker": self.shape,
            "markeredgecolor": edge,
            "markerfacecolor": self.colour if self.filled else "white",
            "label": self.label,
        }


_STICK = Mark("stick", ("STICK",), COLOURS["STICK"], "o", True)
_SLIP = Mark("slip", ("SLIP",), COLOURS["SLIP"], "s", False)
_CLOSED = Mark("in contact", ("STICK", "SLIP"), COLOURS["STICK"], "o", True)
_OPEN = Mark("open", ("OPEN",), COLOURS["OPEN"], "o", False)


def marks(*contacts: ContactRecord) -> tuple[Mark, ...]:
    """The marks of contacts: where none carries a force along the surface, nothing sticks or slips.

    Args:
        contacts: Their entries in ``result.json``.
    """
    rough = any(contact.carries_shear for contact in contacts)
    return (_STICK, _SLIP, _OPEN) if rough else (_CLOSED, _OPEN)


def neighbourhood(points: Array, closed: Flags) -> tuple[Array, Array]:
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


_LARGE = 150_000  # bytes from which a picture is made smaller for a page
_EVERY = 4  # pixels between those that colours are chosen from


def palette_of(pictures: list[NDArray[np.uint8]]) -> Image:
    """The 256 colours of pictures, (height, width, 3) each, as Pillow takes them."""
    from PIL import Image

    # Without a share of their own, colours of a few points alone would be given up.
    height, width = pictures[0].shape[:2]
    own = [np.full((height // 12, width, 3), _rgb(colour)) for colour in COLOURS.values()]
    return Image.fromarray(np.concatenate([*pictures, *own]).astype(np.uint8)).quantize(256)


def small_png(path: Path) -> bytes:
    """The content of a PNG file, with fewer colours if it is large."""
    content = path.read_bytes()
    if len(content) < _LARGE:
        return content
    from PIL import Image

    picture = Image.open(io.BytesIO(content)).convert("RGB")
    palette = palette_of([np.asarray(picture)[::_EVERY, ::_EVERY]])
    small = io.BytesIO()
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(small, "PNG")
    return min(content, small.getvalue(), key=len)


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))


_units: ContextVar[UnitsRecord | None] = ContextVar("units of the run that is drawn", default=None)


@contextmanager
def in_units(units: UnitsRecord | None) -> Iterator[None]:
    """Within it, what is drawn bears the units of a run, if it has some.

    Args:
        units: Of its ``result.json``.
    """
    before = _units.set(units)
    try:
        yield
    finally:
        _units.reset(before)


def unit_of(measured: str) -> str:
    """The unit of what is measured, such as ``stress``; empty where the run has no units."""
    units = _units.get()
    return "" if units is None else units.of(measured)


def labelled(words: str, measured: str) -> str:
    """Return the label of an axis or colour bar, with its unit in brackets, if the run has one.

    Args:
        words: Such as ``contact pressure``.
        measured: Such as ``stress``.
    """
    unit = unit_of(measured)
    return f"{words} ({unit})" if unit else words


def with_unit(value: float | str, measured: str) -> str:
    """A number and its unit, if the run has one.

    Args:
        value: In words, or it is written with four digits.
        measured: What it measures.
    """
    unit, number = unit_of(measured), value if isinstance(value, str) else f"{value:.4g}"
    return f"{number} {unit}" if unit else number


def ends_of_colours(low: float, high: float) -> tuple[float, float]:
    """Values of the first and the last colour; from or to 0 where values are all the same.

    >>> ends_of_colours(9.999999999, 10.0)
    (0.0, 10.0)

    Args:
        low: The least value.
        high: The largest.
    """
    if high - low > _ROUND_OFF * max(abs(low), abs(high)):
        return low, high
    return (0.0, high or 1.0) if high >= 0 else (low, 0.0)
