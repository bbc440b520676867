"""Modes as a run's files: ``modes.pvd`` for ParaView, and ``damping.csv``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.parallel import on_root
from fenics_contact.results.records.vibration import DampingRecord
from fenics_contact.simulation.output.fields import body_of_cells
from fenics_contact.simulation.output.vtu import write_collection, write_grid
from fenics_contact.solve.modes.eigenmodes import Mode


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


def damping_rows(found: Sequence[DampingRecord]) -> list[list[str]]:
    """The rows of ``damping.csv``, its header first: one a mode and amplitude.

    Bars stand in ``…_error``, which is empty where they were not estimated.

    Args:
        found: At least one.
    """
    names = [name for name in found[0] if name not in ("by", "contacts", "errors")]
    contacts, keys = list(found[0].contacts), list(found[0].by)
    bars = ("natural_frequency", "damping_ratio", "loss")
    rows = [
        [
            *(*keys, *names),
            *(f"{contact}.loss" for contact in contacts),
            *(f"{name}_error" for name in bars),
        ]
    ]
    for one in found:
        values = [one.by[key] for key in keys] + [one[name] for name in names]
        values += [one.contacts[name] for name in contacts]
        known = [one.errors.get(name, {}).get("total") for name in bars]
        values += ["" if error is None else error for error in known]
        rows.append([value if isinstance(value, str) else repr(value) for value in values])
    return rows
