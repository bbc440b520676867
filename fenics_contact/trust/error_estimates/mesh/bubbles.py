"""What local error problems are solved in and for: functions of one degree more, mean stresses.

The functions of one degree more that local error problems are solved in. Those of a cell that
vanish at the nodes of its own element: what the element cannot follow.

The error of a mean stress that is an unknown of its own, in every cell, with the displacement's.
In a cell K the errors e of the displacement and r of the mean stress solve, among the bubbles w
and the polynomials t of the displacement's degree, which is one more than the mean stress has,
d_K(e, w) + ∫ r tr e(w) = residual(w), ∫ t (tr e(e) − r/K) = −∫ t (tr e(u) − s/K). Here d is the
deviatoric part of the energy. This is the local problem of R. E. Bank and B. D. Welfert, SIAM J.
Numer. Anal. 28 (1991) 591-623, for Stokes' equations, of a material that gives way a little.
"""

from __future__ import annotations

from collections.abc import Mapping

import basix
import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import FunctionSpace
from scipy.linalg import null_space, orth
from ufl.core.expr import Expr
from ufl.finiteelement import AbstractFiniteElement

from fenics_contact.body.elasticity import Isotropic
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.problem.problem import Problem


def bubble_space(spaces: Spaces) -> FunctionSpace:
    """Discontinuous space of displacements that vanish at the nodes of ``spaces``."""
    element = basix.ufl.blocked_element(bubble_element(spaces), shape=(spaces.components,))
    return fem.functionspace(spaces.body.mesh, element)


def bubble_element(spaces: Spaces) -> AbstractFiniteElement:
    """Element of one component whose functions vanish at the nodes of ``spaces``.

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
    return _element(cell, degree + 1, np.ascontiguousarray(combinations.T))


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


class MeanStressErrors:
    """The mean stress in the local problems of a body.

    Args:
        problem: The model, with a mean stress as an unknown.
        bubble: Test function of the displacement's errors.
        rule: Of the integrals.
        blocks: Of every cell of this rank, the number of its block of dofs of those.
    """

    def __init__(
        self, problem: Problem, bubble: Expr, rule: Mapping[str, int], blocks: Integers
    ) -> None:
        elastic, spaces = problem.elastic, problem.spaces
        mixed, law, mesh = elastic.mixed, elastic.law, spaces.body.mesh
        assert mixed is not None and isinstance(law, Isotropic)
        family = "DPC" if compat.is_tensor_cell(mesh) else "DG"
        space = fem.functionspace(mesh, (family, spaces.degree))
        self._function = fem.Function(space)
        self._combinations = _combinations(space, spaces.degree)
        self._count = self._combinations.shape[1]
        # The coupling takes as many components as the bubbles have: of unequal blocks dolfinx
        # makes no matrix.
        alike = fem.functionspace(mesh, (family, spaces.degree, (spaces.components,)))
        self._dofs, of_alike = (_by_block(one, blocks) for one in (space, alike))
        self._first = of_alike * spaces.components
        trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
        weight, measure = spaces.weight, ufl.dx(mesh, metadata=dict(rule))
        missed = ufl.tr(elastic.elastic_strain(elastic.displacement))
        missed -= mixed.mean_stress / law.bulk_modulus
        self._volumes = form_cache.form(-weight * test * missed * measure)
        first = ufl.TrialFunction(alike)[0]
        coupling = form_cache.form(weight * first * ufl.tr(elastic.strain(bubble)) * measure)
        compressibility = form_cache.form(weight / law.bulk_modulus * trial * test * measure)
        self._forms = (coupling, compressibility)

    @property
    def error(self) -> Expr:
        """Error of the stress by the mean stress in UFL, (3, 3)."""
        return self._function * ufl.Identity(3)

    def coupled(self, stiffnesses: Array) -> Array:
        """Matrices of the local problems, by block.

        Args:
            stiffnesses: Of the displacement's errors, (cells, dofs, dofs).
        """
        cells, size = stiffnesses.shape[:2]
        of_bubbles = np.arange(cells * size).reshape(cells, size)
        chosen = self._combinations
        coupling = _blocks(self._forms[0], of_bubbles, self._first) @ chosen
        compressibility = chosen.T @ _blocks(self._forms[1], self._dofs, self._dofs) @ chosen
        return np.block([[stiffnesses, coupling], [coupling.transpose(0, 2, 1), -compressibility]])

    def with_volumes(self, right: Array) -> Array:
        """Right-hand sides of the local problems, by block.

        Args:
            right: Of the displacement's errors, (cells, dofs).
        """
        vector = fem.assemble_vector(self._volumes)  # of this rank's cells alone
        return np.hstack([right, vector.array[self._dofs] @ self._combinations])

    def energies(self, found: Array, right: Array) -> Array:
        """d(e, e) + ∫ r²/K by block (energy)."""
        products = found * right
        return products[:, : -self._count].sum(axis=1) - products[:, -self._count :].sum(axis=1)

    def without(self, found: Array) -> Array:
        """Keep the mean stress of errors that were found, and give back those of displacements."""
        self._function.x.array[self._dofs] = found[:, -self._count :] @ self._combinations.T
        self._function.x.scatter_forward()
        return found[:, : -self._count]


def _combinations(space: FunctionSpace, degree: int) -> Array:
    """Return combinations of a cell's basis functions for errors of mean stresses, (dofs, count).

    All of them; of triangles of degree 2 those without a mean. Their bubbles are odd about the
    middle of each edge, so that no cell has another volume by them: its mean stress would have to
    make up for that alone, without bound as ν → ½.
    """
    element = space.element.basix_element
    if degree != 2 or element.cell_type != basix.CellType.triangle:
        return np.eye(element.dim)
    points, weights = basix.make_quadrature(element.cell_type, degree)
    means = weights @ element.tabulate(0, points)[0, :, :, 0]
    return np.asarray(null_space(means[None]))


def _by_block(space: FunctionSpace, blocks: Integers) -> Integers:
    """Dofs of a discontinuous space, (cells, dofs), by the numbers of cells' blocks."""
    own = space.dofmap.list[: len(blocks)]
    found = np.empty_like(own)
    found[blocks] = own
    return np.asarray(found)


def _blocks(form: fem.Form, rows: Integers, columns: Integers) -> Array:
    """Return the block of a form in every cell, (cells, rows, columns)."""
    matrix = fem.assemble_matrix(form).to_scipy().tocsr()
    shape = (*rows.shape, columns.shape[1])
    of_rows = np.broadcast_to(rows[:, :, None], shape).ravel()
    of_columns = np.broadcast_to(columns[:, None, :], shape).ravel()
    return np.asarray(matrix[of_rows, of_columns]).reshape(shape)
