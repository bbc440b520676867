"""The shapes of modes that grow while bodies slide: each at two moments of its period."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.report.bodies.mode_shapes import figure_of_shapes
from fenics_contact.report.drawing.fields import read_modes
from fenics_contact.report.drawing.figures import save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.units import with_unit
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOST = 3
_MOMENTS = {"displacement": "", "displacement_quarter_later": ", a quarter of a period later"}


def draw_squeal_shapes(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``squeal.png``, the modes of a run that grow fastest while its contacts slide.

    Args:
        folder: Of the run, which holds ``squeal.pvd``.
        result: The content of its ``result.json``.

    Raises:
        InputError: A display is missing for bodies in space; says what to install.
    """
    modes = [] if result.stability is None else list(result.stability.modes)
    growing = sorted((mode for mode in modes if mode.grows), key=lambda mode: -mode.growth_rate)
    growing = growing[:_MOST]
    if not growing or not (folder / "squeal.pvd").exists():
        return []
    bodies = list(read_modes(folder, "squeal"))
    shapes: dict[str, UnstructuredGrid] = {}
    for mode in growing:
        named = f"Mode {mode.number}, f = {with_unit(f'{mode.frequency:.5g}', 'cycles/time')}"
        for name, moment in _MOMENTS.items():
            shapes[f"{named}{moment}"] = _at_moment(bodies[mode.number - 1], name)
    path = folder / "squeal.png"
    save(figure_of_shapes(shapes, result.model.kinematics == "3D"), path, tight=True)
    said = (
        "Shapes of the modes that grow fastest while the contact slides, at two moments, any size. "
        "Coloured by the size of the displacement over the largest of the period; grey, the body "
        "at rest."
    )
    return [Picture(path, "Shapes of what squeals", said)]


def _at_moment(body: UnstructuredGrid, name: str) -> UnstructuredGrid:
    """The body with the displacement of a moment, beside the longest one of the period, 1."""
    found = body.copy()
    found["displacement"] = np.asarray(body[name])
    found["largest"] = np.ones(body.n_points)
    return found
