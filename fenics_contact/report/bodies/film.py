"""The deformed body over the load steps, with its stress and the status of its contacts."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array
from fenics_contact.report.bodies.picture import (
    add_bar,
    add_legend,
    colour_range,
    draw_flat,
    flat_figure,
    framed,
    times,
)
from fenics_contact.report.bodies.space import corners_of, render, seen_points
from fenics_contact.report.bodies.view import (
    ObstacleSurface,
    View,
    cells_inside,
    choose_view,
    obstacles_of,
)
from fenics_contact.report.contacts.film import frame_rows, write_gif
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.picture import Picture, display
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

Contacts = list[tuple[ContactTable, ContactRecord]]

_DPI, _PIXELS = 110, 800
MOST_BODIES = 30  # frames at most


@dataclass(frozen=True)
class Overview:
    """Properties that all frames have in common.

    Attributes:
        view: What is shown; its body is the last one.
        limits: Stresses at the ends of the colours.
        beyond: Whether some stress is outside of these.
        corners: In space, what has to fit into the window, (points, 3) (length).
    """

    view: View
    limits: tuple[float, float]
    beyond: bool
    corners: Array

    @classmethod
    def of(
        cls, bodies: Iterable[UnstructuredGrid], result: Outcome, table: ContactTable
    ) -> Overview | None:
        """Look at all frames: where anything ever touches, and the largest displacement.

        Args:
            bodies: Grids with their fields, in order.
            result: The content of ``result.json``.
            table: The content of ``contact.csv``.

        Returns:
            None where nothing ever moves.
        """
        ranges, last, ever, farthest = [], None, None, None
        for last in bodies:
            status = np.asarray(last["status"])
            ever = status if ever is None else np.maximum(ever, status)
            moved = np.asarray(last["displacement"])
            if farthest is None or _size(moved) > _size(farthest):
                farthest = moved
            ranges.append(colour_range(np.asarray(last["von Mises stress"])))
        if last is None or farthest is None or not farthest.any():
            return None
        whole = last.copy(deep=False)
        whole["status"], whole["displacement"] = ever, farthest
        view = choose_view(whole, result, table)
        low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
        return cls(view, (low, high), any(r[2] for r in ranges), corners_of(view))


def _size(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())


def draw_body_film(
    series: Iterable[tuple[float, UnstructuredGrid]],
    overview: Overview,
    body: UnstructuredGrid,
    contacts: Contacts,
    path: Path,
) -> Picture:
    """Write the film as a GIF.

    Args:
        series: Pseudo-times and grids with their fields.
        overview: Of all these.
        body: The last grid.
        contacts: Points and entries in ``result.json`` of its contacts, at the end.
        path: Where to.

    Raises:
        InputError: A display is missing for a body in space; says what to install.
    """
    standing = obstacles_of(body, contacts)
    frames: list[NDArray[np.uint8]] = []
    with style(), nullcontext() if overview.view.flat else display():
        screen: _Flat | _Space = (_Flat if overview.view.flat else _Space)(overview)
        for time, now in series:
            view = replace(overview.view, body=cells_inside(now, overview.view))
            rows = [(frame_rows(points, now, contact), contact) for points, contact in contacts]
            moved = [then for obstacle in standing if (then := obstacle.then(now)) is not None]
            title = f"$t$ = {time:.4g}{times(view.factor)}"
            frames.append(screen.draw(now, view, rows, moved, title))
    write_gif(frames, path)
    caption = (
        "The deformed body over the load steps, coloured by the von Mises stress σ_VM"
        f"{times(overview.view.factor)}, with the status of its contact points at each t."
    )
    return Picture(path, "Deformed body over the load steps", caption)


class _Flat:
    """Frames of a flat body: the figure stays, its panel is drawn anew."""

    def __init__(self, overview: Overview) -> None:
        self._overview = overview
        self._figure, self._panel = flat_figure(overview.view)
        self._labels = self._panel.get_xlabel(), self._panel.get_ylabel()
        self._is_first = True

    def draw(
        self,
        body: UnstructuredGrid,
        view: View,
        contacts: Contacts,
        obstacles: list[ObstacleSurface],
        title: str,
    ) -> NDArray[np.uint8]:
        """A frame's pixels, (height, width, 3)."""
        panel = self._panel
        panel.clear()
        panel.set_xlabel(self._labels[0])
        panel.set_ylabel(self._labels[1])
        colours = draw_flat(panel, body, view, contacts, obstacles, self._overview.limits)
        if self._is_first:
            add_bar(self._figure, panel, colours, view.field, self._overview.beyond)
        add_legend(panel, title, all_marks=view.marks)
        pixels = _pixels(self._figure, self._is_first)
        self._is_first = False
        return pixels


class _Space:
    """Frames of a body in space: the figure stays, but for the picture in it and the title."""

    def __init__(self, overview: Overview) -> None:
        self._overview = overview
        self._drawn: tuple[Figure, Axes] | None = None

    def draw(
        self,
        body: UnstructuredGrid,
        view: View,
        contacts: Contacts,
        obstacles: list[ObstacleSurface],
        title: str,
    ) -> NDArray[np.uint8]:
        """A frame's pixels, (height, width, 3)."""
        overview, is_first = self._overview, self._drawn is None
        look = overview.limits, seen_points(view), overview.corners, _PIXELS
        picture = render(body, view, [], obstacles, *look)
        if self._drawn is None:
            seen = seen_points(overview.view)
            self._drawn = framed(picture, overview.view, overview.limits, seen, overview.beyond)
            add_legend(self._drawn[1], title)
        figure, panel = self._drawn
        panel.images[0].set_data(picture)
        panel.set_title(title, pad=16)
        return _pixels(figure, is_first)


def _pixels(figure: Figure, is_first: bool) -> NDArray[np.uint8]:
    """Return the pixels of a figure, whose layout is fixed from the first frame on."""
    if is_first:
        figure.set_dpi(_DPI)
        for _ in range(2):
            figure.canvas.draw()
        figure.set_layout_engine("none")
    figure.canvas.draw()
    found: NDArray[np.uint8] = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    return found
