"""A contact in load steps as a page draws it: a frame of the still picture's look, and numbers.

What moves are the values that still pictures draw; a script draws them into the panels of a frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array, Integers, Words
from fenics_contact.report.contacts.curves import (
    bare_strip,
    curve_figure,
    cut_peaks,
    finish_curves,
)
from fenics_contact.report.contacts.film import zone_of
from fenics_contact.report.contacts.line import BOUND, LineValues, SurfaceLine, line_values
from fenics_contact.report.contacts.map_values import (
    MapValues,
    Surface,
    map_values,
    slip_arrows,
    some_arrows,
)
from fenics_contact.report.contacts.maps import (
    LENGTHS,
    SLIPS,
    STATUS_LEGEND,
    draw_map,
    draw_status,
    finish_maps,
    map_figure,
    status_look,
)
from fenics_contact.report.drawing.picture import Frame, numbers, save_frame
from fenics_contact.report.drawing.style import Mark, marks
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

# What a page draws into a panel, in the order in which it does.
Layers = list[dict[str, Any]]


@dataclass(frozen=True)
class MovingContact:
    """A contact in the load steps that a page has.

    Attributes:
        contact: Its entry in ``result.json``.
        frames: Its points that are nodes, as they are at the end of each.
        body: A pyvista grid with the last fields.
    """

    contact: ContactRecord
    frames: list[ContactTable]
    body: UnstructuredGrid

    @property
    def zone(self) -> ContactTable:
        """The points, STICK where they ever touch."""
        return zone_of(self.frames)

    @property
    def kinds(self) -> tuple[Mark, ...]:
        """How its points look."""
        return marks(self.contact)

    def kinds_of(self, status: Words) -> list[int]:
        """Numbers of ``kinds``, of a status for each point."""
        number = {status: n for n, kind in enumerate(self.kinds) for status in kind.status}
        return [number[one] for one in status.tolist()]


def moving_curves(moving: MovingContact, axes: str, path: Path) -> tuple[Frame, list[Layers]]:
    """Curves along a contact line.

    Args:
        moving: The contact.
        axes: Letters of the model's axes.
        path: Of the frame, a PNG file to write.

    Returns:
        The frame, and the layers of each of its panels.
    """
    contact = moving.contact
    whole = SurfaceLine.of(moving.body, moving.zone, contact)
    lines = [whole.then(frame) for frame in moving.frames]
    names = {found.name for line in lines for found in line_values(line, contact)}
    every = [line_values(line, contact, names) for line in lines]
    panels_of = list(zip(*every, strict=True))  # of each panel its values in all steps
    figure, panels = curve_figure([found[0].name for found in panels_of], contact)
    for kind in moving.kinds:
        panels[0].plot([], [], **kind.look)
    for panel, steps in zip(panels, panels_of, strict=False):
        _set_limits(panel, whole, lines, steps)
    bare_strip(panels[-1])
    finish_curves(figure, panels, whole, axes)
    frame = save_frame(figure, panels, path)
    status = [moving.kinds_of(line.rows.status) for line in lines]
    breaks = (np.flatnonzero(np.diff(whole.pieces)) + 1).tolist()
    x = numbers(whole.position, 6)
    layers: list[Layers] = [
        [
            {
                "type": "curve",
                "x": x,
                "breaks": breaks,
                "y": [numbers(found.values) for found in steps],
                "kinds": status,
                "bounds": [[numbers(bound) for bound in found.bounds] for found in steps],
            }
        ]
        for steps in panels_of
    ]
    runs = [_runs(moving, line) for line in lines]
    return frame, [*layers, [{"type": "strip", "runs": runs}]]


def _runs(moving: MovingContact, line: SurfaceLine) -> list[list[float | None]]:
    """Begin, end and kind of each part of the line of one status."""
    found = []
    for start, end, status in line.runs():
        (kind,) = moving.kinds_of(np.array([status]))
        found.append([*numbers(np.array([start, end]), 6), float(kind)])
    return found


def _set_limits(
    panel: Axes, whole: SurfaceLine, lines: Sequence[SurfaceLine], steps: Sequence[LineValues]
) -> None:
    """Set the limits to the values of all steps; peaks are cut off as in a still picture."""
    low, high = whole.view
    shown = (whole.position >= low) & (whole.position <= high)
    every = np.concatenate(
        [values[shown] for found in steps for values in (found.values, *found.bounds)]
    )
    every = every[np.isfinite(every)]
    if len(every):
        panel.plot(2 * [low], [every.min(), every.max()], linestyle="none")
    if steps[0].is_peaked:
        closed = [f.values[line.rows.closed] for f, line in zip(steps, lines, strict=True)]
        cut_peaks(panel, np.concatenate(closed))
    if any(found.bounds for found in steps):
        panel.plot([], [], ":", color="0.3", label=BOUND)
    panel.set_ylabel(steps[0].label)


def moving_maps(moving: MovingContact, path: Path) -> tuple[Frame, list[Layers]]:
    """Maps of a contact in space.

    Args:
        moving: The contact.
        path: Of the frame, a PNG file to write.

    Returns:
        The frame, and the layers of each of its panels.
    """
    contact = moving.contact
    surface = Surface.of(moving.body, moving.zone, contact)
    rows = [frame.rows(surface.shown) for frame in moving.frames]
    names = {found.name for one in rows for found in map_values(surface, one, contact)}
    panels_of = list(zip(*(map_values(surface, one, contact, names) for one in rows), strict=True))
    limits = [
        (min(f.limits[0] for f in steps), max(f.limits[1] for f in steps)) for steps in panels_of
    ]
    figure, panels = map_figure(surface, [steps[-1] for steps in panels_of])
    draw_status(panels[0], surface, rows[-1].status, contact)
    moved = [*panels[0].lines]
    looks = [status_look(kind, len(surface.points)) for kind in moving.kinds]
    handles = [panels[0].plot([], [], **look)[0] for look in looks]
    panels[0].legend(handles=handles, **STATUS_LEGEND)
    for panel, steps, ends in zip(panels[1:], panels_of, limits, strict=True):
        moved += draw_map(figure, panel, surface, steps[-1], ends)
    finish_maps(figure, panels, surface, contact)
    for artist in moved:
        artist.set_visible(False)
    frame = save_frame(figure, panels, path, tight=True)
    layers = [_status_layers(moving, surface, rows)]
    for steps, ends in zip(panels_of, limits, strict=True):
        layers.append(_value_layers(surface, steps, ends))
    return frame, layers


def _status_layers(moving: MovingContact, surface: Surface, rows: list[ContactTable]) -> Layers:
    found = [slip_arrows(surface, one, moving.contact) for one in rows]
    most = max(float(np.linalg.norm(slip, axis=1).max(initial=0.0)) for _, slip in found)
    looks = [status_look(kind, len(surface.points)) for kind in moving.kinds]
    marked = {
        "type": "marks",
        "x": numbers(surface.points[:, 0], 6),
        "y": numbers(surface.points[:, 1], 6),
        "kinds": [moving.kinds_of(one.status) for one in rows],
        "sizes": [look["markersize"] for look in looks],
    }
    arrows = [_arrows(surface, points, slip) for points, slip in found]
    look = {"colour": "black", "width": 0.006, "longest": 1 / SLIPS}
    return [marked, *([{"type": "arrows", "most": most, "at": arrows, **look}] if most else [])]


def _value_layers(
    surface: Surface, steps: Sequence[MapValues], limits: tuple[float, float]
) -> Layers:
    low, high = limits
    layers: Layers = [
        {
            "type": "colours",
            "corners": numbers(surface.corners.ravel(), 5),
            "triangles": surface.triangles.ravel().tolist(),
            "x": numbers(surface.points[:, 0], 6),
            "y": numbers(surface.points[:, 1], 6),
            "values": [numbers(found.values) for found in steps],
            "low": low,
            "high": high if high > low else low + 1.0,
        }
    ]
    if high > 0 and steps[0].arrows is not None:
        at = []
        for found in steps:
            assert found.arrows is not None
            at.append(_arrows(surface, *some_arrows(surface, found.arrows, high)))
        look = {"colour": "white", "width": 0.005, "longest": 1 / LENGTHS}
        layers.append({"type": "arrows", "most": high, "at": at, **look})
    return layers


def _arrows(surface: Surface, points: Integers, vectors: Array) -> list[float | None]:
    """Where each begins, and its components, one after another."""
    return numbers(np.hstack([surface.points[points], vectors]).ravel())
