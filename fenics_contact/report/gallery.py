"""Pictures from the files of a run, by matplotlib and pyvista. No MPI, no FEniCSx."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fenics_contact.analyses import registry
from fenics_contact.common.errors import InputError
from fenics_contact.report.bodies.film import MOST_BODIES, Overview, draw_body_film
from fenics_contact.report.bodies.picture import draw_body, draw_temperatures
from fenics_contact.report.contacts.curves import draw_curves, draw_profile
from fenics_contact.report.contacts.depth_curves import draw_axis_stress, draw_surface_displacement
from fenics_contact.report.contacts.film import FEWEST_STEPS, Film, draw_film, frame_numbers
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.contacts.section_stress import draw_section
from fenics_contact.report.convergence import draw_mesh
from fenics_contact.report.drawing.fields import read_body, read_series, times_of_fields
from fenics_contact.report.drawing.figures import style, wanted
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import in_units
from fenics_contact.report.load_steps import draw_history, draw_worn_history
from fenics_contact.report.recognition import recognise
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.run import RunRecord
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.scene import Scene

if TYPE_CHECKING:
    pass


def draw_pictures(folder: Path, result: RunRecord) -> list[Picture]:
    """Draw what the files of a run show.

    Args:
        folder: Holds ``contact.csv`` and ``fields.pvd``.
        result: The content of its ``result.json``.

    Returns:
        The deformed body, and its temperatures where it has such; of each contact pressure and
        friction, beside formulas where there are some, and the stress below it; displacements and
        stresses along lines of flat models; curves over the load steps where there are several;
        what analyses of the scene have found; animations where there are many load steps;
        the mesh of an adaptive run. Beside each PNG is a PDF of its name.

    Raises:
        InputError: matplotlib, pyvista or a display is missing; says what to install.
    """
    require("matplotlib", "pyvista")
    table, body = ContactTable.read(folder / "contact.csv"), read_body(folder)
    scene = scene_of(folder, result)
    run = RunToDraw(folder, result, table, body, scene, recognise(scene, result, table, body))
    with style(), in_units(result.units):
        return [
            draw_body(body, result, table, folder / "deformed.png"),
            *_temperatures(run),
            *_of_contacts(run),
            *_along_lines(run),
            *draw_history(folder, result, run.far),
            *draw_worn_history(folder, result),
            *_of_analyses(run),
            *_animations(run),
            *_adapted(run),
        ]


def require(*libraries: str) -> None:
    """Whether libraries for pictures are there.

    Raises:
        InputError: One is not; says what to install.
    """
    for library in libraries:
        try:
            importlib.import_module(library)
        except ImportError:
            raise InputError(
                f"pictures need {library}: install it with pip install 'fenics-contact[pictures]'"
            ) from None


def scene_of(folder: Path, result: RunRecord) -> Scene | None:
    """The scene that was solved, None where it cannot be run again.

    Args:
        folder: Of the run.
        result: The content of its ``result.json``.
    """
    try:
        return scene_of_text(result.scene, folder / "result.json")
    except InputError:  # made in Python, of what a file cannot hold
        return None


def points_of(folder: Path, result: RunRecord) -> ContactTable:
    """The contact points of a run.

    Args:
        folder: Of the run.
        result: The content of its ``result.json``.

    Raises:
        InputError: Some are missing, or the file cannot be read.
    """
    path, number = folder / "contact.csv", result.model.contact_points
    table = ContactTable.read(path)
    if len(table.status) != number:
        there = f"it has {len(table.status)} points, but the run had {number}"
        raise InputError(f"{path}: damaged: {there}; make the run again")
    return table


def _temperatures(run: RunToDraw) -> Iterator[Picture]:
    """Yield the temperatures of the bodies, if they have such."""
    if "temperature" in run.body.point_data:
        yield draw_temperatures(run.body, run.result, run.folder / "temperature.png")


def _of_contacts(run: RunToDraw) -> Iterator[Picture]:
    """Pressure and friction of each contact, and the stress below."""
    for number, (rows, contact) in enumerate(run.contacts):
        path, analytic = run.folder / f"contact_{number}.png", run.analytic
        if run.flat:
            yield draw_curves(run.body, rows, contact, run.axes, path, analytic)
        else:
            yield draw_maps(run.body, rows, contact, path)
            if analytic is not None:
                profile = run.folder / f"contact_{number}_formula.png"
                yield draw_profile(rows, contact, analytic, profile)
        path = run.folder / f"stress_{number}.png"
        if not contact.pressure_is_given:
            below = draw_section(run.body, run.result, rows, contact, path, analytic)
            if below is not None:
                yield below


def _along_lines(run: RunToDraw) -> Iterator[Picture]:
    """Yield pictures of flat models: stresses on an axis, and displacements of the surface."""
    contacts = run.result.contacts
    if not contacts or not run.flat:
        return
    if run.axes == "rz":
        rows, contact = run.contacts[0]
        path = run.folder / "axis_stress.png"
        below = draw_axis_stress(run.body, rows, contact, path, run.analytic)
        if below is not None:
            yield below
    path = run.folder / "surface_displacement.png"
    yield draw_surface_displacement(run.body, run.table, contacts, run.axes, path)


def _of_analyses(run: RunToDraw) -> Iterator[Picture]:
    """Yield the pictures of the scene's analyses."""
    for part in registry.parts_of_result(run.result, "page"):
        yield from part.PAGE.pictures(run)


def _adapted(run: RunToDraw) -> list[Picture]:
    """The last mesh of an adaptive run; in 3D the deformed body shows it."""
    if not run.result.levels or not run.flat:
        return []
    return [draw_mesh(run.body, run.result, run.table, run.folder / "mesh.png")]


def _animations(run: RunToDraw) -> Iterator[Picture]:
    """Modes; the body and each contact that ever touches over the load steps, if there are many."""
    if wanted() is not None:  # they are no vectors
        return
    for part in registry.parts_of_result(run.result, "page"):
        yield from part.PAGE.animations(run)
    steps = len(times_of_fields(run.folder))
    if steps < FEWEST_STEPS:
        return
    numbers = frame_numbers(steps).tolist()
    fewer = frame_numbers(steps, MOST_BODIES).tolist()
    bodies = (body for _, body in read_series(run.folder, fewer))
    overview = Overview.of(bodies, run.result, run.table)
    series = read_series(run.folder, fewer)
    path = run.folder / "animation_body.gif"
    if overview is not None:
        yield draw_body_film(series, overview, run.body, run.contacts, path)
    for number, (rows, contact) in enumerate(run.contacts):
        series = read_series(run.folder, numbers)
        film = Film.of(series, rows, contact, run.result, run.far)
        if film.touches:
            path = run.folder / f"animation_{number}.gif"
            yield draw_film(film, run.flat, run.axes, path)
