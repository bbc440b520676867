"""The picture of the deformed body, with its stress and the status of its contact points."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.report.bodies.space import render, seen_points
from fenics_contact.report.bodies.view import (
    ObstacleSurface,
    View,
    choose_view,
    obstacles_of,
    whole_view,
)
from fenics_contact.report.drawing.cells import nodes_at
from fenics_contact.report.drawing.fields import Triangles, flat_outline, flat_sides
from fenics_contact.report.drawing.figures import new_figure, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOUR_MAP,
    EDGE,
    WIDE,
    Mark,
    ends_of_colours,
    labelled,
    marks,
    with_unit,
)
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

_LABELS = {
    "von Mises stress": (r"von Mises stress, $\sigma_{VM}$", "stress"),
    "temperature": ("temperature, $T$", "temperature"),
}
_HEIGHTS = (1.0, 5.0)  # of a flat model's panel, in inches
_FLAT = 0.35  # height over width of panels that have their colour bar below


def draw_body(body: UnstructuredGrid, result: Outcome, table: ContactTable, path: Path) -> Picture:
    """Draw the deformed mesh over the undeformed outline, with the contact points' status.

    Where the contact zone is small in the body, only its neighbourhood is drawn.

    Args:
        body: As ``read_body`` returns it.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        path: PNG file to write.

    Raises:
        InputError: A display is missing for a body in space; says what to install.
    """
    view = choose_view(body, result, table)
    contacts = [(table.of(contact.name), contact) for contact in result.contacts]
    obstacles = obstacles_of(body, contacts)
    low, high, beyond = colour_range(np.asarray(view.body["von Mises stress"]))
    title = "Deformed body" + (" near the contact" if view.is_near else "") + times(view.factor)
    if view.flat:
        figure, panel = flat_figure(view)
        colours = draw_flat(panel, body, view, contacts, obstacles, (low, high))
        add_legend(panel, title)
        add_bar(figure, panel, colours, view.field, bool(beyond))
    else:
        seen = seen_points(view)
        picture = render(body, view, contacts, obstacles, (low, high), seen)
        figure, panel = framed(picture, view, (low, high), seen, bool(beyond))
        add_legend(panel, title)
    save(figure, path, tight=view.flat)
    return Picture(path, title, _caption(view, contacts, beyond))


def draw_temperatures(body: UnstructuredGrid, result: Outcome, path: Path) -> Picture:
    """Draw the temperatures of a body at the end of a run.

    Args:
        body: As ``read_body`` returns it, with temperatures.
        result: The content of its ``result.json``.
        path: PNG file to write.

    Raises:
        InputError: A display is missing for a body in space; says what to install.
    """
    view = whole_view(body, result.model.kinematics, "temperature")
    values = np.asarray(body["temperature"])
    limits = ends_of_colours(float(values.min()), float(values.max()))
    if view.flat:
        figure, panel = flat_figure(view)
        add_bar(figure, panel, draw_flat(panel, body, view, [], [], limits), view.field)
    else:
        seen = np.zeros(len(values), dtype=bool)
        figure, panel = framed(render(body, view, [], [], limits, seen), view, limits, seen)
    title = "Temperature"
    add_legend(panel, title)
    save(figure, path, tight=view.flat)
    ends = " to ".join(with_unit(each, "temperature") for each in (values.min(), values.max()))
    said = f"The temperature at the end, from {ends}, linear or quadratic between nodes; at a node "
    return Picture(path, title, f"{said}of several cells the mean of these.")


def times(factor: float) -> str:
    """The magnification, if there is one."""
    return "" if factor == 1 else f", displacements × {factor:g}"


def _caption(view: View, contacts: list[tuple[ContactTable, ContactRecord]], beyond: float) -> str:
    said = "The deformed body, coloured by the von Mises stress σ_VM"
    if beyond:
        said += f" (at single points up to {with_unit(f'{beyond:.3g}', 'stress')})"
    if view.factor == 1:
        said += ", displacements to scale"
    else:
        said += f", displacements magnified {view.factor:g} times"
    dashed = "dashed" if view.flat else "grey"
    said += f"; {dashed}, the undeformed outline."
    if contacts:
        said += " Points: " + ", ".join(mark.label for mark in view.marks)
        said += "; those that a body hides are not drawn." if view.hides else "."
    if any(c.is_rigid and "master" not in c for _, c in contacts):
        what = "hatched" if view.flat else "translucent"
        said += f" The obstacle is {what}"
        said += "." if view.factor == 1 else "; gaps are magnified as displacements are."
    return said


def flat_figure(view: View) -> tuple[Figure, Axes]:
    """A figure for a flat body, and its panel."""
    across, up = (view.high - view.low)[:2]
    margin = 1.3 if up < _FLAT * across else 0.6
    height = float(np.clip(0.8 * WIDE * up / across, *_HEIGHTS))
    figure, (panel,) = new_figure("", (WIDE, height + margin))
    axes = "rz" if view.axisymmetric else "xy"
    panel.set_xlabel(labelled(f"${axes[0]}$", "length"))
    panel.set_ylabel(labelled(f"${axes[1]}$", "length"))
    return figure, panel


def add_bar(
    figure: Figure, panel: Axes, colours: ScalarMappable, field: str, beyond: bool = False
) -> None:
    """The colour bar of a field, below wide panels; an arrow at its end where some is beyond."""
    low, high = np.sort(np.array([panel.get_xlim(), panel.get_ylim()])).T
    across, up = high - low
    look: dict[str, Any] = {"shrink": 0.85, "pad": 0.02}
    if up < _FLAT * across:
        look = {"location": "bottom", "shrink": 0.6}
    extend = "max" if beyond else "neither"
    label = labelled(*_LABELS[field])
    figure.colorbar(colours, ax=panel, label=label, extend=extend, aspect=28, **look)


def framed(
    picture: NDArray[np.uint8],
    view: View,
    limits: tuple[float, float],
    seen: Flags,
    beyond: bool = False,
) -> tuple[Figure, Axes]:
    """A figure around a picture of a body in space: colour bar, axes, and marks for a legend.

    Args:
        picture: Pixels, (height, width, 3).
        view: What it shows.
        limits: Stresses at the ends of the colours.
        seen: Which nodes of the view's body are drawn as contact points, (nodes,).
        beyond: Whether some stress is outside of the limits.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    height = WIDE * 0.82 * picture.shape[0] / picture.shape[1]
    figure, (panel,) = new_figure("", (WIDE, height + 0.35))
    panel.imshow(picture, interpolation="antialiased")
    panel.set_axis_off()
    drawn = set(np.unique(np.asarray(view.body["status"])[seen]))
    for mark in view.marks:
        if drawn & {("OPEN", "STICK", "SLIP").index(status) for status in mark.status}:
            panel.plot([], [], **point_look(mark))
    colours = ScalarMappable(Normalize(*limits), COLOUR_MAP)
    add_bar(figure, panel, colours, view.field, beyond)
    _axes(panel, view)
    return figure, panel


