"""Bodies in space, drawn off-screen. pyvista's drawing, and only here."""

from __future__ import annotations

from contextlib import closing
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.report.bodies.view import ObstacleSurface, View
from fenics_contact.report.drawing.cells import nodes_at
from fenics_contact.report.drawing.fields import outline, surface, surface_edges
from fenics_contact.report.drawing.picture import display
from fenics_contact.report.drawing.style import COLOUR_MAP
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from pyvista import DataSet, Plotter, UnstructuredGrid

Contacts = list[tuple[ContactTable, ContactRecord]]

_WIDTH, _HEIGHTS, _MARGIN = 1400, (0.45, 0.95), 1.04
_STATUS = ("OPEN", "STICK", "SLIP")  # values 0, 1, 2 of the field `status`
_FEW_CELLS = 3000
_BALL = (0.003, 0.009)  # over what is shown: radius of a contact point
_BEFORE = 0.002  # over what is shown: what is so near before a point does not hide it
_ARROW, _APART = 0.06, 0.035  # over what is shown: the longest, and how far they are apart


def render(
    body: UnstructuredGrid,
    view: View,
    contacts: Contacts,
    obstacles: list[ObstacleSurface],
    limits: tuple[float, float],
    seen: Flags,
    corners: Array | None = None,
    width: int = _WIDTH,
) -> NDArray[np.uint8]:
    """Draw a body in space, where it was, its contact points, their slip and the obstacles.

    Args:
        body: A pyvista grid with its fields.
        view: What of it is shown, and from where.
        contacts: Points and entries in ``result.json`` of its contacts, whose slip is shown.
        obstacles: Those that are drawn.
        limits: Stresses at the ends of the colours.
        seen: Which nodes of the view's body are drawn as contact points, (nodes,).
        corners: What has to fit into the window, (points, 3); by default what is shown, moved or
            not (length).
        width: Of the window in pixels.

    Returns:
        Pixels, (height, width, 3).

    Raises:
        InputError: A display is missing; says what to install.
    """
    with display():
        import pyvista

        corners = corners_of(view) if corners is None else corners
        window, centre, scale = _look(view, corners, width)
        plotter = pyvista.Plotter(off_screen=True, window_size=window)
        with closing(plotter):  # VTK would end the process at a display that is gone
            plotter.set_background("white")
            plotter.enable_anti_aliasing("ssaa")
            _add_body(plotter, view, limits)
            for obstacle in obstacles:
                _add_obstacle(plotter, view, obstacle)
            _add_points(plotter, view, seen)
            _add_slip(plotter, body, view, contacts, seen)
            plotter.enable_parallel_projection()
            plotter.camera_position = [
                centre + 2 * view.size * view.towards,
                centre,
                view.screen[1],
            ]
            plotter.camera.parallel_scale = scale
            plotter.reset_camera_clipping_range()
            picture = np.asarray(plotter.screenshot(return_img=True))
    return picture


def corners_of(view: View) -> Array:
    """Return the corners that must fit into the window, before and after, (points, 3) (length)."""
    points = np.asarray(view.body.points, dtype=float)
    inside = ((points >= view.low) & (points <= view.high)).all(axis=1)
    moved = points[inside] + view.factor * np.asarray(view.body["displacement"])[inside]
    box = np.array(list(product(*zip(view.low, view.high, strict=True))))
    return np.concatenate([box, moved])


def _look(view: View, corners: Array, pixels: int) -> tuple[tuple[int, int], Array, float]:
    """The window's width and height in pixels, its middle, and half its height (length)."""
    right, up = view.screen
    across, along = corners @ right, corners @ up
    width, height = (_MARGIN * max(np.ptp(c), 1e-9 * view.size) for c in (across, along))
    tall = int(pixels * np.clip(height / width, *_HEIGHTS))
    depth = 0.5 * (view.low + view.high) @ view.towards
    middle = [0.5 * (c.min() + c.max()) for c in (across, along)]
    centre = middle[0] * right + middle[1] * up + depth * view.towards
    return (pixels, tall), centre, 0.5 * max(height, width * tall / pixels)


def _add_body(plotter: Plotter, view: View, limits: tuple[float, float]) -> None:
    """The undeformed outline in grey, the deformed body in colour, its cells in white."""
    level = 3 if view.body.n_cells < _FEW_CELLS else 1
    block = cut_to(view.body, view) if view.is_near else view.body
    plotter.add_mesh(outline(block, 1), color="#606060", line_width=2)
    smooth = surface(block, level).warp_by_vector("displacement", factor=view.factor)
    plotter.add_mesh(
        smooth,
        scalars=view.field,
        clim=limits,
        cmap=COLOUR_MAP,
        show_scalar_bar=False,
        ambient=0.6,
        diffuse=0.5,
    )
    cells = surface_edges(view.body)
    cells = cut_to(cells, view) if view.is_near else cells
    cells = cells.warp_by_vector("displacement", factor=view.factor)
    cells.points[:] += 1e-3 * view.size * view.towards  # in front of the faces
    plotter.add_mesh(cells, color="white", line_width=1.5, opacity=0.6)


def cut_to(shape: DataSet, view: View) -> DataSet:
    """Return the part of a shape inside the view."""
    for axis, normal in enumerate("xyz"):
        if shape.n_cells and shape.bounds[2 * axis + 1] > view.high[axis]:
            shape = shape.clip(normal, origin=view.high)
        if shape.n_cells and shape.bounds[2 * axis] < view.low[axis]:
            shape = shape.clip("-" + normal, origin=view.low)
    return shape


