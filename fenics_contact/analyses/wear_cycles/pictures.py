"""Pictures and an animation of cycles that wear: how much is lost, and where."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.analyses.wear_cycles.worn_history import WornHistory
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    MAX_CONTACT_PRESSURE,
    MAX_WEAR_DEPTH,
    WORN_VOLUME,
)
from fenics_contact.report.contacts.film import frame_numbers, write_gif
from fenics_contact.report.contacts.line import positions
from fenics_contact.report.drawing.charts import Cylinder, chart_of
from fenics_contact.report.drawing.figures import legend_beside, new_figure, save, set_title, style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOUR_MAP,
    COLOURS,
    DOUBLE,
    LINES,
    WIDE,
    labelled,
    neighbourhood,
)
from fenics_contact.results.contact_points import ContactTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEIGHT, _MARGIN = 1.35, 0.5
# So many profiles are told apart in one panel; colours of a map up to this, as yellow is pale.
_MOST_PROFILES, _DARK = 6, 0.88
#: Of the points in a cycle: nothing touches, some of them is lost, or none.
KINDS = (("open", "OPEN"), ("wears", "SLIP"), ("does not wear", "STICK"))
_OPEN, _WEARS, _KEEPS = range(3)
# What grows by less of the largest growth does not: it is round-off of sums over jumps.
_NOTHING = 1e-9


def draw_wear(folder: Path, history: WornHistory) -> list[Picture]:
    """Draw ``wear.png`` and of each contact that wears ``wear_NUMBER.png``, with PDFs."""
    with style():
        drawn = [_over_cycles(history, folder / "wear.png")]
        for number in history.worn:
            path = folder / f"wear_{number}.png"
            drawn.append((_profiles if history.is_flat(number) else _maps)(history, number, path))
        return drawn


def _over_cycles(history: WornHistory, path: Path) -> Picture:
    """Volume, depth and pressure, and the areas of each contact, over the cycles."""
    contacts = history.contacts
    figure, panels = new_figure(
        "Over the cycles", (WIDE, (3 + len(contacts)) * _HEIGHT + _MARGIN),
        nrows=3 + len(contacts), sharex=True,
    )  # fmt: skip
    x, mark = history.cycles, "." if len(history.cycles) <= 60 else ""
    for panel, name, words, unit in (
        (panels[0], WORN_VOLUME, "worn volume, $V$", "volume"),
        (panels[1], MAX_WEAR_DEPTH, "deepest wear, $h$", "length"),
    ):
        values, bars = history.columns[name], history.columns[f"{name}_error"]
        band = {"color": LINES[0][0], "alpha": 0.25, "linewidth": 0}
        panel.fill_between(x, values - bars, values + bars, label="error of the jumps", **band)
        panel.plot(x, values, marker=mark, color=LINES[0][0])
        panel.set_ylabel(labelled(words, unit))
    for number in contacts:
        colour, dashes = LINES[number % len(LINES)]
        look = {"linestyle": dashes, "color": colour, "marker": mark}
        pressure = history.of_contact(number, MAX_CONTACT_PRESSURE)
        panels[2].plot(x, pressure, label=history.title(number), **look)
        _areas(panels[3 + number], history, number)
    panels[2].set_ylabel(labelled("largest\npressure", "stress"))
    for panel in panels:
        panel.set_ylim(0, 1.1 * panel.dataLim.y1 or 1.0)
    panels[-1].set_xlabel("cycle")
    panels[-1].set_xlim(0, 1.02 * x[-1])
    for panel in (panels[0], *(panels[2:] if len(contacts) > 1 else panels[3:])):
        legend_beside(panel)
    figure.align_ylabels(panels)
    save(figure, path)
    said = (
        "Worn volume V and deepest wear h, both surfaces together, largest contact pressure, and "
        "areas in contact, at the ends of the cycles that were computed, with the part that never "
        "slipped in the cycle. Bands: the estimated error of passing over the others."
    )
    return Picture(path, "Wear over the cycles", said)


def _areas(panel: Axes, history: WornHistory, number: int) -> None:
    """In contact, and the part of it that never slips in a cycle."""
    closed = history.of_contact(number, CONTACT_AREA)
    sticks = history.sticking(number)
    panel.fill_between(history.cycles, closed, color=COLOURS["SLIP"], lw=0, label="slips")
    panel.fill_between(history.cycles, sticks, color=COLOURS["STICK"], lw=0, label="never slips")
    panel.plot(history.cycles, closed, color="black", linewidth=0.8)
    title = history.title(number)
    panel.set_ylabel(labelled(f"area,\n{title}" if title else "area", "area"))


def _chosen(history: WornHistory) -> Integers:
    """Places of the cycles whose profiles are drawn: the first and the last, between by volume."""
    volume = history.columns[WORN_VOLUME]
    wanted = np.linspace(volume[0], volume[-1], _MOST_PROFILES)
    found = np.abs(volume[:, None] - wanted).argmin(axis=0)
    return np.unique([0, *found, len(volume) - 1])


def _profiles(history: WornHistory, number: int, path: Path) -> Picture:
    """Along a contact line: depth and pressure at some cycles, and where it sticks at all."""
    tables, title = history.worn[number], history.title(number)
    _, circle, position = positions(tables[-1])
    order = np.argsort(position, kind="stable")
    position = position[order]
    figure, panels = new_figure(
        f"Along {title or 'the contact'}", (WIDE, 5.4),
        nrows=3, sharex=True, height_ratios=[1.9, 1.9, 1.6],
    )  # fmt: skip
    chosen = _chosen(history)
    for place, colour in zip(chosen, _colours(len(chosen)), strict=True):
        numbers, label = tables[place].numbers, f"cycle {history.cycles[place]}"
        for panel, name in zip(panels, ("worn_depth", "contact_pressure"), strict=False):
            panel.plot(position, numbers[name][order], color=colour, label=label)
    panels[0].set_ylabel(labelled("worn depth, $h$", "length"))
    panels[0].invert_yaxis()
    panels[1].set_ylabel(labelled("contact pressure, $p$", "stress"))
    panels[1].set_ylim(bottom=0)
    legend_beside(panels[0])
    _strips(panels[2], position, history, kinds_of([table.rows(order) for table in tables]))
    panels[2].set_xlim(*view_of(position, [table.rows(order) for table in tables]))
    name_axis(panels[2], circle)
    figure.align_ylabels(panels)
    save(figure, path)
    said = (
        "Worn depth h, downwards, and contact pressure p along the contact at the ends of some "
        "cycles. Below: where the contact wears from each computed cycle to the next, where it "
        "touches and does not wear, as what sticks all along, and where it is open at their ends."
    )
    return Picture(path, f"Profiles of {title or 'the wear'}", said)


def _colours(count: int) -> Iterator[object]:
    """From the first cycle to the last."""
    from matplotlib import colormaps

    return iter(colormaps[COLOUR_MAP](np.linspace(0, _DARK, count)))


def name_axis(panel: Axes, circle: Cylinder | None) -> None:
    """Say what the position along a contact line is.

    Args:
        panel: Whose horizontal axis it is.
        circle: Around which the line lies, if around one.
    """
    if circle is not None:
        circle.label(panel, upwards=False)
    else:
        panel.set_xlabel(labelled("position along the contact", "length"))


def kinds_of(tables: list[ContactTable]) -> Integers:
    """Return the kinds (``KINDS``) of the points from cycle to cycle, (cycles, points).

    Args:
        tables: The points at the ends of the cycles.
    """
    depths = np.stack([table.numbers["worn_depth"] for table in tables])
    grown = np.diff(depths, axis=0, prepend=0.0)
    least = _NOTHING * grown.max(axis=1, keepdims=True)
    closed = np.stack([table.closed for table in tables])
    return np.where(grown > least, _WEARS, np.where(closed, _KEEPS, _OPEN))


def _strips(panel: Axes, position: Array, history: WornHistory, kinds: Integers) -> None:
    """A row a cycle in the colours of what the points do."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    middles = (position[1:] + position[:-1]) / 2
    edges = np.concatenate([position[:1], middles, position[-1:]])
    colours = [COLOURS[status] for _, status in KINDS]
    cycles = np.concatenate([[0], history.cycles])
    look = {"cmap": ListedColormap(colours), "vmin": 0, "vmax": len(KINDS) - 1}
    panel.pcolormesh(edges, cycles, kinds, rasterized=True, **look)
    panel.set_ylabel("cycle")
    panel.invert_yaxis()
    legend_beside(
        panel,
        handles=[Patch(color=colours[kind], label=KINDS[kind][0]) for kind in np.unique(kinds)],
    )