def _axes(panel: Axes, view: View) -> None:
    """Draw the directions of x, y and z in the lower left corner."""
    right, up = view.screen
    look = {"arrowstyle": "-|>", "linewidth": 0.8, "color": "0.2", "mutation_scale": 6}
    for letter, axis in zip("xyz", np.eye(3), strict=True):
        tip = 0.065 * np.array([axis @ right, axis @ up])
        height, width = panel.images[0].get_array().shape[:2]
        tip[1] *= width / height
        start = np.array([0.08, 0.1])
        panel.annotate("", start + tip, start, xycoords="axes fraction", arrowprops=look)
        where = start + 1.45 * tip
        panel.text(*where, f"${letter}$", transform=panel.transAxes, ha="center", va="center")


def colour_range(stress: Array) -> tuple[float, float, float]:
    """Ends of the colours, and the stress that a few points alone have beyond, 0 without such."""
    low, most, high = (float(value) for value in np.percentile(stress, [0, 95, 100]))
    low = 0.0 if low < 0.05 * high else low
    if high > 3 * most and most > low:
        return low, most, high
    return *ends_of_colours(low, high), 0.0


_THICK = 0.035  # of what is shown: how much of an obstacle is drawn
_FEW, _FEW_CELLS = 60, 1000


def draw_flat(
    panel: Axes,
    body: UnstructuredGrid,
    view: View,
    contacts: list[tuple[ContactTable, ContactRecord]],
    obstacles: list[ObstacleSurface],
    limits: tuple[float, float],
) -> ScalarMappable:
    """Draw a deformed flat body with its stress, where it was, its contact points and obstacles.

    Args:
        panel: Matplotlib's axes.
        body: A pyvista grid with its fields.
        view: What of it is shown.
        contacts: Points and entries in ``result.json`` of its contacts.
        obstacles: Those that are drawn.
        limits: Stresses at the ends of the colours.

    Returns:
        What a colour bar is made for.
    """
    from matplotlib.collections import LineCollection

    cells = Triangles.of(view.body, "displacement", view.field)
    points = cells.moved(view.factor)
    colours = panel.tripcolor(
        *points[:, :2].T,
        cells.corners,
        cells.fields[view.field],
        shading="gouraud",
        cmap=COLOUR_MAP,
        vmin=limits[0],
        vmax=limits[1],
        zorder=0.5,
    )
    moved = np.asarray(view.body.points) + view.factor * np.asarray(view.body["displacement"])
    sides = moved[flat_sides(view.body)[0]][:, :, :2]
    width = 0.5 if view.body.n_cells < _FEW_CELLS else 0.25
    panel.add_collection(
        LineCollection(sides, colors="white", linewidths=width, alpha=0.5, zorder=0.6)
    )
    panel.set_rasterization_zorder(1)  # in the PDF: these two as pixels
    before = [line[:, :2] for line in flat_outline(body)]
    panel.add_collection(
        LineCollection(before, colors="0.35", linewidths=0.7, linestyles=(0, (4, 2)), zorder=1.4)
    )
    for obstacle in obstacles:
        _draw_obstacle(panel, obstacle, view)
    _draw_points(panel, body, view, contacts)
    low, high = _frame(view, points)
    panel.set_aspect("equal")
    panel.set_xlim(low[0], high[0])
    panel.set_ylim(low[1], high[1])
    return colours


