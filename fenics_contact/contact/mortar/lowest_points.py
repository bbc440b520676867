"""Where on its facets a function is least: between the nodes of a surface, too.

Every facet is sampled, and the most promising ones again and again around their best sample.
Arrays alone; each rank looks at its own facets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, reference_nodes

# So many facets are looked at more closely: they may all lie in one contact.
_PROMISING = 64
# Times that the samples around the best one come closer together, each time by half.
_ROUNDS = 16
_AROUND = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])

# Values at points (facets, reference coordinates), infinite where there is none.
PointFunction = Callable[[AnyIntegers, Array], Array]


@dataclass(frozen=True, eq=False)
class LowestPoints:
    """The lowest point of each facet.

    Attributes:
        values: There, (facets,); infinite on facets without samples.
        reference: Places on the facets, (facets, dimension − 1).
    """

    values: Array
    reference: Array


def lowest_points(mesh: FacetMesh, counts: AnyIntegers, function: PointFunction) -> LowestPoints:
    """Find the lowest point of each facet.

    Args:
        mesh: The surface.
        counts: Samples along a facet's side, (facets,); of none nothing is looked at.
        function: What is to be least.
    """
    middle = reference_nodes(mesh.shape, 1).mean(axis=0)
    values = np.full(len(counts), np.inf)
    reference = np.tile(middle, (len(counts), 1))
    for count in np.unique(counts[counts > 0]):
        facets, samples = np.flatnonzero(counts == count), _samples(mesh.shape, int(count))
        found = _at(function, facets, np.tile(samples, (len(facets), 1, 1)))
        best = found.argmin(axis=1)
        values[facets], reference[facets] = found[np.arange(len(facets)), best], samples[best]
    promising = np.argsort(values, kind="stable")[:_PROMISING]
    promising = promising[np.isfinite(values[promising])]
    width = 1 / np.maximum(counts[promising], 1)
    for _ in range(_ROUNDS if len(promising) else 0):
        around = np.stack(np.meshgrid(*[_AROUND] * reference.shape[1]), axis=-1)
        steps = around.reshape(-1, reference.shape[1]) * width[:, None, None]
        places = _inside(mesh.shape, reference[promising, None] + steps)
        found = _at(function, promising, places)
        rows, best = np.arange(len(promising)), found.argmin(axis=1)
        better = found[rows, best] < values[promising]
        values[promising] = np.where(better, found[rows, best], values[promising])
        chosen = np.where(better[:, None], places[rows, best], reference[promising])
        reference[promising] = chosen
        width = width / 2
    return LowestPoints(values, reference)


def _at(function: PointFunction, facets: AnyIntegers, places: Array) -> Array:
    """Values at places (facets, samples, dimension − 1), (facets, samples)."""
    count, samples, dimension = places.shape
    found = function(np.repeat(facets, samples), places.reshape(-1, dimension))
    return found.reshape(count, samples)


def _samples(shape: str, count: int) -> Array:
    """Points spread over a reference cell, (samples, dimension − 1)."""
    along = (np.arange(count) + 0.5) / count
    if shape == "interval":
        return along[:, None]
    places = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    return places if shape == "quadrilateral" else places[places.sum(axis=1) <= 1.0]


def _inside(shape: str, places: Array) -> Array:
    """Places moved into the reference cell, (..., dimension − 1)."""
    places = np.clip(places, 0.0, 1.0)
    if shape == "triangle":
        beyond = np.maximum(places.sum(axis=-1, keepdims=True) - 1.0, 0.0)
        places = np.clip(places - beyond / 2, 0.0, 1.0)
    return np.asarray(places)
