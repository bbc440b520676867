"""PNG files from the files of a run, by matplotlib and pyvista. No MPI, no FEniCSx."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from fenics_contact.body_picture import draw_body
from fenics_contact.contact_table import ContactTable
from fenics_contact.curves import draw_curves
from fenics_contact.errors import InputError
from fenics_contact.surface_maps import draw_maps


def draw_pictures(folder: Path, result: dict[str, Any]) -> list[Path]:
    """Draw what the files of a run show.

    Args:
        folder: Holds ``contact.csv`` and ``fields.pvd``.
        result: The content of its ``result.json``.

    Returns:
        The PNG files drawn: one a contact, and the deformed body.

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
    kinematics = result["model"]["kinematics"]
    drawn = []
    for number, contact in enumerate(result["contacts"]):
        path = folder / f"contact_{number}.png"
        rows = table.of(contact["name"])
        if kinematics == "3D":
            draw_maps(rows, contact, path)
        else:
            draw_curves(rows, contact, "rz" if kinematics == "axisymmetric" else "xy", path)
        drawn.append(path)
    drawn.append(draw_body(folder, result, table, folder / "deformed.png"))
    return drawn
