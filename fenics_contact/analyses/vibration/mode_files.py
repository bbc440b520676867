"""Modes as a run's file for ParaView: ``modes.pvd``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fenics_contact.analyses.vibration.eigenmodes import Mode
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.output.fields import body_of_cells
from fenics_contact.simulation.output.vtu import write_collection, write_grid


def write_modes(spaces: Spaces, modes: Sequence[Mode], folder: Path) -> None:
    """Write ``modes.pvd``: a grid a mode with its displacement, in place of a time its number.

    Args:
        spaces: Of the body; collective.
        modes: In their order.
        folder: Where to.
    """
    grids: dict[str, float] = {}
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    for number, mode in enumerate(modes, start=1):
        more = np.zeros((len(mode.shape), 3 - spaces.components))
        fields = {"displacement": np.hstack([mode.shape, more])}
        grids[write_grid(folder, "modes", number, space, fields, bodies)] = float(number)
    on_root(spaces.comm, lambda: write_collection(folder / "modes.pvd", grids))
