"""The picture of the deformed body. pyvista, and only here."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_table import ContactTable
from fenics_contact.display import display
from fenics_contact.picture_style import COLOUR_MAP, Mark, marks, neighbourhood

Array = NDArray[np.float64]

_FIELD_STATUS = ("OPEN", "STICK", "SLIP")  # values 0, 1, 2 of the field `status`
_MOVE = 0.06  # of what is shown: the largest displacement, where it is magnified
_READABLE = (0.02, 0.2)  # displacements of this size, over what is shown, are drawn as they are
_SMALL = 0.15  # contact zones smaller than this share of the body are looked at from near by
_WIDTH, _HEIGHTS = 1400, (560, 1000)  # of the window, in pixels
_MARGINS = (0.24, 0.14)  # share of the window below the body, for the colour bar, and above


@dataclass(frozen=True)
class _View:
    """What is shown of the body, and from where.

    Attributes:
        body: The cells shown, with all fields.
        low: Lowest coordinates shown, (3,).
        high: Highest coordinates shown, (3,).
        is_near: Whether only the neighbourhood of the contact is shown.
        flat: Whether the model is plane or axisymmetric.
        towards: From the body to the camera, (3,).
        marks: How contact points look.
    """

    body: Any
    low: Array
    high: Array
    is_near: bool
    flat: bool
    towards: Array
    marks: tuple[Mark, ...]

    @property
    def size(self) -> float:
        """Diagonal of what is shown (length)."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def factor(self) -> float:
        """Magnification of the displacements."""
        largest = np.linalg.norm(self.body["displacement"], axis=1).max()
        if largest == 0 or _READABLE[0] <= largest / self.size <= _READABLE[1]:
            return 1.0
        return _round_factor(_MOVE * self.size / largest)


def draw_body(folder: Path, result: dict[str, Any], table: ContactTable, path: Path) -> Path:
    """Draw the deformed mesh over the undeformed outline, with the contact points' status.

    Where the contact zone is small in the body, only its neighbourhood is drawn.

    Args:
        folder: Holds ``fields.pvd``.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        path: PNG file to write.

    Raises:
        InputError: A display is missing; says what to install.
    """
    with display():
        import pyvista

        body = pyvista.get_reader(str(folder / "fields.pvd")).read().combine()
        body["von Mises stress"] = _von_mises(body["stress"])
        view = _view(body, result, table)
        height, scale = _window(view)
        plotter = pyvista.Plotter(off_screen=True, window_size=(_WIDTH, height))
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        _add_body(plotter, view, height)
        _add_points(plotter, view, height)
        where = " near the contact" if view.is_near else ""
        times = "" if view.factor == 1 else f", displacements x {view.factor:g}"
        plotter.add_text(f"Deformed mesh{where}{times}", font_size=11, color="black")
        _look(plotter, view, scale)
        plotter.screenshot(str(path))
        plotter.close()
    return path


def _view(body: Any, result: dict[str, Any], table: ContactTable) -> _View:
    """The whole body, or the neighbourhood of a contact zone that is small in it."""
    low, high = np.array(body.bounds).reshape(3, 2).T
    flat = result["model"]["kinematics"] != "3D"
    laws = {contact["law"] for contact in result["contacts"]}
    looks = marks("none" if laws <= {"none"} else "static")
    on_contact = body["status"] >= 0
    is_near = False
    if on_contact.any():
        closed = body["status"][on_contact] > 0
        around = neighbourhood(body.points[on_contact], closed)
        near = np.maximum(low, around[0]), np.minimum(high, around[1])
        zone = np.ptp(body.points[on_contact][closed], axis=0).max() if closed.any() else np.inf
        is_near = bool(zone < _SMALL * (high - low).max())
    if not is_near:
        return _View(body, low, high, False, flat, _towards(flat, table, np.zeros(3)), looks)
    aside = np.sign(np.round(((near[0] + near[1]) - (low + high)) / (high - low).max(), 1))
    inside = ((body.points >= near[0]) & (body.points <= near[1])).all(axis=1)
    body = body.extract_points(inside, adjacent_cells=True, include_cells=True)
    return _View(body, *near, True, flat, _towards(flat, table, aside), looks)


def _towards(flat: bool, table: ContactTable, aside: Array) -> Array:
    """Where the camera stands: before the contact surface, and on its side of the body."""
    if flat:
        return np.array([0.0, 0.0, 1.0])
    normal = table.vectors("nx", "ny", "nz").mean(axis=0) if len(table.status) else np.zeros(3)
    side = np.where(np.abs(normal) > 0.1, np.sign(normal), np.where(aside == 0, 1.0, aside))
    return side / np.sqrt(3)


