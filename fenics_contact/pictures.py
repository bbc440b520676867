"""Pictures from the files of a run, by matplotlib and pyvista. No MPI, no FEniCSx."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from fenics_contact.animation import FEWEST_STEPS, Film, draw_film, frame_numbers
from fenics_contact.axis_stress import draw_axis_stress
from fenics_contact.body_picture import draw_body, read_body, read_series, times_of_fields
from fenics_contact.contact_table import ContactTable
from fenics_contact.curves import draw_curves
from fenics_contact.errors import InputError
from fenics_contact.history_pictures import draw_history
from fenics_contact.mesh_picture import draw_mesh
from fenics_contact.surface_displacement import draw_surface_displacement
from fenics_contact.surface_maps import draw_maps


def draw_pictures(folder: Path, result: dict[str, Any]) -> list[Path]:
    """Draw what the files of a run show.

    Args:
        folder: Holds ``contact.csv`` and ``fields.pvd``.
        result: The content of its ``result.json``.

    Returns:
        The files drawn: one a contact, displacements and stresses along lines of flat models,
        the deformed body, the mesh of an adaptive run, curves over the load steps where there are
        several, and animations of the contacts where there are many.

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
    table, body = ContactTable.read(folder / "contact.csv"), read_body(folder)
    drawn = [
        *_contacts(folder, result, table),
        *_along_lines(folder, result, table, body),
        draw_body(body, result, table, folder / "deformed.png"),
        *_adapted(folder, result, table, body),
        *draw_history(folder, result),
        *_animations(folder, result, table),
    ]
    return drawn


def _axes(result: dict[str, Any]) -> str:
    return "rz" if result["model"]["kinematics"] == "axisymmetric" else "xy"


def _contacts(folder: Path, result: dict[str, Any], table: ContactTable) -> list[Path]:
    """Pressure and friction of each contact."""
    drawn = []
    for number, contact in enumerate(result["contacts"]):
        path = folder / f"contact_{number}.png"
        rows = table.of(contact["name"])
        if result["model"]["kinematics"] == "3D":
            draw_maps(rows, contact, path)
        else:
            draw_curves(rows, contact, _axes(result), path)
        drawn.append(path)
    return drawn


def _adapted(folder: Path, result: dict[str, Any], table: ContactTable, body: Any) -> list[Path]:
    """The last mesh of an adaptive run; in 3D the deformed body shows it."""
    if not result.get("levels") or result["model"]["kinematics"] == "3D":
        return []
    return [draw_mesh(body, result, table, folder / "mesh.png")]


def _animations(folder: Path, result: dict[str, Any], table: ContactTable) -> list[Path]:
    """Each contact over the load steps, if there are many."""
    steps = len(times_of_fields(folder))
    if steps < FEWEST_STEPS:
        return []
    flat, drawn = result["model"]["kinematics"] != "3D", []
    for number, contact in enumerate(result["contacts"]):
        series = read_series(folder, frame_numbers(steps).tolist())
        film = Film.of(series, table.of(contact["name"]), contact, result)
        path = folder / f"animation_{number}.gif"
        drawn.append(draw_film(film, flat, _axes(result) if flat else "xyz", path))
    return drawn


def _along_lines(
    folder: Path, result: dict[str, Any], table: ContactTable, body: Any
) -> list[Path]:
    """Of flat models: displacements of the surface; stresses on the axis, if there is one."""
    contacts, kinematics = result["contacts"], result["model"]["kinematics"]
    if not contacts or kinematics == "3D":
        return []
    path = folder / "surface_displacement.png"
    drawn = [draw_surface_displacement(body, table, contacts, _axes(result), path)]
    if kinematics == "axisymmetric":
        rows = table.of(contacts[0]["name"])
        below = draw_axis_stress(body, rows, contacts[0], folder / "axis_stress.png")
        drawn += [] if below is None else [below]
    return drawn
