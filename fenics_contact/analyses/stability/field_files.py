"""Modes of steady sliding as a run's file for ParaView: ``squeal.pvd``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fenics_contact.analyses.stability.sliding_modes import ComplexMode
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.output.fields import body_of_cells
from fenics_contact.simulation.output.vtu import write_collection, write_grid


def write_complex_modes(spaces: Spaces, modes: Sequence[ComplexMode], folder: Path) -> None:
    """Write ``squeal.pvd``: a grid a mode, in place of a time its number; collective.

    Its displacement, and what that is a quarter of a period later, without its growth.

    Args:
        spaces: Of the body.
        modes: In their order.
        folder: Where to.
    """
    grids: dict[str, float] = {}
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    for number, mode in enumerate(modes, start=1):
        fields = {
            "displacement": _in_space(mode.shape.real),
            "displacement_quarter_later": _in_space(-mode.shape.imag),
        }
        grids[write_grid(folder, "squeal", number, space, fields, bodies)] = float(number)
    on_root(spaces.comm, lambda: write_collection(folder / "squeal.pvd", grids))


def _in_space(shape: Array) -> Array:
    return np.hstack([shape, np.zeros((len(shape), 3 - shape.shape[1]))])
