"""A body of revolution from its section, with a quarter cut out, so that one sees inside."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.view.surface import MOST_TRIANGLES, Surface, boundary, surface_of

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

# The quarter that is missing is the one that is looked into.
REVOLVED = (0.5 * np.pi, 2.0 * np.pi)
_STRIPS = (12, 60)  # around the axis, at the least and at the most
_SHARP = np.cos(np.deg2rad(30))


def revolved(
    body: UnstructuredGrid, fields: dict[str, Array], most: int = MOST_TRIANGLES
) -> Surface:
    """The surface of a body of revolution.

    Args:
        body: Its section, as for ``surface_of``; x is the radius, y the axis, which is z then.
        fields: Likewise.
        most: Triangles at the most, if it can be.
    """
    section = surface_of(body, fields, most // 4)
    radius = section.points[:, 0]
    rim = boundary(section.triangles)
    rim = rim[(radius[rim] > 1e-9 * radius.max()).any(axis=1)]  # none along the axis
    room = (most - 2 * len(section.triangles)) // max(2 * len(rim), 1)
    strips = int(np.clip(room, *_STRIPS))
    nodes, edges = np.unique(rim, return_inverse=True)
    edges = edges.reshape(-1, 2)
    angles = np.linspace(*REVOLVED, strips + 1)
    ends = [turned(section, angle) for angle in (angles[0], angles[-1])]
    outside = _part(section, nodes)
    parts = [*ends, *(turned(outside, angle) for angle in angles)]
    second, around = len(section.points), 2 * len(section.points)
    sharp = _corners(outside.points, edges)
    return Surface(
        np.concatenate([part.points for part in parts]),
        np.concatenate(
            [
                ends[0].triangles,
                ends[1].triangles[:, ::-1] + second,
                around + strip_triangles(edges, len(nodes), strips),
            ]
        ),
        np.concatenate(
            [ends[0].lines, ends[1].lines + second, around + _rings(sharp, len(nodes), strips)]
        ),
        {name: np.concatenate([part.fields[name] for part in parts]) for name in section.fields},
    ).only_used()


def turned(flat: Surface, angle: float) -> Surface:
    """A flat surface turned around the axis by an angle."""
    fields = {
        name: turned_vectors(values, angle) if values.ndim > 1 else values
        for name, values in flat.fields.items()
    }
    return replace(flat, points=turned_vectors(flat.points, angle), fields=fields)


def turned_vectors(flat: Array, angle: float) -> Array:
    """Vectors whose first two components are those along radius and axis, (n, 3)."""
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    return np.asarray(np.outer(flat[:, 0], out) + np.outer(flat[:, 1], [0.0, 0.0, 1.0]))


def strip_triangles(edges: Integers, nodes: int, strips: int) -> Integers:
    """Triangles between copies of edges, those of a copy following each other, (triangles, 3).

    Args:
        edges: Numbers of their ends, (edges, 2).
        nodes: In each copy.
        strips: Of which there is one more copy.
    """
    here = edges[None] + nodes * np.arange(strips)[:, None, None]
    a, b = here[..., 0], here[..., 1]
    first = np.stack([a, a + nodes, b], axis=-1)
    second = np.stack([b, a + nodes, b + nodes], axis=-1)
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def _part(section: Surface, nodes: Integers) -> Surface:
    """Some of its points alone."""
    fields = {name: values[nodes] for name, values in section.fields.items()}
    none = np.zeros((0, 2), dtype=np.int64)
    return Surface(section.points[nodes], np.zeros((0, 3), dtype=np.int64), none, fields)


def _corners(points: Array, edges: Integers) -> Integers:
    """Numbers of the points at which a line of edges ends, or turns sharply."""
    along = points[edges[:, 1]] - points[edges[:, 0]]
    along /= np.linalg.norm(along, axis=1)[:, None]
    coming, going = np.zeros_like(points), np.zeros_like(points)
    coming[edges[:, 1]], going[edges[:, 0]] = along, along
    return np.flatnonzero(np.einsum("ij,ij->i", coming, going) < _SHARP)


def _rings(nodes: Integers, count: int, strips: int) -> Integers:
    """Pieces of the circles of some nodes, whose copies follow each other."""
    here = nodes[None] + count * np.arange(strips)[:, None]
    return np.stack([here, here + count], axis=-1).reshape(-1, 2)