def view_of(position: Array, tables: list[ContactTable]) -> tuple[float, float]:
    """Where anything was in contact or worn in any cycle, and a little around.

    Args:
        position: Of the points along the line (length).
        tables: The points at the ends of the cycles.
    """
    touched = np.any([table.closed | (table.numbers["worn_depth"] > 0) for table in tables], axis=0)
    shown = position[touched] if touched.any() else position
    around = 0.15 * float(np.ptp(shown)) or float(np.ptp(position))
    low, high = float(shown.min()) - around, float(shown.max()) + around
    return max(low, float(position[0])), min(high, float(position[-1]))


def _maps(history: WornHistory, number: int, path: Path) -> Picture:
    """On a surface: depth and pressure at the points after the last cycle."""
    rows, title = history.worn[number][-1], history.title(number)
    chart = chart_of(rows)
    points = chart.flat(rows.vectors("x", "y", "z"))
    low, high = neighbourhood(points, rows.closed | (rows.numbers["worn_depth"] > 0))
    shown = ((points >= low) & (points <= high)).all(axis=1)
    rows, (x, y) = rows.rows(shown), points[shown].T
    figure, panels = new_figure("", (DOUBLE, 3.1), ncols=2, sharey=True)
    size = min(60.0, 12e3 / len(x))
    for place, (panel, name, words, unit) in enumerate(
        (
            (panels[0], "worn_depth", "worn depth, $h$", "length"),
            (panels[1], "contact_pressure", "contact pressure, $p$", "stress"),
        )
    ):
        values = rows.numbers[name]
        drawn = panel.scatter(x, y, c=values, s=size, cmap=COLOUR_MAP, vmin=0, linewidths=0)
        figure.colorbar(drawn, ax=panel, label=labelled(words, unit), shrink=0.8)
        panel.set_aspect("equal")
        chart.label(panel, place == 0)
    save(figure, path)
    said = (
        f"Worn depth h and contact pressure p at the points of {title or 'the contact'} after the "
        f"last cycle. {chart.words}"
    ).strip()
    return Picture(path, f"{title or 'the contact'} after the last cycle".capitalize(), said)


