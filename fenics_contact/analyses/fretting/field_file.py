"""Criteria of fatigue as a run's file for ParaView: ``fretting.pvd``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.analyses.fretting.places import FrettingPlaces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.output.fields import body_of_cells
from fenics_contact.simulation.output.vtu import write_collection, write_grid

# Of the body's size, by which a node and a place that are one may differ.
_SAME = 1e-9


def write_fretting(
    spaces: Spaces, places: FrettingPlaces, displacement: Array, folder: Path
) -> None:
    """Write ``fretting.pvd``: all criteria at the nodes near contacts; collective.

    Elsewhere they are no numbers, which ParaView leaves blank.

    Args:
        spaces: Of the body.
        places: Where they were evaluated, the same on every rank.
        displacement: Of the last load step, at the nodes of this rank (length).
        folder: Where to.
    """
    numbers = _place_of_nodes(spaces, places)
    is_place = numbers >= 0
    more = np.zeros((len(displacement), 3 - spaces.components))
    fields = {"displacement": np.hstack([displacement, more])}
    for name, values in places.values.items():
        fields[name] = np.full(len(numbers), np.nan)
        fields[name][is_place] = values[numbers[is_place]]
    fields["plane"] = np.full((len(numbers), 3), np.nan)
    fields["plane"][is_place] = places.planes[numbers[is_place]]
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    grid = write_grid(folder, "fretting", 1, space, fields, bodies)
    on_root(spaces.comm, lambda: write_collection(folder / "fretting.pvd", {grid: 0.0}))


def _place_of_nodes(spaces: Spaces, places: FrettingPlaces) -> Integers:
    """Number of the place that each node of this rank is, -1 where it is none."""
    found = np.full(len(spaces.coordinates), -1)
    if len(places.coordinates) == 0:
        return found
    parts = np.array(spaces.parts.names)[spaces.parts.of_node]
    for body in set(places.body):
        mine = np.flatnonzero(parts == body)
        there = np.flatnonzero(np.array(places.body) == body)
        tree = cKDTree(places.coordinates[there])
        near, number = tree.query(
            spaces.coordinates[mine], distance_upper_bound=_SAME * spaces.size
        )
        same = np.isfinite(near)
        found[mine[same]] = there[number[same]]
    return found
