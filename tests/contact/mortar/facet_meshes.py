"""Contact surfaces as plain arrays: images of grids on [0, 1] or [0, 1]²."""

import numpy as np

from fenics_contact.contact.mortar.facet_mesh import FacetMesh, reference_nodes

# Corners of two triangles in a unit square.
_HALVES = np.array([[[0, 0], [1, 0], [0, 1]], [[1, 1], [0, 1], [1, 0]]], dtype=float)


def patch(shape, cells, place, normal, order=1, degree=1, distortion=0.0):
    """A grid of facets, mapped to space by place(parameters), with normal(positions).

    ``distortion`` moves the grid's inner points at random by up to this share of a facet.
    """
    parameters = _parameters(shape, cells, reference_nodes(shape, order))
    parameters = _distorted(parameters, cells, distortion)
    spots = _parameters(shape, cells, reference_nodes(shape, degree))
    flat = np.round(spots.reshape(-1, spots.shape[2]) * 1e6).astype(int)
    _, numbers = np.unique(flat, axis=0, return_inverse=True)
    nodes = numbers.reshape(spots.shape[:2])
    geometry = place(parameters.reshape(-1, parameters.shape[2]))
    geometry = geometry.reshape(*parameters.shape[:2], -1)
    unfinished = FacetMesh(
        shape, order, degree, geometry, nodes, np.zeros((nodes.max() + 1, geometry.shape[2]))
    )
    return FacetMesh(shape, order, degree, geometry, nodes, normal(node_places(unfinished)))


def node_places(mesh):
    """Positions of the displacement nodes, (nodes, dimension)."""
    reference = reference_nodes(mesh.shape, mesh.degree)
    places = np.empty((mesh.node_count, mesh.dimension))
    for number, point in enumerate(reference):
        facets = np.arange(len(mesh.nodes))
        points = np.repeat(point[None], len(facets), axis=0)
        places[mesh.nodes[:, number]] = mesh.positions(facets, points)
    return places


def flat(shape, cells, side, degree=1, distortion=0.0, height=0.0, corner=(0.0, 0.0), size=1.0):
    """A square or segment at a height, whose outward normal is up (side 1) or down (side −1)."""
    dimension = 2 if shape == "interval" else 3

    def place(parameters):
        heights = np.full(len(parameters), height)
        return np.column_stack([size * parameters + corner[: dimension - 1], heights])

    def normal(places):
        return np.tile(np.eye(dimension)[-1] * side, (len(places), 1))

    return patch(shape, cells, place, normal, 1, degree, distortion)


def arc(cells, radius, side, order=1, degree=1, angles=(0.0, 2 * np.pi), centre=(0.0, 0.0)):
    """Part of a circle, with its normals outward (side 1) or inward (side −1)."""

    def place(parameters):
        angle = angles[0] + (angles[1] - angles[0]) * parameters[:, 0]
        return radius * np.column_stack([np.cos(angle), np.sin(angle)]) + centre

    def normal(places):
        return side * (places - centre) / np.linalg.norm(places - centre, axis=1)[:, None]

    return patch("interval", cells, place, normal, order, degree)


def cap(shape, cells, radius, side, order=1, degree=1, width=1.0, turn=0.0):
    """The part of a sphere over a square (of the side width × radius) in gnomonic coordinates."""

    def place(parameters):
        x, y = width * (parameters.T - 0.5)
        x, y = x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)
        points = np.column_stack([x, y, np.ones(len(x))])
        return radius * points / np.linalg.norm(points, axis=1)[:, None]

    def normal(places):
        return side * places / np.linalg.norm(places, axis=1)[:, None]

    return patch(shape, cells, place, normal, order, degree)


def _parameters(shape, cells, reference):
    """Points of all facets on [0, 1]^d, (facets, points, d)."""
    if shape == "interval":
        return (np.arange(cells)[:, None, None] + reference) / cells
    corners = np.stack(np.meshgrid(np.arange(cells), np.arange(cells)), axis=2).reshape(-1, 1, 2)
    if shape == "quadrilateral":
        return (corners + reference) / cells
    halves = [half[0] + reference @ (half[1:] - half[0]) for half in _HALVES]
    return np.concatenate([corners + half for half in halves]) / cells


def _distorted(parameters, cells, share):
    generator = np.random.default_rng(3)
    shifts = generator.uniform(-share, share, (cells + 1,) * parameters.shape[2] + (2,)) / cells
    shifts = shifts[..., : parameters.shape[2]]
    if share == 0:
        return parameters
    grid = np.rint(parameters * cells).astype(int)
    inner = ((grid > 0) & (grid < cells)).all(axis=2, keepdims=True)
    return parameters + np.where(inner, shifts[tuple(np.moveaxis(grid, 2, 0))], 0.0)