# Cycles from which there is something to be seen moving.
FEWEST_CYCLES = 5
_DPI, _HEIGHT_FILM, _HEADROOM = 120, 4.2, 1.08


def draw_wear_film(history: WornHistory, number: int, path: Path) -> Picture:
    """Write the cycles that were computed as a GIF.

    Args:
        history: The cycles.
        number: Of the contact, whose points lie on a line.
        path: Where to.
    """
    line = _Line(history, number)
    figure, panels = new_figure("", (WIDE, _HEIGHT_FILM), nrows=2, sharex=True, dpi=_DPI)
    frames = frame_numbers(len(history.cycles))
    pictures: list[NDArray[np.uint8]] = []
    for frame in frames:
        for panel in panels:
            panel.clear()
        line.draw(panels, int(frame))
        set_title(panels[0], f"cycle {history.cycles[frame]}")
        if not pictures:
            for _ in range(2):  # then nothing moves any more
                figure.canvas.draw()
            figure.set_layout_engine("none")
        figure.canvas.draw()
        pictures.append(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())
    write_gif(pictures, path)
    said = (
        "What is worn off, downwards, in the colours of what the points do up to the next cycle, "
        "and below it the contact pressure, grey that of the first cycle."
    )
    return Picture(path, f"{history.title(number) or 'the contact'} wears".capitalize(), said)


class _Line:
    """A contact line, cycle by cycle."""

    def __init__(self, history: WornHistory, number: int) -> None:
        tables = history.worn[number]
        _, self._circle, position = positions(tables[-1])
        order = np.argsort(position, kind="stable")
        self._position = position[order]
        rows = [table.rows(order) for table in tables]
        self._kinds = kinds_of(rows)
        self._view = view_of(self._position, rows)
        self._depths = np.stack([table.numbers["worn_depth"] for table in rows])
        self._pressures = np.stack([table.numbers["contact_pressure"] for table in rows])

    def draw(self, panels: list[Axes], frame: int) -> None:
        """Draw the state at the end of a cycle."""
        depth, pressure = panels
        x, worn = self._position, self._depths[frame]
        for kind, (label, status) in enumerate(KINDS):
            mine = self._kinds[frame] == kind
            where = mine | np.roll(mine, 1) | np.roll(mine, -1)
            depth.fill_between(x, worn, where=where, color=COLOURS[status], lw=0, label=label)
        depth.plot(x, worn, color="black", linewidth=0.8)
        depth.set_ylabel(labelled("worn depth, $h$", "length"))
        depth.set_ylim(_top(self._depths), 0)
        pressure.plot(x, self._pressures[0], color="0.7", linewidth=0.8)
        pressure.plot(x, self._pressures[frame], color=LINES[0][0])
        pressure.set_ylabel(labelled("contact pressure, $p$", "stress"))
        pressure.set_ylim(0, _top(self._pressures))
        pressure.set_xlim(*self._view)
        name_axis(pressure, self._circle)


def _top(values: Array) -> float:
    return _HEADROOM * float(values.max()) or 1.0