def _frame(view: View, points: Array) -> tuple[Array, Array]:
    """Return the shown range: the view, for a whole body with its displacements, and a margin."""
    low, high = view.low[:2], view.high[:2]
    if not view.is_near:
        low = np.minimum(low, points[:, :2].min(axis=0))
        high = np.maximum(high, points[:, :2].max(axis=0))
    margin = 1.4 * _THICK * view.size
    return low - margin, high + margin


def _draw_obstacle(panel: Axes, obstacle: ObstacleSurface, view: View) -> None:
    """Hatched, from its surface on."""
    axis = int(np.argmax(np.ptp(obstacle.points[:, :2], axis=0)))
    order = np.argsort(obstacle.points[:, axis])
    near = obstacle.at(view.factor)[order, :2]
    if view.axisymmetric and axis == 0 and len(near) > 1 and near[0, 0] < 2 * np.diff(near[:2, 0]):
        near = np.concatenate([[[0.0, near[0, 1]]], near])  # no contact point lies on the axis
    across = 1 - axis
    up = float(np.sign(obstacle.normals[:, across].mean()))
    behind = near[[-1, 0]]
    behind[:, across] = up * ((up * near[:, across]).max() + _THICK * view.size)
    band = np.concatenate([near, behind])
    panel.fill(*band.T, facecolor="0.9", edgecolor="0.6", hatch="/////", linewidth=0, zorder=1.5)
    panel.plot(*near.T, color="0.25", linewidth=0.9, zorder=1.6)


def _draw_points(
    panel: Axes,
    body: UnstructuredGrid,
    view: View,
    contacts: list[tuple[ContactTable, ContactRecord]],
) -> None:
    """Contact points where they moved to, by their status."""
    said: set[str] = set()
    for rows, contact in contacts:
        found, nodes = nodes_at(body, rows, contact)
        if len(nodes) == 0:
            continue
        moved = (
            np.asarray(body.points)[nodes] + view.factor * np.asarray(body["displacement"])[nodes]
        )
        few = len(nodes) < _FEW
        for mark in marks(contact):
            mine = np.isin(found.status, mark.status)
            if mine.any():
                label = mark.label if mark.label not in said else None
                said.add(mark.label)
                panel.plot(*moved[mine, :2].T, zorder=3, **point_look(mark, few) | {"label": label})


def point_look(mark: Mark, few: bool = True) -> dict[str, Any]:
    """Points on coloured bodies: filled, with an edge that keeps them apart from the colours."""
    edge = EDGE if mark.status == ("OPEN",) else "white"
    return mark.look | {
        "markerfacecolor": mark.colour,
        "markeredgecolor": edge,
        "markeredgewidth": 0.4 if few else 0.15,
        "markersize": 4.2 if few else 3.2,
    }


def add_legend(panel: Axes, title: str, all_marks: tuple[Mark, ...] = ()) -> None:
    """The legend above the panel, and the title above that.

    Args:
        panel: Matplotlib's axes.
        title: In matplotlib's words.
        all_marks: Those of the legend; by default of what is drawn.
    """
    handles = [panel.plot([], [], **point_look(mark))[0] for mark in all_marks]
    handles = handles or panel.get_legend_handles_labels()[0]
    panel.set_title(title, pad=16 if handles else None)
    if handles:
        panel.legend(
            handles=handles, loc="lower left", bbox_to_anchor=(-0.02, 0.995), ncols=3,
            handletextpad=0.1,
        )  # fmt: skip