def _window(view: _View) -> tuple[int, float]:
    """Height of the window in pixels, and half of what it shows from top to bottom (length)."""
    if not view.flat:
        return _HEIGHTS[0 if not view.is_near else 1], 0.0
    across, up = 1.15 * (view.high - view.low)[0], (view.high - view.low)[1]
    shown = 1 - sum(_MARGINS)
    height = int(np.clip(_WIDTH * up / across / shown, *_HEIGHTS))
    return height, 0.5 * float(max(across * height / _WIDTH, up / shown))


def _look(plotter: Any, view: _View, scale: float) -> None:
    """Fill the window, leaving room for the title above and the colour bar below."""
    plotter.enable_parallel_projection()
    centre = (view.low + view.high) / 2
    if view.flat:
        centre[1] -= scale * (_MARGINS[0] - _MARGINS[1])
    up = (0, 1, 0) if view.flat else (0, 0, 1)
    plotter.camera_position = [centre + 2 * view.size * view.towards, centre, up]
    plotter.reset_camera()
    if view.flat:
        plotter.camera.focal_point = centre
        plotter.camera.position = centre + 2 * view.size * view.towards
        plotter.camera.parallel_scale = scale
    else:
        plotter.camera.zoom(0.8)
    plotter.reset_camera_clipping_range()


def _add_body(plotter: Any, view: _View, height: int) -> None:
    """The undeformed outline in grey, the deformed body in colour, its cells in white."""
    smooth = _cut(_surface(view.body, subdivision=3), view)
    plotter.add_mesh(_edges(_cut(_surface(view.body), view)), color="grey", line_width=2)
    smooth = smooth.warp_by_vector("displacement", factor=view.factor)
    low, high, beyond = _colour_range(view.body["von Mises stress"])
    bar = {
        "title": f"von Mises stress{beyond}\n",  # the line break keeps it off the numbers
        "color": "black",
        "width": 0.5,
        "height": 80 / height,
        "position_x": 0.25,
        "position_y": 17 / height,
        "title_font_size": 16,
        "label_font_size": 14,
        "n_labels": 5,
        "fmt": "%.3g",
    }
    plotter.add_mesh(
        smooth,
        scalars="von Mises stress",
        clim=(low, high),
        cmap=COLOUR_MAP,
        scalar_bar_args=bar,
        lighting=not view.flat,
        ambient=0.35,
        diffuse=0.75,
    )
    cells = _cut(_edges(_surface(view.body.separate_cells(), subdivision=3)), view)
    cells = cells.warp_by_vector("displacement", factor=view.factor)
    cells.points[:] += 1e-4 * view.size * view.towards  # in front of the faces
    plotter.add_mesh(cells, color="white", line_width=2)


def _colour_range(stress: Array) -> tuple[float, float, str]:
    """Ends of the colours; the stress at a few points alone is beyond, which is said then."""
    low, most, high = np.percentile(stress, [0, 95, 100])
    low = 0.0 if low < 0.05 * high else float(low)
    if high > 3 * most:
        return low, float(most), f" (at single points up to {high:.3g})"
    return low, float(high), ""


def _surface(grid: Any, subdivision: int = 1) -> Any:
    """Surface of a grid; curved cells are subdivided."""
    import pyvista
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    surface.SetNonlinearSubdivisionLevel(subdivision)
    surface.Update()
    return pyvista.wrap(surface.GetOutput())


def _cut(surface: Any, view: _View) -> Any:
    """What lies inside the view; a body in space keeps its cells whole."""
    if not (view.flat and view.is_near):
        return surface
    for axis, normal in enumerate(("x", "y")):
        surface = surface.clip(normal, origin=view.high)
        surface = surface.clip("-" + normal, origin=view.low)
    return surface


def _edges(surface: Any) -> Any:
    return surface.extract_feature_edges(
        boundary_edges=True, feature_edges=True, manifold_edges=False, non_manifold_edges=False
    )


def _add_points(plotter: Any, view: _View, height: int) -> None:
    """Contact points where they moved to, coloured by status."""
    import pyvista

    points, status = view.body.points, view.body["status"]
    inside = ((points >= view.low - 1e-9) & (points <= view.high + 1e-9)).all(axis=1)
    moved = points + view.factor * view.body["displacement"]
    size = 24 if (inside & (status >= 0)).sum() < 60 else 16
    entries = []
    for mark in view.marks:
        mine = np.isin(status, [_FIELD_STATUS.index(kind) for kind in mark.status]) & inside
        if mine.any():
            in_front = moved[mine] + 0.01 * view.size * view.towards  # so that none is hidden
            cloud = pyvista.PolyData(in_front)
            plotter.add_mesh(
                cloud,
                color=mark.colour,
                point_size=size,
                lighting=False,
                render_points_as_spheres=True,
            )
            entries.append([f" {mark.label}", mark.colour])
    if entries:
        plotter.add_legend(entries, bcolor=None, face="circle", size=(0.1, 67 / height))


def _von_mises(stress: Array) -> Array:
    tensor = stress.reshape(-1, 3, 3)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))


def _round_factor(factor: float) -> float:
    """A magnification people can read: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step * power <= factor * 1.000001))
