"""The history of stress and strain inside the cells near contacts, on rank 0."""

from __future__ import annotations

from dataclasses import dataclass

import basix
import numpy as np
import ufl
from scipy.spatial import cKDTree

from fenics_contact.analyses.fretting.table import Fretting
from fenics_contact.body.elasticity import Isotropic
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, gathered_on_root
from fenics_contact.contact.state import OPEN
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.solve.systems.solution import Solution


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells near contacts, of all ranks.

    Attributes:
        nodes: Numbers of each cell's nodes, (cells, nodes a cell).
        coordinates: Of these, (cells, nodes a cell, 3) (length).
        group: Number of body and material of each cell: stress jumps from one to the next.
        part: The connected part that each is of.
        samples: Where stress is asked, (cells, samples, 3) (length).
        youngs_modulus: There, (cells, samples); not a number of anisotropic materials (stress).
        of_contact: Node → number of a contact on whose surface it lies.
    """

    nodes: Integers
    coordinates: Array
    group: Integers
    part: Integers
    samples: Array
    youngs_modulus: Array
    of_contact: dict[int, int]


class StressRegion:
    """The region around the contacts of a model; collective, as all it has.

    Samples of stress lie where finite elements of its degree have it most accurate: in the middle
    of cells of degree 1, at the points of Gauss' rule for linear stresses in those of degree 2.

    Args:
        problem: The model.
        depth: How far from the contacts' surfaces (length).

    Attributes:
        cells: On rank 0; None on the others.
    """

    def __init__(self, problem: Problem, depth: float) -> None:
        self._problem = problem
        self._mesh = problem.body.mesh
        self._cells = self._near(depth)
        elastic, displacement = problem.elastic, problem.displacement
        points = _sample_points(self._mesh.topology.cell_name(), problem.spaces.degree)
        both = [elastic.stress(), elastic.elastic_strain(displacement)]
        vector = ufl.as_vector([tensor[i, j] for tensor in both for i, j in _ENTRIES])
        self._expression = form_cache.expression(vector, points)
        self._count = len(points)
        self.cells = self._gather(points)

    def samples(self) -> Array | None:
        """Stress and strain of the problem's present displacement, on rank 0; collective.

        Returns:
            (cells · samples, 12): of each the entries xx, yy, zz, yz, xz, xy; None on other ranks.
        """
        values = self._expression.eval(self._mesh, self._cells)
        found = gathered_on_root(self._problem.comm, np.asarray(values).reshape(-1, 12))
        return None if found is None else np.concatenate(found)

    def touched(self, touched: list[Flags]) -> Array:
        """Places of the contact points that touched, those of all ranks, (points, 3); collective.

        Args:
            touched: Of each contact, at its points of this rank.
        """
        contacts = self._problem.contacts
        mine = [c.trace.coordinates[found] for c, found in zip(contacts, touched, strict=True)]
        return gather_rows(self._problem.comm, np.concatenate([np.zeros((0, 3)), *mine]))

    def _near(self, depth: float) -> Integers:
        """This rank's cells around nodes near a contact's surface, and those around them."""
        spaces, traces = self._problem.spaces, []
        for contact in self._problem.contacts:
            traces += [contact.trace.coordinates]
            if contact.sides.opposite is not None:
                traces += [contact.sides.opposite.coordinates]
        points = gather_rows(spaces.comm, np.concatenate([np.zeros((0, 3)), *traces]))
        near = cKDTree(points).query(spaces.coordinates, distance_upper_bound=depth)[0] <= depth
        owned = self._mesh.topology.index_map(self._mesh.topology.dim).size_local
        nodes = spaces.displacement_space.dofmap.list[:owned]
        for _ in range(2):  # the second time for the patches of nodes at the rim
            chosen = near[nodes].any(axis=1)
            around = np.zeros((len(near), 1))
            around[nodes[chosen].ravel()] = 1.0
            near = spaces.summed(around)[:, 0] > 0
        return np.flatnonzero(chosen).astype(np.int32)

    def _gather(self, points: Array) -> Cells | None:
        """All there is to know of the cells, on rank 0."""
        problem, spaces = self._problem, self._problem.spaces
        nodes = spaces.displacement_space.dofmap.list[self._cells]
        index_map = spaces.displacement_space.dofmap.index_map
        numbers = index_map.local_to_global(nodes.ravel().astype(np.int32)).reshape(nodes.shape)
        parts = spaces.parts.of_node[nodes[:, 0]]
        groups = parts * len(problem.scene.material) + self._materials()
        place = form_cache.expression(ufl.SpatialCoordinate(self._mesh), points)
        places = np.asarray(place.eval(self._mesh, self._cells))
        samples = np.zeros((len(nodes), self._count, 3))
        dimension = self._mesh.geometry.dim  # not -1: a rank may have no cells
        samples[..., :dimension] = places.reshape(len(nodes), self._count, dimension)
        pieces = (numbers, spaces.coordinates[nodes], groups, parts, samples, self._moduli(points))
        found = gathered_on_root(problem.comm, (*pieces, self._on_contacts()))
        if found is None:
            return None
        *columns, labels = zip(*found, strict=True)
        nodes, coordinates, groups, parts, samples, moduli = map(np.concatenate, columns)
        return Cells(
            nodes=nodes,
            coordinates=coordinates,
            group=groups,
            part=parts,
            samples=samples,
            youngs_modulus=moduli,
            of_contact={node: number for one in labels for node, number in one.items()},
        )

    def _materials(self) -> Integers:
        """Number of the material of each cell."""
        body = self._problem.body
        owned = body.mesh.topology.index_map(body.dimension).size_local
        found = np.zeros(owned, dtype=np.int64)
        for number, material in enumerate(self._problem.scene.material):
            if material.on:
                cells = body.entities(body.group(material.on, f"material[{number}].on"))
                found[cells[cells < owned]] = number
        return found[self._cells]

    def _moduli(self, points: Array) -> Array:
        """Young's modulus at the samples, (cells, samples)."""
        law = self._problem.elastic.law
        if not isinstance(law, Isotropic):
            return np.full((len(self._cells), self._count), np.nan)
        expression = form_cache.expression(law.youngs_modulus, points)
        return np.asarray(expression.eval(self._mesh, self._cells)).reshape(-1, self._count)

    def _on_contacts(self) -> dict[int, int]:
        """Global number of a node → the contact on whose surface it lies, of this rank."""
        index_map = self._problem.spaces.displacement_space.dofmap.index_map
        found: dict[int, int] = {}
        for number, contact in enumerate(self._problem.contacts):
            opposite = contact.sides.opposite
            for nodes in (contact.nodes, *([] if opposite is None else [opposite.nodes])):
                numbers = index_map.local_to_global(np.asarray(nodes, dtype=np.int32))
                found |= dict.fromkeys(numbers.tolist(), number)
        return found


