"""Sizes of the facets of a surface, and of the cells behind them."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import largest, smallest
from fenics_contact.contact.surface.space import SurfaceSpace


def relative_facet_size(surface: SurfaceSpace) -> float:
    """Largest facet over the extent of the surface; collective."""
    mesh = surface.mesh
    facets = np.arange(len(surface.facet_nodes), dtype=np.int32)
    return largest(surface.comm, mesh.h(mesh.topology.dim, facets)) / surface.extent()


def relative_cell_size(surface: SurfaceSpace) -> float:
    """Largest of the cells behind the facets over the extent of the surface; collective."""
    mesh = surface.spaces.body.mesh
    cells = np.unique(surface.parents[:, 0]).astype(np.int32)
    return largest(surface.comm, mesh.h(mesh.topology.dim, cells)) / surface.extent()


def smallest_edge(surface: SurfaceSpace) -> float:
    """Shortest edge of the cells at the surface (length): flat ones are stiff; collective."""
    mesh = surface.spaces.body.mesh
    topology = mesh.topology
    topology.create_entities(1)
    topology.create_connectivity(topology.dim, 1)
    topology.create_connectivity(1, topology.dim)  # which `h` asks for
    cells = np.unique(surface.parents[:, 0])
    links = topology.connectivity(topology.dim, 1)
    edges = [np.zeros(0, dtype=np.int32), *(links.links(cell) for cell in cells)]
    return smallest(surface.comm, mesh.h(1, np.unique(np.concatenate(edges))))
