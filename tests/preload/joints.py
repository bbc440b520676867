"""Bolted joints of bars, whose forces are known exactly where Poisson's ratio is 0."""

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import Body, Group
from fenics_contact.common import dolfinx_versions as compat

COMM = MPI.COMM_WORLD
# Strips by x: half a bolt with its middle at 0, a gap, and half a sleeve with a collar on top. A
# rigid plane that is glued on top of bolt and collar is the head.
BOLT, SLEEVE, HEIGHT, TOP = (0.0, 1.0), (1.5, 3.0), 4.0, 5.0
PARTS = ("bolt", "shank", "collar", "sleeve")


def part_at(x, y):
    """Number of the part at a cell's centre, None in the gap."""
    if SLEEVE[0] < x < SLEEVE[1]:
        return 2 if y > HEIGHT else 3
    if x > BOLT[1]:
        return None
    return 1 if 1 < y < 3 else 0


def joint(glued=False, deep=0, finer=1):
    """The joint, half of it.

    Args:
        glued: Whether the sleeve hangs together with the collar.
        deep: Cells along z, over a depth of 1; 0 in the plane.
        finer: Cells in each of the coarsest.
    """
    xs = np.linspace(0, 3, 6 * finer + 1)
    ys = np.linspace(0, TOP, 5 * finer + 1)
    zs = np.linspace(0, 1, deep + 1)
    numbers, points, cells, parts = {}, [], [], []

    def node(i, j, k, of_sleeve):
        key = (i, j, k, of_sleeve and not glued)
        if key not in numbers:
            numbers[key] = len(points)
            points.append((xs[i], ys[j], zs[k])[: 3 if deep else 2])
        return numbers[key]

    for k in range(max(deep, 1)):
        for j in range(len(ys) - 1):
            for i in range(len(xs) - 1):
                part = part_at((xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2)
                if part is None:
                    continue
                layers = (k, k + 1) if deep else (0,)
                corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
                cells.append([node(*at, layer, part == 3) for layer in layers for at in corners])
                parts.append(part + 1)
    arrays = [np.array(points), np.array(cells, dtype=np.int64), np.array(parts, dtype=np.int32)]
    if COMM.rank:
        arrays = [array[:0] for array in arrays]
    return _tagged(*arrays, 3 if deep else 2)


def _tagged(points, cells, parts, dimension):
    cell = "hexahedron" if dimension == 3 else "quadrilateral"
    whole = compat.create_mesh(COMM, cell, 1, points, cells)
    cell_tags = compat.distributed_tags(whole, dimension, cells, parts)
    whole.topology.create_connectivity(dimension - 1, dimension)
    facets = compat.exterior_facets(whole)
    centres = mesh.compute_midpoints(whole, dimension - 1, facets)
    links = whole.topology.connectivity(dimension - 1, dimension)
    tag_of = dict(zip(cell_tags.indices.tolist(), cell_tags.values.tolist(), strict=True))
    owner = np.array([tag_of[int(links.links(f)[0])] for f in facets], dtype=np.int32)
    x, y, z = centres.T
    places = {
        "bottom": np.isclose(y, 0) & (owner == 1),
        "ground": np.isclose(y, 0) & (owner == 4),
        "middle": np.isclose(x, 0),
        "top": np.isclose(y, TOP),
        "seat": np.isclose(y, HEIGHT) & (owner == 4),
        "under_collar": np.isclose(y, HEIGHT) & (owner == 3),
        "front": np.isclose(z, 0) if dimension == 3 else np.zeros(len(z), dtype=bool),
    }
    tags, groups = np.zeros(len(facets), dtype=np.int32), {}
    for number, (name, there) in enumerate(places.items()):
        tags[there] = number + 1
        groups[name] = Group(dimension - 1, (number + 1,))
    groups |= {name: Group(dimension, (number + 1,)) for number, name in enumerate(PARTS)}
    order = np.argsort(facets)
    facet_tags = mesh.meshtags(whole, dimension - 1, facets[order], tags[order])
    return Body(whole, cell_tags, facet_tags, groups, "the joint")