def _add_obstacle(plotter: Plotter, view: View, obstacle: ObstacleSurface) -> None:
    """A translucent surface with its rim."""
    import pyvista

    margin = 1e-9 * view.size
    inside = ((obstacle.points >= view.low - margin) & (obstacle.points <= view.high + margin)).all(
        axis=1
    )
    corners = obstacle.pieces[inside[obstacle.pieces].all(axis=1)]
    if len(corners) == 0:
        return
    faces = np.hstack([np.full((len(corners), 1), 3), corners]).ravel()
    shape = pyvista.PolyData(obstacle.at(view.factor), faces)
    plotter.add_mesh(shape, color="#d5d8dc", opacity=0.3, lighting=False)
    rim = shape.extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )
    plotter.add_mesh(rim, color="#202020", line_width=2)


def seen_points(view: View) -> Flags:
    """Return for each node of the body whether it is a visible contact point, (nodes,)."""
    from vtkmodules.vtkCommonCore import mutable
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    points, status = np.asarray(view.body.points), np.asarray(view.body["status"])
    margin = 1e-9 * view.size
    found = ((points >= view.low - margin) & (points <= view.high + margin)).all(axis=1)
    found &= status >= 0
    if not found.any():
        return found
    shape = surface(view.body).warp_by_vector("displacement", factor=view.factor)
    moved = points + view.factor * np.asarray(view.body["displacement"])
    locator: Any = vtkStaticCellLocator()
    locator.SetDataSet(shape)
    locator.BuildLocator()
    share, number, place, inside = mutable(0.0), mutable(0), [0.0] * 3, [0.0] * 3
    width = 1e-5 * view.size  # or lines would slip through between two triangles
    for node in np.flatnonzero(found):
        near = moved[node] + _BEFORE * view.size * view.towards
        far = moved[node] + 4 * view.size * view.towards
        found[node] = not locator.IntersectWithLine(near, far, width, share, place, inside, number)
    return found


def _in_front(view: View, points: Array, steps: float = 1.0) -> Array:
    """So that the surface that points lie on does not hide half of their balls."""
    return points + steps * 0.01 * view.size * view.towards


def _add_points(plotter: Plotter, view: View, seen: Flags) -> None:
    """Contact points where they moved to: balls in the colour of their status, with a rim."""
    import pyvista

    points, status = np.asarray(view.body.points), np.asarray(view.body["status"])
    if not seen.any():
        return
    moved = points + view.factor * np.asarray(view.body["displacement"])
    radius = _radius(points[seen], view.size)
    for mark in view.marks:
        mine = np.isin(status, [_STATUS.index(kind) for kind in mark.status]) & seen
        if not mine.any():
            continue
        cloud = pyvista.PolyData(_in_front(view, moved[mine]))
        rim = "#505050" if mark.status == ("OPEN",) else "white"
        for size, colour, hidden in ((1.0, mark.colour, None), (1.3, rim, "front")):
            ball = pyvista.Sphere(radius=size * radius, theta_resolution=16, phi_resolution=12)
            balls = cloud.glyph(orient=False, scale=False, geom=ball)
            # Of the larger ball only the inside of its far half is drawn, which makes the rim.
            plotter.add_mesh(balls, color=colour, lighting=False, culling=hidden)


def _radius(points: Array, size: float) -> float:
    """Return the radius of balls, less than half the distance of points (length)."""
    if len(points) < 2:
        return _BALL[1] * size
    near, _ = cKDTree(points).query(points, k=2)
    return float(np.clip(0.26 * np.median(near[:, 1]), _BALL[0] * size, _BALL[1] * size))


def _add_slip(
    plotter: Plotter, body: UnstructuredGrid, view: View, contacts: Contacts, seen: Flags
) -> None:
    """Arrows of the slip, where there is some, not at every point where these are close."""
    import pyvista

    drawn = np.asarray(view.body.points)[seen]
    if len(drawn) == 0:
        return
    tree, near = cKDTree(drawn), 1e-9 * view.size

    starts, slips = [], []
    for rows, contact in contacts:
        if not contact.carries_shear:
            continue
        found, nodes = nodes_at(body, rows, contact)
        moved = np.asarray(body.points)[nodes]
        slides = (found.status == "SLIP") & (tree.query(moved)[0] <= near)
        moved = moved + view.factor * np.asarray(body["displacement"])[nodes]
        starts.append(moved[slides])
        slips.append(found.vectors("slip_x", "slip_y", "slip_z")[slides])
    slip = np.concatenate([np.zeros((0, 3)), *slips])
    sizes = np.linalg.norm(slip, axis=1)
    if not sizes.any():
        return
    places = np.concatenate(starts)
    _, shown = np.unique(np.round(places / (_APART * view.size)), axis=0, return_index=True)
    cloud = pyvista.PolyData(_in_front(view, places[shown], 2.5))
    cloud["slip"] = slip[shown] / sizes.max()
    arrow = pyvista.Arrow(tip_length=0.35, tip_radius=0.13, shaft_radius=0.045)
    glyphs = cloud.glyph(orient="slip", scale="slip", factor=_ARROW * view.size, geom=arrow)
    plotter.add_mesh(glyphs, color="black", lighting=False)
