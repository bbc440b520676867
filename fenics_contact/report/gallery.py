"""Pictures from the files of a run, by matplotlib and pyvista. No MPI, no FEniCSx."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fenics_contact.common.errors import InputError
from fenics_contact.report.bodies.film import MOST_BODIES, Overview, draw_body_film
from fenics_contact.report.bodies.mesh import draw_mesh
from fenics_contact.report.bodies.mode_film import draw_mode_film
from fenics_contact.report.bodies.mode_shapes import draw_mode_shapes
from fenics_contact.report.bodies.picture import draw_body
from fenics_contact.report.bodies.squeal_shapes import draw_squeal_shapes
from fenics_contact.report.contacts.axis_stress import draw_axis_stress
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.displacement import draw_surface_displacement
from fenics_contact.report.contacts.film import FEWEST_STEPS, Film, draw_film, frame_numbers
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.contacts.profile import draw_profile
from fenics_contact.report.contacts.section_stress import draw_section
from fenics_contact.report.drawing.fields import read_body, read_series, times_of_fields
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.paper import wanted
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.units import in_units
from fenics_contact.report.formulas.recognition import AnalyticContact, recognise
from fenics_contact.report.fretting.pictures import draw_fretting
from fenics_contact.report.fretting.table import FrettingTable
from fenics_contact.report.histories.damping import draw_damping
from fenics_contact.report.histories.load_steps import draw_history
from fenics_contact.report.histories.stability import draw_stability
from fenics_contact.report.histories.wear import draw_worn_history
from fenics_contact.results.contact_table import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.scene import Scene

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


@dataclass(frozen=True)
class _Run:
    """What the files of a run hold.

    Attributes:
        folder: Where they are.
        result: The content of ``result.json``.
        table: That of ``contact.csv``.
        body: A pyvista grid with the fields of the last step.
        scene: What was solved; None where it was made of what a file cannot hold.
        analytic: Its formulas, if it has some.
    """

    folder: Path
    result: RunRecord
    table: ContactTable
    body: UnstructuredGrid
    scene: Scene | None
    analytic: AnalyticContact | None

    @property
    def flat(self) -> bool:
        """Whether the model is plane or axisymmetric."""
        return bool(self.result.model.kinematics != "3D")

    @property
    def axes(self) -> str:
        """Letters of the axes."""
        return axes_of(self.result.model.kinematics)

    @property
    def contacts(self) -> list[tuple[ContactTable, ContactRecord]]:
        """Points and entries of the contacts."""
        return [(self.table.of(contact.name), contact) for contact in self.result.contacts]

    @property
    def far(self) -> tuple[str, ...]:
        """Names of supports that are no drives."""
        return far_supports(self.scene)


def axes_of(kinematics: str) -> str:
    """Letters of the axes of a model.

    Args:
        kinematics: Of it.
    """
    return {"3D": "xyz", "axisymmetric": "rz"}.get(kinematics, "xy")


def far_supports(scene: Scene | None) -> tuple[str, ...]:
    """The outer boundary of a half-space, as supports are called: it moves, but is no drive.

    Args:
        scene: What was solved, if it is known.
    """
    if scene is None or scene.half_space is None:
        return ()
    on = scene.half_space.on
    return (*on, ", ".join(on))


def draw_pictures(folder: Path, result: RunRecord) -> list[Picture]:
    """Draw what the files of a run show.

    Args:
        folder: Holds ``contact.csv`` and ``fields.pvd``.
        result: The content of its ``result.json``.

    Returns:
        The deformed body; of each contact pressure and friction, beside formulas where there are
        some, and the stress below it; fretting where it was looked for;
        displacements and stresses along lines of flat models;
        natural modes; curves over the load steps where there are several, and animations where
        there are many;
        the mesh of an adaptive run. Beside each PNG is a PDF of its name.

    Raises:
        InputError: matplotlib, pyvista or a display is missing; says what to install.
    """
    require("matplotlib", "pyvista")
    table, body = ContactTable.read(folder / "contact.csv"), read_body(folder)
    scene = scene_of(folder, result)
    run = _Run(folder, result, table, body, scene, recognise(scene, result, table, body))
    with style(), in_units(result.units):
        return [
            draw_body(body, result, table, folder / "deformed.png"),
            *_of_contacts(run),
            *_along_lines(run),
            *_fretting(run),
            *draw_history(folder, result, run.far),
            *draw_worn_history(folder, result),
            *draw_mode_shapes(folder, result),
            *draw_damping(folder, result),
            *draw_stability(folder, result),
            *draw_squeal_shapes(folder, result),
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


def _of_contacts(run: _Run) -> Iterator[Picture]:
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


def _along_lines(run: _Run) -> Iterator[Picture]:
    """Of flat models: stresses on the axis, if there is one; displacements of the surface."""
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


def _fretting(run: _Run) -> list[Picture]:
    """Criteria of fatigue near the contacts, where the scene asks for them."""
    found = FrettingTable.read(run.folder / "fretting.csv") if run.result.fretting else None
    if found is None:
        return []
    return draw_fretting(run.body, run.contacts, found, run.axes, run.folder)


def _adapted(run: _Run) -> list[Picture]:
    """The last mesh of an adaptive run; in 3D the deformed body shows it."""
    if not run.result.levels or not run.flat:
        return []
    return [draw_mesh(run.body, run.result, run.table, run.folder / "mesh.png")]


def _animations(run: _Run) -> Iterator[Picture]:
    """Modes; the body and each contact that ever touches over the load steps, if there are many."""
    if wanted() is not None:  # they are no vectors
        return
    yield from draw_mode_film(run.folder, run.result)
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
