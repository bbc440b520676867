"""The room for pictures: PNG files from the files of a run. No MPI, no FEniCSx.

matplotlib draws curves, pyvista the deformed body.
"""

from __future__ import annotations

import csv
import importlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.errors import InputError

# Legible in grey as well: stick dark and filled, slip light and open.
COLOURS = {"STICK": "#1b4f72", "SLIP": "#e67e22", "OPEN": "#aab7b8"}
_FIELD_STATUS = ("OPEN", "STICK", "SLIP")  # values 0, 1, 2 of the field `status`
_LARGEST_MOVE = 0.06  # of the body's size, in the picture of the deformed mesh
_WINDOW = (1400, 560)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactTable:
    """The rows of ``contact.csv`` as columns."""

    contact: NDArray[np.str_]
    status: NDArray[np.str_]
    numbers: dict[str, Array]

    @classmethod
    def read(cls, path: Path) -> ContactTable:
        """Read a ``contact.csv``."""
        try:
            with path.open(newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        words = ("contact", "status")
        names = [name for name in (rows[0] if rows else {}) if name not in words]
        return cls(
            contact=np.array([row["contact"] for row in rows]),
            status=np.array([row["status"] for row in rows]),
            numbers={name: np.array([float(row[name]) for row in rows]) for name in names},
        )

    def of(self, contact: str) -> ContactTable:
        """The rows of one contact."""
        mine = self.contact == contact
        numbers = {name: column[mine] for name, column in self.numbers.items()}
        return ContactTable(self.contact[mine], self.status[mine], numbers)

    def vectors(self, *names: str) -> Array:
        """Columns side by side, shape (rows, names)."""
        return np.stack([self.numbers[name] for name in names], axis=1)


def draw_pictures(folder: Path, result: dict[str, Any]) -> list[Path]:
    """Draw what the files of a run show.

    Args:
        folder: Holds ``contact.csv`` and ``fields.pvd``.
        result: The content of its ``result.json``.

    Returns:
        The PNG files drawn.

    Raises:
        InputError: matplotlib, pyvista or a display is missing; says what to install.
    """
    for library in ("matplotlib", "pyvista"):
        try:
            importlib.import_module(library)
        except ImportError:
            raise InputError(
                f"pictures need {library}: install it with pip install 'fenics-contact[pictures]'"
            ) from None
    table = ContactTable.read(folder / "contact.csv")
    flat = result["model"]["kinematics"] != "3D"
    drawn = []
    for number, contact in enumerate(result["contacts"]):
        path = folder / f"contact_{number}.png"
        draw = _draw_curve if flat else _draw_surface
        draw(table.of(contact["name"]), contact, result, path)
        drawn.append(path)
    drawn.append(_draw_body(folder, result, folder / "deformed.png"))
    return drawn


def _figure(title: str, size: tuple[float, float]) -> tuple[Any, Any]:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=size, layout="constrained")
    axes.set_title(title.replace("$", r"\$"), loc="left", fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _draw_curve(rows: ContactTable, contact: dict[str, Any], result: Any, path: Path) -> None:
    """Friction traction along a contact line, stick and slip marked (paper, Fig. 2)."""
    points = rows.vectors("x", "y")
    axis = int(np.argmax(np.ptp(points, axis=0)))
    tangents = np.stack([rows.numbers["ny"], -rows.numbers["nx"]], axis=1)
    # Positive along the axis of the plot, whichever side the body lies on.
    tangents *= np.where(tangents[:, axis] < 0, -1.0, 1.0)[:, None]
    traction = np.sum(rows.vectors("traction_x", "traction_y") * tangents, axis=1)
    order = np.argsort(points[:, axis])
    position, traction, status = points[order, axis], traction[order], rows.status[order]

    figure, axes = _figure(f"Friction traction on '{contact['name']}'", (7.2, 3.6))
    axes.plot(position, traction, color="0.6", linewidth=1, zorder=1)
    for kind, colour in COLOURS.items():
        mine = status == kind
        if mine.any():
            axes.plot(
                position[mine],
                traction[mine],
                "o" if kind == "STICK" else "s",
                color=colour,
                markerfacecolor=colour if kind == "STICK" else "white",
                markersize=5 if len(position) < 100 else 3,
                label=f"{kind.lower()} ({int(mine.sum())} points)",
                zorder=2,
            )
    _mark_bound(axes, rows, contact, order, position, traction)
    axes.axhline(0, color="black", linewidth=0.6)
    names = ("r", "z") if result["model"]["kinematics"] == "axisymmetric" else ("x", "y")
    axes.set_xlabel(f"position along the surface, ${names[axis]}$")
    axes.set_ylabel(r"friction traction on the body, $\sigma_T$")
    axes.legend(frameon=False, fontsize=9)
    figure.savefig(path, dpi=150)
    _close(figure)


def _mark_bound(
    axes: Any, rows: ContactTable, contact: Any, order: Any, position: Array, traction: Array
) -> None:
    """The friction bound ±g, on the side (or sides) where the traction lies."""
    coefficient = contact["parameters"]["friction_coefficient"]
    if not isinstance(coefficient, float | int) or coefficient == 0:
        return
    bound = coefficient * rows.numbers["contact_pressure"][order]
    label: str | None = r"bound $\pm g = \pm\mu p$"
    for side in (1, -1):
        if (side * traction > 0.02 * bound.max()).any():
            axes.plot(position, side * bound, "--", color="0.3", linewidth=1, label=label)
            label = None


def _draw_surface(rows: ContactTable, contact: dict[str, Any], result: Any, path: Path) -> None:
    """Friction traction on a contact surface: size as colour, status as marker."""
    points = rows.vectors("x", "y", "z")
    axes_shown = np.sort(np.argsort(np.ptp(points, axis=0))[-2:])
    traction = rows.vectors("traction_x", "traction_y", "traction_z")
    size = np.linalg.norm(traction, axis=1)
    figure, axes = _figure(f"Friction traction on '{contact['name']}'", (6.0, 5.0))
    first, second = points[:, axes_shown].T
    shown = None
    for kind, marker in (("STICK", "o"), ("SLIP", "s"), ("OPEN", "x")):
        mine = rows.status == kind
        if mine.any():
            shown = axes.scatter(
                first[mine],
                second[mine],
                c=size[mine],
                marker=marker,
                vmin=0,
                vmax=size.max() or 1,
                cmap="viridis",
                label=f"{kind.lower()} ({int(mine.sum())} points)",
            )
    axes.quiver(first, second, *traction[:, axes_shown].T, color="0.2", width=0.003)
    axes.set_aspect("equal")
    axes.set_xlabel(f"${'xyz'[axes_shown[0]]}$")
    axes.set_ylabel(f"${'xyz'[axes_shown[1]]}$")
    if shown is not None:
        figure.colorbar(shown, label=r"$|\sigma_T|$")
    axes.legend(frameon=False, fontsize=9, loc="upper left", bbox_to_anchor=(0, -0.1), ncols=3)
    figure.savefig(path, dpi=150)
    _close(figure)


def _close(figure: Any) -> None:
    import matplotlib.pyplot as plt

    plt.close(figure)


def _draw_body(folder: Path, result: Any, path: Path) -> Path:
    """The deformed mesh over the undeformed outline, with the contact points' status."""
    with _display():
        import pyvista

        body = pyvista.get_reader(str(folder / "fields.pvd")).read().combine()
        largest = np.linalg.norm(body["displacement"], axis=1).max()
        factor = _round_factor(_LARGEST_MOVE * body.length / largest) if largest > 0 else 1.0
        body["von Mises stress"] = _von_mises(body["stress"])
        plotter = pyvista.Plotter(off_screen=True, window_size=_WINDOW)
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        _add_body(plotter, body, factor)
        _add_points(plotter, body, factor)
        times = "" if factor == 1 else f", displacements x {factor:g}"
        plotter.add_text(f"Deformed mesh{times}", font_size=11, color="black")
        _look(plotter, body, flat=result["model"]["kinematics"] != "3D")
        plotter.screenshot(str(path))
        plotter.close()
    return path


def _look(plotter: Any, body: Any, flat: bool) -> None:
    """Fill the window, leaving room for the title above and the colour bar below."""
    plotter.enable_parallel_projection()
    plotter.camera_position = "xy" if flat else "iso"
    if not flat:
        plotter.camera.zoom(0.8)
    else:
        left, right, low, high = body.bounds[:4]
        across = 1.15 * (right - left) * _WINDOW[1] / _WINDOW[0]
        plotter.camera.parallel_scale = 0.5 * max(across, 1.7 * (high - low))


def _add_body(plotter: Any, body: Any, factor: float) -> None:
    """The undeformed outline in grey, the deformed body in colour, its cells in white."""
    plotter.add_mesh(_edges(_surface(body)), color="grey", line_width=2)
    smooth = _surface(body, subdivision=3).warp_by_vector("displacement", factor=factor)
    bar = {
        "title": "von Mises stress\n",  # the line break keeps it off the numbers
        "color": "black",
        "width": 0.5,
        "height": 0.14,
        "position_x": 0.25,
        "position_y": 0.03,
        "title_font_size": 16,
        "label_font_size": 14,
        "n_labels": 5,
        "fmt": "%.3g",
    }
    plotter.add_mesh(smooth, scalars="von Mises stress", cmap="viridis", scalar_bar_args=bar)
    cells = _edges(_surface(body.separate_cells(), subdivision=3))
    cells = cells.warp_by_vector("displacement", factor=factor)
    cells.points[:, 2] += 1e-4 * body.length  # in front of the faces of a flat body
    plotter.add_mesh(cells, color="white", line_width=2)


def _surface(grid: Any, subdivision: int = 1) -> Any:
    """Surface of a grid; curved cells are subdivided."""
    import pyvista
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    surface.SetNonlinearSubdivisionLevel(subdivision)
    surface.Update()
    return pyvista.wrap(surface.GetOutput())


def _edges(surface: Any) -> Any:
    return surface.extract_feature_edges(
        boundary_edges=True, feature_edges=True, manifold_edges=False, non_manifold_edges=False
    )


def _add_points(plotter: Any, body: Any, factor: float) -> None:
    """Contact points where they moved to, coloured by status."""
    import pyvista

    moved = body.points + factor * body["displacement"]
    entries = []
    for value, kind in enumerate(_FIELD_STATUS):
        mine = body["status"] == value
        if mine.any():
            cloud = pyvista.PolyData(moved[mine] + [0, 0, 2e-4 * body.length])
            plotter.add_mesh(cloud, color=COLOURS[kind], point_size=18, lighting=False)
            entries.append([f" {kind.lower()}", COLOURS[kind]])
    if entries:
        plotter.add_legend(entries, bcolor=None, face="circle", size=(0.1, 0.12))


def _von_mises(stress: Array) -> Array:
    tensor = stress.reshape(-1, 3, 3)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))


def _round_factor(factor: float) -> float:
    """A magnification people can read: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step * power <= factor * 1.000001))


@contextmanager
def _display() -> Iterator[None]:
    """Somewhere for VTK to draw: without one, its Debian build crashes beyond catching."""
    from vtkmodules import vtkRenderingOpenGL2

    has_own = hasattr(vtkRenderingOpenGL2, "vtkEGLRenderWindow")
    if has_own or os.environ.get("DISPLAY") or sys.platform != "linux":
        if has_own and not os.environ.get("DISPLAY"):
            os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
        yield
        return
    program = shutil.which("Xvfb")
    if program is None:
        raise InputError("pictures need a display: install Xvfb (Debian: apt install xvfb)")
    server = subprocess.Popen(
        [program, "-displayfd", "1", "-nolisten", "tcp", "-screen", "0", "1600x1200x24"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert server.stdout is not None
        os.environ["DISPLAY"] = f":{server.stdout.readline().strip()}"
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        server.terminate()
        server.wait()
