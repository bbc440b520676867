"""The picture of the deformed body. pyvista, and only here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.body_view import MARGINS, View, choose_view
from fenics_contact.contact_table import ContactTable
from fenics_contact.display import display
from fenics_contact.picture_style import COLOUR_MAP
from fenics_contact.writing import replaced_file

Array = NDArray[np.float64]

_FIELD_STATUS = ("OPEN", "STICK", "SLIP")  # values 0, 1, 2 of the field `status`


def read_body(folder: Path) -> Any:
    """The body as a pyvista grid with the fields of the last step in ``fields.pvd``."""
    ((_, body),) = read_series(folder, [len(times_of_fields(folder)) - 1])
    return body


def times_of_fields(folder: Path) -> list[float]:
    """Pseudo-times of the steps in ``fields.pvd``."""
    import pyvista

    return list(pyvista.get_reader(str(folder / "fields.pvd")).time_values)


def read_series(folder: Path, numbers: Iterable[int]) -> Iterator[tuple[float, Any]]:
    """Pseudo-times of steps in ``fields.pvd``, by number, and the body with their fields."""
    import pyvista

    reader = pyvista.get_reader(str(folder / "fields.pvd"))
    for number in numbers:
        time = reader.time_values[number]
        reader.set_active_time_value(time)
        yield time, reader.read().combine()


def draw_body(body: Any, result: dict[str, Any], table: ContactTable, path: Path) -> Path:
    """Draw the deformed mesh over the undeformed outline, with the contact points' status.

    Where the contact zone is small in the body, only its neighbourhood is drawn.

    Args:
        body: As ``read_body`` returns it.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        path: PNG file to write.

    Raises:
        InputError: A display is missing; says what to install.
    """
    with display():
        import pyvista
        from PIL import Image

        body["von Mises stress"] = _von_mises(body["stress"])
        view = choose_view(body, result, table)
        plotter = pyvista.Plotter(off_screen=True, window_size=view.window)
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        _add_body(plotter, view)
        _add_points(plotter, view)
        where = " near the contact" if view.is_near else ""
        times = "" if view.factor == 1 else f", displacements x {view.factor:g}"
        through = ", contact points seen through the bodies" if view.hides else ""
        plotter.add_text(f"Deformed mesh{where}{times}{through}", font_size=11, color="black")
        _look(plotter, view)
        picture = Image.fromarray(plotter.screenshot(return_img=True))
        with replaced_file(path) as temporary:
            picture.save(temporary)
        plotter.close()
    return path


def _look(plotter: Any, view: View) -> None:
    """Fill the window, leaving room for the title above and the colour bar below."""
    camera = plotter.camera
    up = np.array([0, 1, 0] if view.flat else [0, 0, 1])
    plotter.enable_parallel_projection()
    centre = (view.low + view.high) / 2
    plotter.camera_position = [centre + 2 * view.size * view.towards, centre, up]
    plotter.reset_camera()
    if view.flat:
        camera.parallel_scale = view.scale
    else:
        camera.zoom(0.85)
    across = up - (up @ view.towards) * view.towards
    down = camera.parallel_scale * (MARGINS[0] - MARGINS[1]) * across / np.linalg.norm(across)
    camera.focal_point = centre - down
    camera.position = centre - down + 2 * view.size * view.towards
    plotter.reset_camera_clipping_range()


def _add_body(plotter: Any, view: View) -> None:
    """The undeformed outline in grey, the deformed body in colour, its cells in white."""
    smooth = _cut(_surface(view.body, subdivision=3), view)
    plotter.add_mesh(_edges(_cut(_surface(view.body), view)), color="grey", line_width=2)
    smooth = smooth.warp_by_vector("displacement", factor=view.factor)
    low, high, beyond = _colour_range(view.body["von Mises stress"])
    bar = {
        "title": f"von Mises stress{beyond}\n",  # the line break keeps it off the numbers
        "color": "black",
        "width": 0.5,
        "height": 80 / view.window[1],
        "position_x": 0.25,
        "position_y": 17 / view.window[1],
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


def _cut(surface: Any, view: View) -> Any:
    """What lies inside the view; a body in space keeps its cells whole."""
    if not (view.flat and view.is_near):
        return surface
    for normal in ("x", "y"):
        surface = surface.clip(normal, origin=view.high)
        surface = surface.clip("-" + normal, origin=view.low)
    return surface


def _edges(surface: Any) -> Any:
    return surface.extract_feature_edges(
        boundary_edges=True, feature_edges=True, manifold_edges=False, non_manifold_edges=False
    )


def _add_points(plotter: Any, view: View) -> None:
    """Contact points where they moved to, coloured by status."""
    import pyvista

    points, status = view.body.points, view.body["status"]
    margin = 1e-9 * view.size
    inside = ((points >= view.low - margin) & (points <= view.high + margin)).all(axis=1)
    moved = points + view.factor * view.body["displacement"]
    size = 24 if (inside & (status >= 0)).sum() < 60 else 16
    nearer = (1.0 if view.hides else 0.01) * view.size  # so that none is hidden
    entries = []
    for mark in view.marks:
        mine = np.isin(status, [_FIELD_STATUS.index(kind) for kind in mark.status]) & inside
        if mine.any():
            in_front = moved[mine] + nearer * view.towards
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
        plotter.add_legend(entries, bcolor=None, face="circle", size=(0.1, 67 / view.window[1]))


def _von_mises(stress: Array) -> Array:
    tensor = stress.reshape(-1, 3, 3)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)))
