"""Animation of a contact surface, load step by load step."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Integers, Words
from fenics_contact.common.atomic_files import replaced_file
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.contacts.map_values import Surface
from fenics_contact.report.contacts.maps import draw_arrows, draw_status, draw_values
from fenics_contact.report.drawing.cells import nodes_at
from fenics_contact.report.drawing.figures import new_figure, set_title, style, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOURS, labelled, marks, palette_of
from fenics_contact.results.contact_points import WRITTEN, ContactTable
from fenics_contact.results.load_history import Drive, History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

# Load steps from which a run is worth an animation, and the frames that it has at most.
FEWEST_STEPS, _MOST_FRAMES = 10, 60
_SECONDS, _PER_SECOND, _DPI = 6, 10, 120  # about how long, and frames a second at most
_HEIGHT, _WIDTHS = 2.6, {"zones": 2.6, "traction": 3.1, "line": 4.2, "drive": 2.7}
_STATUS = np.array(["OPEN", "STICK", "SLIP"])  # values 0, 1, 2 of the field `status`


@dataclass(frozen=True)
class Film:
    """A contact in the load steps whose fields were written.

    Attributes:
        contact: Its entry in ``result.json``.
        time: Pseudo-times of the frames.
        frames: Its points that are nodes, as they are then.
        zone: The same points, STICK where they ever touch.
        drive: What is moved, with a value a frame; None where nothing moves.
        body: A pyvista grid with the last fields.
    """

    contact: ContactRecord
    time: Array
    frames: list[ContactTable]
    zone: ContactTable
    drive: Drive | None
    body: UnstructuredGrid

    @classmethod
    def of(
        cls,
        series: Iterable[tuple[float, UnstructuredGrid]],
        rows: ContactTable,
        contact: ContactRecord,
        result: Outcome,
        far: tuple[str, ...] = (),
    ) -> Film:
        """Take the fields at the contact's nodes.

        Args:
            series: Pseudo-times and pyvista grids with their fields.
            rows: Points of the contact, at the end.
            contact: Its entry in ``result.json``.
            result: The content of that.
            far: Names of supports that are no drives.
        """
        times, frames = [], []
        for time, body in series:
            frames.append(frame_rows(rows, body, contact))
            times.append(time)
        zone = zone_of(frames)
        drive = _drive(result, contact, times, far)
        return cls(contact, np.array(times), frames, zone, drive, body)

    @property
    def touches(self) -> bool:
        """Whether any of its points ever does."""
        return bool((self.zone.status != "OPEN").any())


def zone_of(frames: Sequence[ContactTable]) -> ContactTable:
    """The points of a contact, STICK where they ever touch.

    Args:
        frames: As they are in load steps.
    """
    ever = np.any([frame.closed for frame in frames], axis=0)
    return replace(frames[-1], status=np.where(ever, "STICK", "OPEN"))


def frame_rows(rows: ContactTable, body: UnstructuredGrid, contact: ContactRecord) -> ContactTable:
    """The points of a contact that are nodes, with a step's fields in place of the last one's.

    Args:
        rows: Points of the contact, at the end.
        body: A pyvista grid with the step's fields.
        contact: Its entry in ``result.json``.
    """
    rows, nodes = nodes_at(body, rows, contact)
    fields: dict[str, Array] = {}
    for array in (*WRITTEN, *contact.own_arrays):
        values = np.asarray(body[array.name]).reshape(-1, len(array.columns))[nodes]
        fields |= dict(zip(array.columns, values.T, strict=True))
    status = _STATUS[np.asarray(body["status"])[nodes].round().astype(int)]
    return replace(rows, status=status, numbers=rows.numbers | fields)


def _drive(
    result: Outcome, contact: ContactRecord, times: list[float], far: tuple[str, ...]
) -> Drive | None:
    """Return the drive that moves last; for an obstacle its motion along the surface."""
    history = History.of(result)
    drives = history.drives(result.contacts, far)
    own = [drive for drive in drives if f"'{contact.name}'" in drive.title]
    if not drives:
        return None
    drive = (own or drives)[-1]
    kept = np.abs(history.time[:, None] - np.array(times)).argmin(axis=0)
    return replace(drive, x=drive.x[kept], y=drive.y[kept])


def frame_numbers(steps: int, most: int = _MOST_FRAMES) -> Integers:
    """Return the numbers of the shown steps: all, or some evenly spread, with the last."""
    return np.unique(np.linspace(0, steps - 1, min(steps, most)).round().astype(np.int64))


def draw_film(film: Film, flat: bool, axes: str, path: Path) -> Picture:
    """Write a film as a GIF.

    Args:
        film: What it shows.
        flat: Whether the contact is a line.
        axes: Letters of the model's axes.
        path: Where to.
    """
    rough = film.contact.carries_shear
    names = ["line"] if flat else (["zones", "traction"] if rough else ["zones"])
    names += ["drive"] if film.drive else []
    widths = [_WIDTHS[name] for name in names]
    screen = _Line(film, axes) if flat else _Map(film, axes)
    with style():
        figure, panels = new_figure(
            "", (sum(widths), screen.height), ncols=len(names), width_ratios=widths, dpi=_DPI
        )
        pictures = [_picture(figure, panels, screen, film, n) for n in range(len(film.time))]
    write_gif(pictures, path)
    what = "friction traction σ_T" if rough else "contact pressure p"
    said = f"Status and {what} on {surface_of(film.contact)} over the load steps"
    said += (
        f"; on the right, {film.drive.title}: force against displacement." if film.drive else "."
    )
    return Picture(path, f"Contact {surface_of(film.contact)} over the load steps", said)


def _picture(
    figure: Figure, panels: list[Axes], screen: _Map | _Line, film: Film, number: int
) -> NDArray[np.uint8]:
    """A frame, drawn where the one before was."""
    for panel in panels:
        panel.clear()
    screen.draw(figure, panels, number)
    if film.drive:
        _follow(panels[-1], film.drive, number)
    set_title(panels[0], f"{surface_of(film.contact)}, t = {film.time[number]:.4g}", screen.pad)
    if number == 0:
        for _ in range(2):  # then nothing moves any more
            figure.canvas.draw()
        figure.set_layout_engine("none")
    figure.canvas.draw()
    found: NDArray[np.uint8] = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    return found


def write_gif(pictures: list[NDArray[np.uint8]], path: Path) -> None:
    """Write frames with the colours of a few of them, so that none flickers."""
    from PIL import Image

    some = [pictures[i] for i in np.linspace(0, len(pictures) - 1, 4).round().astype(int)]
    palette = palette_of(some)
    no_dither = Image.Dither.NONE
    first, *others = (
        Image.fromarray(picture).quantize(palette=palette, dither=no_dither) for picture in pictures
    )
    pace = min(_PER_SECOND, max(len(pictures) / _SECONDS, 2))  # frames a second
    with replaced_file(path) as temporary:
        first.save(
            temporary, save_all=True, append_images=others, duration=round(1000 / pace), loop=0
        )


class _Map:
    """A contact surface in 3D: what sticks and slips, and the friction traction.

    Attributes:
        height: Of the figure in inches.
        pad: Between the first panel and its title, in points: the legend is there.
    """

    pad = 16.0

    def __init__(self, film: Film, _: str) -> None:
        self._film = film
        self._surface = Surface.of(film.body, film.zone, film.contact)
        across, up = self._surface.size
        self.height = float(np.clip(_WIDTHS["zones"] * up / across + 1.0, 2.4, 4.5))
        shown = self._surface.shown
        rows = [frame.rows(shown) for frame in film.frames]
        self._status = [frame.status for frame in rows]
        self._traction = [frame.vectors("traction_x", "traction_y", "traction_z") for frame in rows]
        self._most = max(float(np.linalg.norm(t, axis=1).max()) for t in self._traction) or 1.0
        self._has_bar = False

    def draw(self, figure: Figure, panels: list[Axes], number: int) -> None:
        """A frame."""
        corners = self._surface.corners.reshape(-1, 2)
        points = corners if len(corners) else self._surface.points
        self._zones(panels[0], self._status[number])
        drawn = panels[:1]
        if self._film.contact.carries_shear:
            drawn = panels[:2]
            traction = self._traction[number]
            sizes = np.linalg.norm(traction, axis=1)
            colours = draw_values(panels[1], self._surface, sizes, 0, self._most)
            draw_arrows(panels[1], self._surface, traction, self._most)
            if not self._has_bar:
                label = labelled(r"friction traction, $|\sigma_T|$", "stress")
                figure.colorbar(colours, ax=panels[1], label=label, shrink=0.85, aspect=25)
                self._has_bar = True
        for panel in drawn:
            panel.set_xlim(points[:, 0].min(), points[:, 0].max())
            panel.set_ylim(points[:, 1].min(), points[:, 1].max())
            self._surface.label(panel, panel is panels[0])

    def _zones(self, panel: Axes, status: Words) -> None:
        draw_status(panel, self._surface, status, self._film.contact)
        entries = [panel.plot([], [], **mark.look)[0] for mark in marks(self._film.contact)]
        above = {"loc": "lower left", "bbox_to_anchor": (-0.05, 0.99), "ncols": 3}
        panel.legend(handles=entries, handletextpad=0.1, **above)


class _Line:
    """A contact line of a flat model: friction traction and its bound, or the pressure.

    Attributes:
        height: Of the figure in inches.
        pad: Between the panel and its title, in points.
    """

    height, pad = _HEIGHT, 6.0

    def __init__(self, film: Film, axes: str) -> None:
        self._film, self._axes = film, axes
        whole = SurfaceLine.of(film.body, film.zone, film.contact)
        self._lines = [whole.then(frame) for frame in film.frames]
        self._view = whole.view
        rough = film.contact.carries_shear
        self._coefficient = film.contact.coulomb_coefficient if rough else None
        self._values = [
            line.traction if rough else line.rows.numbers["contact_pressure"]
            for line in self._lines
        ]
        self._label = r"friction traction, $\sigma_T$" if rough else "contact pressure, $p$"
        self._most = max(float(np.abs(values).max()) for values in self._values)
        if self._coefficient:
            self._most = self._coefficient * max(
                float(line.rows.numbers["contact_pressure"].max()) for line in self._lines
            )

    def draw(self, figure: Figure, panels: list[Axes], number: int) -> None:
        """A frame."""
        panel, line, values = panels[0], self._lines[number], self._values[number]
        panel.plot(*line.curve(values), color="0.6", linewidth=0.7, zorder=1)
        for mark in line.marks:
            mine = np.isin(line.rows.status, mark.status)
            panel.plot(line.position[mine], values[mine], **mark.look)
        if self._coefficient:
            bound = self._coefficient * line.rows.numbers["contact_pressure"]
            for side, label in ((1, r"$\pm\mu p$"), (-1, None)):
                panel.plot(*line.curve(side * bound), ":", color="0.3", label=label)
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
        panel.set_xlim(*self._view)
        panel.set_ylim(-1.1 * self._most, 1.4 * self._most)
        line.label(panel, self._axes)
        panel.set_ylabel(labelled(self._label, "stress"))
        panel.legend(loc="upper center", ncols=4)


def _follow(panel: Axes, drive: Drive, number: int) -> None:
    """Force against displacement: all of the way in grey, and how far it has come."""
    panel.plot(drive.x, drive.y, color="0.8", linewidth=0.8)
    panel.plot(drive.x[: number + 1], drive.y[: number + 1], color=COLOURS["STICK"])
    panel.plot(drive.x[number], drive.y[number], "o", color=COLOURS["SLIP"], markersize=5)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    panel.set_xlabel(labelled(drive.moved, "length"))
    panel.set_ylabel(labelled(drive.force, "force"))
    panel.locator_params(axis="x", nbins=5)