# Entries of a symmetric tensor in the order of samples.
_ENTRIES = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def tensors(entries: Array) -> Array:
    """Symmetric tensors, (…, 3, 3), of their entries xx, yy, zz, yz, xz, xy, (…, 6)."""
    found = np.zeros((*entries.shape[:-1], 3, 3))
    for number, (i, j) in enumerate(_ENTRIES):
        found[..., i, j] = found[..., j, i] = entries[..., number]
    return found


def _sample_points(cell: str, degree: int) -> Array:
    """Reference coordinates of the samples of a cell."""
    is_tensor = cell in ("quadrilateral", "hexahedron")
    exact = 1 if degree == 1 else 3 if is_tensor else 2
    return np.asarray(basix.make_quadrature(getattr(basix.CellType, cell), exact)[0])


# Of pseudo-times that are the same.
_SAME_TIME = 1e-9


class _Cycle:
    """States of a cycle: stress and strain of each, on rank 0, and which points touched."""

    def __init__(self, touched: list[Flags]) -> None:
        self.samples: list[Array | None] = []
        self.touched = touched

    def add(self, samples: Array | None, touching: list[Flags]) -> None:
        self.samples.append(samples)
        for before, now in zip(self.touched, touching, strict=True):
            before |= now


class StressHistory:
    """Stress and strain near the contacts over the last cycle of loads; collective.

    Args:
        problem: The model.
        fretting: What its scene asks for.

    Attributes:
        region: Where.
    """

    def __init__(self, problem: Problem, fretting: Fretting) -> None:
        self._problem = problem
        self.region = StressRegion(problem, fretting.depth)
        self._cycles = cycles_of(problem.scene)
        self._begin = fretting.begin if self._cycles is None else self._cycles.begin
        self._done: _Cycle | None = None
        self._present: _Cycle | None = None
        if self._begin == 0:
            self._begin_cycle(self._at_rest(), self._nowhere())

    def resume(self) -> None:
        """Take up the load steps of another run, whose stress is not known."""
        self._done = self._present = None
        self._begin = np.inf if self._cycles is None else self._begin

    def add(self, time: float, solution: Solution) -> None:
        """Keep the stress of a load step that was accepted."""
        if time < self._begin * (1 - _SAME_TIME):
            return
        starts = self._cycles is None or time <= self._begin * (1 + _SAME_TIME)
        if self._present is None and not starts and solution.cycle is None:
            return  # somewhere in a cycle whose begin is not known
        _ = solution.displacement  # which brings the body's fields to this step
        samples = self.region.samples()
        touching = [state.status != OPEN for state in solution.states]
        if self._present is not None:
            self._present.add(samples, touching)
        if self._present is None or solution.cycle is not None:
            self._done = self._present if solution.cycle is not None else None
            self._begin_cycle(samples, touching)

    @property
    def states(self) -> int:
        """How many there are of the cycle, 0 where none is complete."""
        found = self._last
        return 0 if found is None else len(found.samples)

    @property
    def samples(self) -> Array | None:
        """The states of the last cycle, (states, samples, 12) as of ``StressRegion``; on rank 0."""
        found = self._last
        if found is None or found.samples[0] is None:
            return None
        return np.stack([values for values in found.samples if values is not None])

    def touched(self) -> Array:
        """Places of the points that touched in it, (points, 3) (length); collective."""
        found = self._last
        return self.region.touched(self._nowhere() if found is None else found.touched)

    @property
    def _last(self) -> _Cycle | None:
        return self._present if self._cycles is None else self._done

    def _begin_cycle(self, samples: Array | None, touching: list[Flags]) -> None:
        self._present = _Cycle(self._nowhere())
        self._present.add(samples, touching)

    def _nowhere(self) -> list[Flags]:
        return [np.zeros(len(c.trace.weights), dtype=bool) for c in self._problem.contacts]

    def _at_rest(self) -> Array | None:
        """Return the state of the body without any load."""
        cells = self.region.cells
        return None if cells is None else np.zeros((cells.samples[..., 0].size, 12))
