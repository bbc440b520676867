"""Modes of steady sliding as a run's files: ``squeal.pvd`` for ParaView, and ``stability.csv``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import on_root
from fenics_contact.results.records.stability import StabilityRecord
from fenics_contact.simulation.output.fields import body_of_cells
from fenics_contact.simulation.output.vtu import write_collection, write_grid
from fenics_contact.solve.modes.sliding_modes import ComplexMode


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


def curve_rows(found: StabilityRecord) -> list[list[str]]:
    """The rows of ``stability.csv``, its header first: one a coefficient and mode.

    Args:
        found: With a curve.
    """
    rows = [["friction_coefficient", "mode", "frequency", "growth_rate"]]
    for point in found.curve:
        pairs = zip(point.frequencies, point.growth_rates, strict=True)
        for number, (frequency, rate) in enumerate(pairs, start=1):
            values = (point.friction_coefficient, frequency, rate)
            coefficient, *numbers = (repr(float(value)) for value in values)
            rows.append([coefficient, str(number), *numbers])
    return rows
