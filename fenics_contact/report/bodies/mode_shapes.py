"""The shapes in which bodies vibrate, a panel each."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.fields import (
    Triangles,
    flat_outline,
    outline,
    surface,
)
from fenics_contact.report.drawing.figures import new_figure, set_title
from fenics_contact.report.drawing.picture import display
from fenics_contact.report.drawing.style import COLOUR_MAP, DOUBLE, WIDE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

MOVE = 0.12  # of the body's diagonal: the largest displacement that is drawn
_HEIGHTS, _TITLE = (0.7, 3.0), 0.35  # of a panel and of its title, in inches
_SLENDER = 0.4  # height over width of bodies of which each has a row of its own
_PIXELS, _WHITE = 900, 250
_TOWARDS = np.array([1.0, -1.6, 1.0]) / np.linalg.norm([1.0, -1.6, 1.0])


def figure_of_shapes(shapes: Mapping[str, UnstructuredGrid], in_space: bool) -> Figure:
    """A panel for each shape, with its title.

    Args:
        shapes: Title → the body with its ``displacement``, and ``largest`` where its size is to be
            over that of other panels, too.
        in_space: Whether they are bodies in space.
    """
    count, bodies = len(shapes), list(shapes.values())
    if in_space:
        figure, panels = _panels(count, 0.62, columns=min(2, count))
        pictures = _cropped([_rendered(shape) for shape in bodies])
        for panel, picture in zip(panels, pictures, strict=False):
            panel.imshow(picture, interpolation="antialiased")
    else:
        height = _height(bodies[0])
        columns = 1 if height < _SLENDER else min(2, count)
        figure, panels = _panels(count, height + 2 * MOVE, columns)
        for panel, shape in zip(panels, bodies, strict=False):
            _draw_flat(panel, shape)
        _of_one_scale(panels[:count])
    for panel, title in zip(panels, shapes, strict=False):
        set_title(panel, title)
    for panel in panels:
        panel.set_axis_off()
    return figure


def _panels(count: int, height: float, columns: int) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels, by their height over width, and their columns."""
    across = (WIDE if columns == 1 else DOUBLE) / columns
    rows, tall = -(-count // columns), float(np.clip(across * height, *_HEIGHTS))
    size = across * columns, (tall + _TITLE) * rows
    return new_figure("", size, nrows=rows, ncols=columns)


def _height(body: UnstructuredGrid) -> float:
    """Height over width of a flat body."""
    across, up = np.ptp(np.asarray(body.points), axis=0)[:2]
    return float(up / across)


def _sized(body: UnstructuredGrid) -> tuple[float, Array]:
    """The factor of the displacements, and their sizes over the largest, (nodes,)."""
    sizes = np.linalg.norm(np.asarray(body["displacement"]), axis=1)
    diagonal = float(np.linalg.norm(np.ptp(np.asarray(body.points), axis=0)))
    largest = float(body["largest"][0] if "largest" in body.array_names else sizes.max()) or 1.0
    return MOVE * diagonal / largest, sizes / largest


def _draw_flat(panel: Axes, body: UnstructuredGrid) -> None:
    """A flat body, moved, over its outline at rest."""
    from matplotlib.collections import LineCollection

    factor, body["size"] = _sized(body)
    cells = Triangles.of(body, "displacement", "size")
    look: dict[str, Any] = {"shading": "gouraud", "cmap": COLOUR_MAP, "vmin": 0.0, "vmax": 1.0}
    panel.tripcolor(*cells.moved(factor)[:, :2].T, cells.corners, cells.fields["size"], **look)
    lines = [line[:, :2] for line in flat_outline(body)]
    panel.add_collection(LineCollection(lines, colors="0.6", linewidths=0.6, zorder=0.4))
    moved = body.copy()
    moved.points = np.asarray(body.points) + factor * np.asarray(body["displacement"])
    lines = [line[:, :2] for line in flat_outline(moved)]
    panel.add_collection(LineCollection(lines, colors="0.2", linewidths=0.6))
    panel.set_aspect("equal")
    panel.autoscale_view()


def _of_one_scale(panels: list[Axes]) -> None:
    """Panels of one body show as much of the plane as the one that needs most."""
    across = np.array([panel.get_xlim() for panel in panels])
    up = np.array([panel.get_ylim() for panel in panels])
    for panel in panels:
        panel.set_xlim(across[:, 0].min(), across[:, 1].max())
        panel.set_ylim(up[:, 0].min(), up[:, 1].max())


def _cropped(pictures: list[NDArray[np.uint8]]) -> list[NDArray[np.uint8]]:
    """Pictures of one size without the white that is around all of them."""
    drawn = np.any([(picture < _WHITE).any(axis=2) for picture in pictures], axis=0)
    spans = []
    for axis in (1, 0):
        found = np.flatnonzero(drawn.any(axis=axis))
        spans.append(slice(found[0], found[-1] + 1) if len(found) else slice(None))
    return [picture[spans[0], spans[1]] for picture in pictures]


def _rendered(body: UnstructuredGrid) -> NDArray[np.uint8]:
    """A body in space, moved, with its edges at rest: (height, width, 3)."""
    with display():
        import pyvista

        factor, body["size"] = _sized(body)
        moved = surface(body, 2).warp_by_vector("displacement", factor=factor)
        plotter = pyvista.Plotter(off_screen=True, window_size=(_PIXELS, int(0.62 * _PIXELS)))
        with closing(plotter):  # VTK would end the process at a display that is gone
            plotter.set_background("white")
            plotter.enable_anti_aliasing("ssaa")
            plotter.add_mesh(outline(body), color="#999999", line_width=2)
            plotter.add_mesh(
                moved, scalars="size", cmap=COLOUR_MAP, clim=(0, 1), show_scalar_bar=False
            )
            plotter.add_mesh(_edges_of(moved), color="#303030", line_width=2)
            plotter.enable_parallel_projection()
            middle = np.asarray(body.center)
            plotter.camera_position = [middle + 3 * body.length * _TOWARDS, middle, (0, 0, 1)]
            plotter.reset_camera()
            plotter.camera.zoom(1.15)
            return np.asarray(plotter.screenshot(return_img=True))


def _edges_of(surface_of_body: Any) -> Any:
    """Sharp edges of a surface that has moved."""
    return surface_of_body.extract_feature_edges(
        boundary_edges=True, feature_edges=True, manifold_edges=False, non_manifold_edges=False
    )
