"""Bodies that look like bolts: a shank between two shoulders that clamp other bodies."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.survey.facing import Pair
from fenics_contact.mesh.survey.survey import FoundSurface, Survey

_PARALLEL = 1 - 1e-9  # cosine
_ALIKE = 1e-6  # of places, over the diagonal of all
_MIDDLE = 0.3, 0.7  # of the length between the shoulders: where a bolt may be cut


@dataclass(frozen=True)
class Bolt:
    """A body that looks like a bolt.

    Attributes:
        body: Its index.
        axis: Unit vector along it, (3,).
        between: Two places along the axis, from the origin, in the middle of its shank (length).
        area: Of the shank's section.
    """

    body: int
    axis: tuple[float, ...]
    between: tuple[float, float]
    area: float


def bolts(found: Survey, pairs: Sequence[Pair]) -> list[Bolt]:
    """Bodies whose plane shoulders press others together, with a cylinder from one to the other.

    Args:
        found: Bodies and surfaces.
        pairs: Surfaces that face each other.
    """
    touching: dict[int, set[int]] = {}
    for pair in pairs:
        for body, side in zip(pair.bodies, (pair.first, pair.second), strict=True):
            touching.setdefault(body, set()).update(side)
    looked = (_bolt(found, body, sorted(places)) for body, places in sorted(touching.items()))
    return [bolt for bolt in looked if bolt is not None]


def _bolt(found: Survey, body: int, places: Sequence[int]) -> Bolt | None:
    shoulders = [s for s in (found.surfaces[n] for n in places) if s.shape.kind == "plane"]
    near = _ALIKE * found.size
    for shank, axis in _shanks(found, body):
        ends = [(float(s.normals[0] @ axis), float(s.triangles[0, 0] @ axis)) for s in shoulders]
        for (one, start), (other, end) in itertools.permutations(ends, 2):
            reach = shank.triangles.reshape(-1, 3) @ axis
            spans = reach.min() <= start + near and end - near <= reach.max()
            if one >= _PARALLEL and other <= -_PARALLEL and start + near < end and spans:
                first, last = (start + share * (end - start) for share in _MIDDLE)
                radius = shank.shape.radius or 0.0
                return Bolt(body, tuple(axis.tolist()), (first, last), pi * radius**2)
    return None


def _shanks(found: Survey, body: int) -> Iterator[tuple[FoundSurface, Array]]:
    """Round surfaces of a body that bulge outwards, and their axes."""
    for surface in found.surfaces:
        if surface.bodies == (body,) and surface.shape.kind == "cylinder" and surface.is_outward:
            yield surface, np.array(surface.shape.axis)
