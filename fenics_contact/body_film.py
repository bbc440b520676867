"""The deformed body over the load steps, with its stress and the status of its contacts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.animation import frame_rows, write_gif
from fenics_contact.body_picture import (
    add_bar,
    add_legend,
    colour_range,
    flat_figure,
    framed,
    times,
)
from fenics_contact.body_view import View, cells_inside, choose_view
from fenics_contact.contact_table import ContactTable
from fenics_contact.display import display
from fenics_contact.figures import style
from fenics_contact.flat_picture import draw_flat
from fenics_contact.obstacle_picture import ObstacleSurface, obstacles_of
from fenics_contact.picture import Picture
from fenics_contact.space_picture import corners_of, render

Array = NDArray[np.float64]
Contacts = list[tuple[ContactTable, dict[str, Any]]]

_DPI, _PIXELS = 110, 800


@dataclass(frozen=True)
class Overview:
    """What all frames have in common.

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
        cls, bodies: Iterable[Any], result: dict[str, Any], table: ContactTable
    ) -> Overview:
        """Look at all frames: where anything ever touches, and the largest displacement.

        Args:
            bodies: Grids with their fields, in order.
            result: The content of ``result.json``.
            table: The content of ``contact.csv``.
        """
        ranges, last, ever, farthest = [], None, None, None
        for last in bodies:
            status = np.asarray(last["status"])
            ever = status if ever is None else np.maximum(ever, status)
            moved = np.asarray(last["displacement"])
            if farthest is None or _size(moved) > _size(farthest):
                farthest = moved
            ranges.append(colour_range(np.asarray(last["von Mises stress"])))
        assert last is not None
        whole = last.copy(deep=False)
        whole["status"], whole["displacement"] = ever, farthest
        view = choose_view(whole, result, table)
        low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
        return cls(view, (low, high), any(r[2] for r in ranges), corners_of(view))


def _size(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())


def draw_body_film(
    series: Iterable[tuple[float, Any]],
    overview: Overview,
    body: Any,
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
    draw = _flat_frame if overview.view.flat else _space_frame
    frames = []
    with style():
        if overview.view.flat:
            frames = [draw(*frame, overview, contacts, standing) for frame in series]
        else:
            with display():
                frames = [draw(*frame, overview, contacts, standing) for frame in series]
    write_gif(frames, path)
    caption = (
        "The deformed body over the load steps, coloured by the von Mises stress σ_VM"
        f"{times(overview.view.factor)}, with the status of its contact points at the pseudo-time "
        "t above."
    )
    return Picture(path, "Deformed body over the load steps", caption)


def _then(
    time: float, body: Any, overview: Overview, contacts: Contacts, standing: list[ObstacleSurface]
) -> tuple[View, Contacts, list[ObstacleSurface], str]:
    """View, contacts, obstacles and title of a frame."""
    view = replace(overview.view, body=cells_inside(body, overview.view))
    rows = [(frame_rows(points, body, contact), contact) for points, contact in contacts]
    moved = [found for obstacle in standing if (found := obstacle.then(body)) is not None]
    return view, rows, moved, f"$t$ = {time:.4g}{times(view.factor)}"


def _flat_frame(
    time: float, body: Any, overview: Overview, contacts: Contacts, standing: list[ObstacleSurface]
) -> NDArray[np.uint8]:
    view, rows, obstacles, title = _then(time, body, overview, contacts, standing)
    figure, panel = flat_figure(view)
    colours = draw_flat(panel, body, view, rows, obstacles, overview.limits)
    return _pixels(figure, panel, colours, title, overview.beyond)


def _space_frame(
    time: float, body: Any, overview: Overview, contacts: Contacts, standing: list[ObstacleSurface]
) -> NDArray[np.uint8]:
    view, _, obstacles, title = _then(time, body, overview, contacts, standing)
    picture = render(body, view, [], obstacles, overview.limits, overview.corners, _PIXELS)
    figure, panel = framed(picture, overview.view, overview.limits, overview.beyond)
    return _pixels(figure, panel, None, title, overview.beyond)


def _pixels(
    figure: Any, panel: Any, colours: Any, title: str, beyond: bool
) -> NDArray[np.uint8]:
    if colours is not None:
        add_bar(figure, panel, colours, beyond)
    add_legend(panel, "")
    panel.set_title(title)
    figure.set_dpi(_DPI)
    figure.canvas.draw()
    found: NDArray[np.uint8] = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    return found
