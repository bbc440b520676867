"""Values at nodes from samples inside cells, in two ways whose difference tells the error.

The better one fits a polynomial of the displacement's degree to the samples in the cells around a
node (O. C. Zienkiewicz, J. Z. Zhu, Int. J. Numer. Meth. Engng. 33 (1992) 1331-1364), and in more
of them where these do not fix it, as at boundaries. The plainer one is the mean of what each cell
around the node has there, as a linear fit to its own samples.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.analyses.fretting.history import Cells
from fenics_contact.common.arrays import Array, Integers

# Singular values of a fit, over the largest, below which its samples do not fix it.
_FIXED = 0.02
_MOST_LAYERS = 3


class Recovery:
    """Values at nodes by values at the samples of cells.

    A node between two materials, or bodies, is one place in each.

    Args:
        cells: With one layer more than those around the places.
        degree: Of the displacements.

    Attributes:
        node: Number of the node of each place, (places,).
        coordinates: Of the places, (places, 3) (length).
        part: The connected part that each is of.
    """

    def __init__(self, cells: Cells, degree: int) -> None:
        self._cells, self._degree = cells, degree
        groups = np.repeat(cells.group[:, None], cells.nodes.shape[1], axis=1)
        keys = np.column_stack([cells.nodes.ravel(), groups.ravel()])
        places, first, of_corner = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        self.node = places[:, 0]
        self.coordinates = cells.coordinates.reshape(-1, 3)[first]
        self.part = cells.part[first // cells.nodes.shape[1]]
        self._places_of_cell = np.asarray(of_corner).reshape(cells.nodes.shape)
        owners = np.repeat(np.arange(len(cells.nodes)), cells.nodes.shape[1])
        ones = np.ones(len(owners))
        self._cells_of_place = csr_matrix((ones, (self._places_of_cell.ravel(), owners)))
        spread = np.ptp(cells.samples, axis=(0, 1)) if len(cells.nodes) else np.zeros(3)
        self._axes = np.flatnonzero(spread > 0)

    def weights(self, chosen: Integers) -> tuple[csr_matrix, csr_matrix]:
        """Return weights of samples at places, (chosen, cells · samples), the better ones first."""
        shape = (len(chosen), self._cells.samples.shape[0] * self._cells.samples.shape[1])
        better = [self._fitted(place) for place in chosen.tolist()]
        plainer = [self._averaged(place) for place in chosen.tolist()]
        return _sparse(better, shape), _sparse(plainer, shape)

    def neighbours(self, chosen: Integers) -> csr_matrix:
        """Return whether two of some places share a cell, each with itself, (chosen, chosen)."""
        cells = self._cells_of_place[chosen]
        return csr_matrix(cells @ cells.T)

    def _around(self, place: int) -> Integers:
        """The cells of its body and material around a place."""
        matrix = self._cells_of_place
        return np.asarray(matrix.indices[matrix.indptr[place] : matrix.indptr[place + 1]])

    def _fitted(self, place: int) -> tuple[Integers, Array]:
        """Samples and weights of the polynomial that fits the cells around a place."""
        patch = np.sort(self._around(place))
        for _ in range(_MOST_LAYERS):
            found = self._fit(place, patch, self._degree)
            if found is not None:
                return found
            places = np.unique(self._places_of_cell[patch])
            patch = np.unique(np.concatenate([self._around(one) for one in places.tolist()]))
        for degree in range(self._degree, 0, -1):
            found = self._fit(place, patch, degree)
            if found is not None:
                return found
        return self._averaged(place)

    def _fit(self, place: int, patch: Integers, degree: int) -> tuple[Integers, Array] | None:
        """The least squares' value at the place; None where samples do not fix the polynomial."""
        per_cell = self._cells.samples.shape[1]
        samples = (patch[:, None] * per_cell + np.arange(per_cell)).ravel()
        away = self._cells.samples[patch].reshape(-1, 3) - self.coordinates[place]
        away = away[:, self._axes]
        sizes = np.abs(away).max(axis=0, initial=0.0)
        if not (sizes > 0).all():
            return None
        terms = _polynomial(away / sizes, degree)
        if len(terms) < terms.shape[1]:
            return None
        left, values, right = np.linalg.svd(terms, full_matrices=False)
        if values[-1] < _FIXED * values[0]:
            return None
        return samples, np.asarray(left @ (right[:, 0] / values))

    def _averaged(self, place: int) -> tuple[Integers, Array]:
        """The mean over the cells around a place of what each has there."""
        around, per_cell = self._around(place), self._cells.samples.shape[1]
        samples, weights = [], []
        for cell in around.tolist():
            found = self._fit(place, np.array([cell]), 1)
            alone = np.arange(per_cell) + cell * per_cell, np.full(per_cell, 1 / per_cell)
            numbers, shares = alone if found is None else found
            samples.append(numbers)
            weights.append(shares / len(around))
        return np.concatenate(samples), np.concatenate(weights)


def _polynomial(places: Array, degree: int) -> Array:
    """All monomials up to a degree, 1 first, (places, monomials)."""
    count, axes = places.shape
    terms = [np.ones(count), *places.T]
    if degree > 1:
        terms += [places[:, i] * places[:, j] for i in range(axes) for j in range(i, axes)]
    return np.stack(terms, axis=1)


def _sparse(rows: list[tuple[Integers, Array]], shape: tuple[int, int]) -> csr_matrix:
    """A matrix of rows that are given by columns and values."""
    counts = [len(columns) for columns, _ in rows]
    empty = (np.zeros(0, dtype=np.int64), np.zeros(0))
    columns, values = (np.concatenate(part) for part in zip(empty, *rows, strict=True))
    bounds = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    return csr_matrix((values, columns, bounds), shape=shape)
