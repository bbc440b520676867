"""Stress and strain at places inside the body: those of the cells, recovered at the nodes.

At a node it is the mean over the cells around it, of one material each, so that it is continuous
inside a material and jumps from one to another. It is exact where the stress is linear and the
elements are of degree 2; at degree 1 each cell has one mean stress. So it is with the strain.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from ufl.core.expr import Expr

from fenics_contact.body.probe_points import PlacesInBody
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import STRAIN_OF_POINTS, STRESS_OF_POINTS
from fenics_contact.solve.systems.solution import Solution

#: Components of the stress by name → their place in the matrix.
COMPONENTS = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "yz": (1, 2), "xz": (0, 2), "xy": (0, 1)}
_IN_PLANE = ("xx", "yy", "zz", "xy")


class NodalMean:
    """A tensor of the solution, averaged over the cells that share a node; collective.

    Args:
        problem: The model.
        tensor: In UFL, (3, 3).
    """

    def __init__(self, problem: Problem, tensor: Expr) -> None:
        self._problem = problem
        mesh, spaces = problem.body.mesh, problem.spaces
        space = spaces.displacement_space
        points = compat.interpolation_points(space.element)
        if spaces.kinematics == "axisymmetric":
            # u_r / r has no value on the axis itself: look from a millionth inside.
            points = points + 1e-6 * (points.mean(axis=0) - points)
        #: Cells that this rank owns.
        self.cells = np.arange(
            mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32
        )
        self._expression = form_cache.expression(tensor, points)

    def at_nodes(self, cells: Integers | None = None) -> Array:
        """Return the tensor of the problem's present displacement, (nodes, 3, 3).

        Args:
            cells: Of this rank, over which it is averaged; by default all. Other nodes have 0.
        """
        mesh, spaces = self._problem.body.mesh, self._problem.spaces
        chosen = (self.cells if cells is None else cells).astype(np.int32)
        nodes = spaces.displacement_space.dofmap.list[chosen].ravel()
        count = len(spaces.coordinates)
        values = np.zeros((0, 9))
        if len(chosen):
            values = self._expression.eval(mesh, chosen).reshape(-1, 9)
        columns = (*values.T, np.ones(len(nodes)))
        summed = [np.bincount(nodes, column, count) for column in columns]
        *tensor, cells_around = spaces.summed(np.stack(summed, axis=1)).T
        return np.stack(tensor / np.maximum(cells_around, 1.0), axis=1).reshape(-1, 3, 3)


class NodalStress(NodalMean):
    """Cauchy stress, averaged over the cells that share a node; collective.

    Args:
        problem: The model.
    """

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem, problem.elastic.stress())


class StressAtPlaces:
    """Stress and strain at places of the body; collective.

    On a face between cells of two materials it is their mean; on a face between two bodies it is
    that of the body whose mesh came first.

    Args:
        problem: The model.
        places: The places, (places, 3) (length).

    Attributes:
        inside: Whether each place is in the body, (places,).
    """

    def __init__(self, problem: Problem, places: Array) -> None:
        self._problem, self._stress = problem, NodalStress(problem)
        self._places = PlacesInBody(places, problem.spaces)
        self.inside = self._places.inside
        self._material = material_of_cells(problem)
        spaces = problem.spaces
        nodes = spaces.displacement_space.dofmap.list
        needed = np.zeros((len(spaces.coordinates), 1))
        needed[nodes[self._places.cells].ravel()] = 1.0
        near = (spaces.summed(needed)[:, 0] > 0)[nodes[self._stress.cells]].any(axis=1)
        self._near = self._stress.cells[near]

    def stress(self) -> Array:
        """Stress of the problem's present displacement, (places, 3, 3), 0 outside (stress)."""
        return self._values(self._stress)

    def strain(self) -> Array:
        """Strain of the problem's present displacement, (places, 3, 3), 0 outside."""
        return self._values(self._strain)

    @cached_property
    def _strain(self) -> NodalMean:
        return NodalMean(self._problem, self._problem.elastic.total_strain())

    def _values(self, tensor: NodalMean) -> Array:
        """A tensor at the places, (places, 3, 3), 0 outside; collective."""
        problem, places = self._problem, self._places
        nodes = problem.spaces.displacement_space.dofmap.list
        summed = np.zeros((len(self.inside), 10))
        for number in range(len(problem.scene.material)):
            of_material = self._near[self._material[self._near] == number]
            nodal = tensor.at_nodes(of_material).reshape(-1, 9)
            mine = self._material[places.cells] == number
            found = np.einsum("pn,pnc->pc", places.weights[mine], nodal[nodes[places.cells[mine]]])
            np.add.at(summed[:, :9], places.numbers[mine], found)
            np.add.at(summed[:, 9], places.numbers[mine], 1.0)
        summed = np.asarray(total(problem.comm, summed))
        return (summed[:, :9] / np.maximum(summed[:, 9:], 1.0)).reshape(-1, 3, 3)


def material_of_cells(problem: Problem) -> Integers:
    """Number of the material of each cell of this rank, owned and ghost."""
    body = problem.body
    cells = body.mesh.topology.index_map(body.dimension)
    found = np.zeros(cells.size_local + cells.num_ghosts, dtype=np.int64)
    for number, material in enumerate(problem.scene.material):
        group = None if material.on is None else body.find(material.on)
        if group is not None:
            found[body.entities(group)] = number
    return found


def components_of(dimension: int) -> tuple[str, ...]:
    """Components of the stress that a model has, by name.

    Args:
        dimension: Number of its axes.
    """
    return tuple(COMPONENTS) if dimension == 3 else _IN_PLANE


def stress_at_points(problem: Problem, solution: Solution) -> dict[str, float]:
    """Stress and strain at the scene's points in a solution, by quantity; collective.

    Args:
        problem: The model, in the state of the solution.
        solution: The solution.
    """
    points = problem.scene.point
    if not points:
        return {}
    solution.find_body()  # the stress is that of the functions which it fills
    places = np.array(problem.points.places)
    at_points = problem.discrete.once(
        f"stress at points {points}", lambda: StressAtPlaces(problem, places)
    )
    tensors = {STRESS_OF_POINTS: at_points.stress(), STRAIN_OF_POINTS: at_points.strain()}
    return {
        f"{begin}{point.name}_{name}": float(tensor[COMPONENTS[name]])
        for begin, every in tensors.items()
        for point, tensor in zip(points, every, strict=True)
        for name in components_of(problem.spaces.components)
    }
