"""Points, normals and measures of the surfaces of a geometry, without its mesh, by Gmsh."""

from __future__ import annotations

import gmsh
import numpy as np

from fenics_contact.mesh.geometry.process_room import Arrays

_ALONG = 6  # points along each parameter


def exact_surfaces(dimension: int) -> Arrays:
    """Return points with normals, and the measure, of every surface; in the plane of curves.

    Args:
        dimension: Of the model.

    Returns:
        ``exact_points`` and ``exact_normals`` (points, 3), ``exact_parts`` (points,); and
        ``measured_parts``, ``measures`` of the surfaces that OpenCASCADE knows, and
        ``measured_bodies``, ``body_measures`` of its solids, or faces.
    """
    occ = gmsh.model.occ
    bodies = {part: occ.getMass(dimension, part) for _, part in occ.getEntities(dimension)}
    known = set(gmsh.model.occ.getEntities(dimension - 1))
    points, normals, parts, measures = [], [], [], {}
    for _, part in gmsh.model.getEntities(dimension - 1):
        if (dimension - 1, part) in known:
            measures[part] = gmsh.model.occ.getMass(dimension - 1, part)
        try:
            places, directions = _sampled(dimension - 1, part)
        except Exception:  # Gmsh raises plain Exceptions: discrete parts have no parameters
            continue
        sound = np.isfinite(directions).all(axis=1) & np.isfinite(places).all(axis=1)
        sound &= np.abs(np.linalg.norm(directions, axis=1) - 1) < 1e-6
        points.append(places[sound])
        normals.append(directions[sound])
        parts.append(np.full(int(sound.sum()), part))
    empty = np.zeros((0, 3))
    return {
        "exact_points": np.concatenate([empty, *points]),
        "exact_normals": np.concatenate([empty, *normals]),
        "exact_parts": np.concatenate([np.zeros(0, dtype=np.int64), *parts]),
        "measured_parts": np.array(list(measures), dtype=np.int64),
        "measures": np.array(list(measures.values()), dtype=float),
        "measured_bodies": np.array(list(bodies), dtype=np.int64),
        "body_measures": np.array(list(bodies.values()), dtype=float),
    }


def _sampled(dimension: int, part: int) -> tuple[np.ndarray, np.ndarray]:
    """Points all over the parameters of a surface or a curve, and unit normals there."""
    low, high = gmsh.model.getParametrizationBounds(dimension, part)
    # Not at the ends: poles and apexes have no normals.
    shares = (np.arange(_ALONG) + 0.5) / _ALONG
    sides = [a + (b - a) * shares for a, b in zip(low, high, strict=True)]
    parameters = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1)
    points = np.array(gmsh.model.getValue(dimension, part, parameters)).reshape(-1, 3)
    if dimension == 2:
        return points, np.array(gmsh.model.getNormal(part, parameters)).reshape(-1, 3)
    along = np.array(gmsh.model.getDerivative(1, part, parameters)).reshape(-1, 3)
    normals = np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(along))])
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)
