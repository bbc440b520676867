"""The functions of one degree more that local error problems are solved in.

Those of a cell that vanish at the nodes of its own element: what the element cannot follow.
"""

from __future__ import annotations

import basix
import basix.ufl
import numpy as np
from dolfinx import fem
from scipy.linalg import null_space, orth
from ufl.finiteelement import AbstractFiniteElement

from fenics_contact.body.forms import FunctionSpace
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array


def bubble_space(spaces: Spaces) -> FunctionSpace:
    """Discontinuous space of displacements that vanish at the nodes of ``spaces``.

    Of degree p + 1, complete on triangles, tetrahedra and quadrilaterals. On hexahedra only the
    products of a polynomial that vanishes at the nodes of a line with linear ones across it:
    those alone decide the order, and all of them would cost more than the solution.
    """
    mesh, degree = spaces.body.mesh, spaces.degree
    cell = getattr(basix.CellType, mesh.topology.cell_name())
    lagrange = basix.create_element(
        basix.ElementFamily.P, cell, degree, basix.LagrangeVariant.equispaced
    )
    at_nodes = _legendre(cell, degree + 1, lagrange.points)
    combinations = null_space(at_nodes)
    if cell == basix.CellType.hexahedron:
        combinations = _along_lines(combinations, degree)
    element = _element(cell, degree + 1, np.ascontiguousarray(combinations.T))
    return fem.functionspace(mesh, basix.ufl.blocked_element(element, shape=(spaces.components,)))


def _legendre(cell: basix.CellType, degree: int, points: Array) -> Array:
    """Orthonormal polynomials of a degree at points, (points, polynomials)."""
    kind = basix.PolynomialType.legendre
    return np.asarray(basix.tabulate_polynomials(kind, cell, degree, points)).T


def _along_lines(combinations: Array, degree: int) -> Array:
    """The part of a space over a hexahedron that is linear in all directions but one."""
    powers = np.array(list(np.ndindex(3 * (degree + 2,))))
    others = np.sort(powers, axis=1)[:, 1]  # all but the highest are at most 1
    simple = np.eye(len(powers))[:, others <= 1]
    # Both span spaces of coefficients: what they share is in the kernel of their difference.
    shared = null_space(np.hstack([combinations, -simple]))[: combinations.shape[1]]
    return np.asarray(orth(combinations @ shared))


def _element(cell: basix.CellType, degree: int, coefficients: Array) -> AbstractFiniteElement:
    """An element that spans combinations of orthonormal polynomials, all inside the cell."""
    dimension = len(basix.topology(cell)) - 1
    points, weights = basix.make_quadrature(cell, 2 * degree)
    values = coefficients @ _legendre(cell, degree, points).T
    moments = (weights * values)[:, None, :, None]
    places: list[list[Array]] = [
        [np.zeros((0, dimension)) for _ in entities] for entities in basix.topology(cell)
    ] + [[] for _ in range(3 - dimension)]
    duals: list[list[Array]] = [
        [np.zeros((0, 1, 0, 1)) for _ in entities] for entities in basix.topology(cell)
    ] + [[] for _ in range(3 - dimension)]
    places[dimension], duals[dimension] = [points], [moments]
    return basix.ufl.custom_element(
        cell,
        [],
        coefficients,
        places,
        duals,
        0,
        basix.MapType.identity,
        basix.SobolevSpace.L2,
        True,
        -1,
        degree,
    )
