"""Pictures and a page from the files of a run (``fenics-contact report``)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from markupsafe import Markup

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import InputError
from fenics_contact.report.bodies.view_3d import make_view, steps_shown
from fenics_contact.report.contacts.moving import MovingContact
from fenics_contact.report.convergence import draw_convergence
from fenics_contact.report.drawing.fields import read_series, times_of_fields, whole_body
from fenics_contact.report.drawing.figures import Paper, for_paper, style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import in_units
from fenics_contact.report.gallery import draw_pictures, points_of, require
from fenics_contact.report.page.page import Content, page
from fenics_contact.report.page.view_page import ContactSteps, followers, slider_html, view_html
from fenics_contact.report.run_to_draw import axes_of
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.result import read_result
from fenics_contact.scene.writing import SCENE_FILE

PAGE = "report.html"


def write_figures(folder: Path, paper: Paper) -> list[Path]:
    """Draw the pictures of a run for a paper, without a page, into ``figures`` of its folder.

    Args:
        folder: Output folder of a run.
        paper: How they are wanted.

    Returns:
        The files of the figures; the data of curves are beside them.

    Raises:
        InputError: The folder holds no run with an answer, or a file of it cannot be read.
    """
    result = read_result(folder)
    if not (folder / "fields.pvd").exists() or not result.quantities:
        raise InputError(f"{folder}: the run has no answer, so there are no figures of it")
    done = replace(result, steps=[step for step in result.steps if step.quantities])
    with in_units(result.units), for_paper(paper):
        return [paper.file(picture.path) for picture in draw_pictures(folder, done)]


def write_report(folder: Path) -> list[Picture]:
    """Draw the pictures of a run and write ``report.html``, which holds them, beside them.

    Of a run that did not converge they are those of the last load step that was done, if any.

    Args:
        folder: Output folder of a run.

    Returns:
        The pictures that were drawn.

    Raises:
        InputError: The folder holds no run, or a file of it cannot be read; a library is missing.
    """
    result = read_result(folder)
    require("matplotlib", "pyvista", "plotly")
    view, slider, pictures = Markup(), Markup(), []
    with in_units(result.units):
        if (folder / "fields.pvd").exists() and result.quantities:
            # what was done, without a load step that was not
            done = replace(result, steps=[step for step in result.steps if step.quantities])
            body, table = whole_body(folder), points_of(folder, result)
            numbers = steps_shown(len(times_of_fields(folder)), body, done.model)
            steps = ContactSteps(done, table)
            shown = make_view(body, done, table, steps.watched(read_series(folder, numbers)))
            view, pictures = view_html(shown), draw_pictures(folder, done)
            slider = _slider(shown.times, steps.contacts(body), pictures, done)
        with style():
            convergence = draw_convergence(folder, result)
    kept = _is_in(folder, result.scene)
    content = Content(folder.resolve().name, result, kept, pictures, convergence, view, slider)
    replace_file(folder / PAGE, page(content).encode())
    return [*pictures, *convergence]


def _slider(
    times: list[float], contacts: list[MovingContact], pictures: list[Picture], done: RunRecord
) -> Markup:
    """The slider with all that follows it."""
    if len(times) < 2:
        return Markup()
    axes = axes_of(done.model.kinematics)
    return slider_html(times, followers(contacts, axes, pictures, times, done))


def _is_in(folder: Path, scene: str) -> bool:
    """Whether the folder's ``scene.toml`` is the one that was solved, and not the user's own."""
    path = folder / SCENE_FILE
    return path.exists() and path.read_text(encoding="utf-8", errors="replace") == scene
