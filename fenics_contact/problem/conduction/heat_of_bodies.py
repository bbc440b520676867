"""Conduction in the bodies: the matrix of the first rank, and what boundaries have of heat.

The unknown is the rise, the temperature less the reference temperature, at every node of the
displacements. It is one number a node, so that the first rank solves for all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from scipy.sparse import csr_matrix, identity
from ufl.core.expr import Expr

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.materials import MaterialPoints
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import gather_rows
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.scene.loading.heat import Heat
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Value

# Of the largest temperature that a boundary is given; and of shares of nodes.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class GivenRise:
    """A boundary with a given temperature.

    Attributes:
        on: The boundary.
        numbers: Of its nodes, over all ranks.
        rise: At each, where the path is 1 (temperature).
        path: Over pseudo-time.
    """

    on: Group
    numbers: Integers
    rise: Array
    path: Callable[[float], float]


@dataclass(frozen=True, eq=False)
class GivenFlow:
    """What a boundary takes in, by a flux or from what is around a film.

    Attributes:
        inward: Over area, in UFL, where the path is 1 (power/area).
        given: The same as the scene gives it, for functions of position.
        on: The boundary.
        nodal: The same at all nodes of all ranks (power).
        path: Over pseudo-time.
        table: Number of the heat in the scene.
    """

    inward: Expr
    given: Value
    on: Group
    nodal: Array
    path: Callable[[float], float]
    table: int


@dataclass(frozen=True, eq=False)
class FilmOn:
    """A film on a boundary, through which heat flows by the difference of temperature.

    Attributes:
        coefficient: Of the film (power/area/temperature).
        on: The boundary.
    """

    coefficient: float
    on: Group


class HeatOfBodies:
    """Conduction in the bodies of a scene; collective.

    Where a sector stands for a ring, nodes of one cut face have the temperatures of the other.

    Attributes:
        numbers: Of each node of this rank, over all ranks.
        count: Nodes of all ranks.
        is_plane: Whether the bodies have two dimensions.
        matrix: Of conduction and films, on every rank (power/temperature).
        given: Boundaries with given temperatures.
        flows: What boundaries take in.
        films: Those of boundaries.
        conductivity: In the cells, in UFL (power/length/temperature).
        space: That of the rise.
        scalar_of_node: The dof of ``space`` at each node of this rank.
        following: From the values of all nodes, of which those that follow across a cut do not
            count, to those of all, (nodes of all ranks, nodes of all ranks); on every rank.
        follows: Which nodes follow, (nodes of all ranks,).
        disturbance: Heat that flows in besides the scene's, at all nodes of all ranks (power), to
            see what it does; or None.

    Args:
        scene: With its heat and conductivities.
        spaces: Those of the body.
        cut: The cut faces of a sector, or None.

    Raises:
        InputError: A boundary of heat is none of the body, a value cannot be evaluated, or one cut
            face has other temperatures than the other one.
    """

    def __init__(self, scene: Scene, spaces: Spaces, cut: CutFaces | None = None) -> None:
        self._spaces, self.is_plane = spaces, spaces.body.dimension == 2
        self.space, self.scalar_of_node = space, scalar_of_node = spaces.scalar_space()
        index_map = space.dofmap.index_map
        self.count = int(index_map.size_global)
        self.numbers = index_map.local_to_global(scalar_of_node.astype(np.int32))
        self.disturbance: Disturbance | None = None
        self._reference = scene.material[0].reference_temperature
        trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
        self._test = test
        points = MaterialPoints(scene.material, spaces, varies=False)
        values = [float(one.conductivity or 0.0) for one in scene.material]
        self.conductivity = points.coefficient(points.evaluate("conductivity", values))
        form = spaces.weight * self.conductivity * ufl.inner(ufl.grad(trial), ufl.grad(test))
        self.matrix = self._whole(form_cache.form(form * spaces.bulk))
        self.given: list[GivenRise] = []
        self.flows: list[GivenFlow] = []
        self.films: list[FilmOn] = []
        for number, heat in enumerate(scene.heat):
            film = self._place(heat, number, trial)
            if film is not None:
                self.matrix += self._whole(form_cache.form(film))
        self.follows = np.zeros(self.count, dtype=bool)
        self.following = identity(self.count, format="csr")
        if cut is not None:
            self._follow(cut)

    def _follow(self, cut: CutFaces) -> None:
        """Let nodes of one cut face have the temperatures of the other; collective.

        Raises:
            InputError: On every rank; only one of them has a given temperature, or another one.
        """
        spaces = self._spaces
        own = np.arange(spaces.owned_nodes, dtype=np.int32)
        there = spaces.displacement_space.dofmap.index_map.local_to_global(own)
        rows = np.column_stack([there, self.numbers[: spaces.owned_nodes]])
        places, numbers = gather_rows(spaces.comm, rows).T
        numbers = numbers[np.argsort(places)]
        slaves, nodes, shares = cut.scalar_shares
        slaves, entries = numbers[slaves], shares.tocoo()
        ahead = slaves[entries.row], numbers[nodes[entries.col]]
        self.follows[slaves] = True
        kept = np.flatnonzero(~self.follows)
        values = np.concatenate([np.ones(len(kept)), entries.data])
        at = tuple(np.concatenate([kept, one]) for one in ahead)
        self.following = csr_matrix((values, at), shape=(self.count, self.count))
        self._require_alike(cut)

    def _require_alike(self, cut: CutFaces) -> None:
        """Refuse temperatures that are given on one cut face and not, turned, on the other."""
        for given in self.given:
            rise = np.zeros((self.count, 2))
            rise[given.numbers] = np.column_stack([given.rise, np.ones(len(given.rise))])
            off = np.abs(self.following @ rise - rise).max(axis=0, initial=0.0)
            if off[1] > _SAME or off[0] > _SAME * np.abs(given.rise).max(initial=0.0):
                raise InputError(
                    f"heat: temperatures are given at points of '{cut.given.on}' otherwise than at "
                    f"those of '{cut.given.against}', turned; give the same ones on both"
                )

    def _place(self, heat: Heat, number: int, trial: Expr) -> ufl.Form | None:
        """Take in what a boundary has, and return what it adds to the matrix; collective."""
        key = f"heat[{number}]"
        spaces, path = self._spaces, KeyedPath(heat.path, f"{key}.path")
        group = spaces.body.boundary(heat.on, f"{key}.on")
        measure, nodes = spaces.boundary(group), spaces.nodes(group)
        if heat.temperature is not None:
            rise = spaces.evaluate(heat.temperature, nodes, f"{key}.temperature")
            rows = gather_rows(
                spaces.comm, np.column_stack([self.numbers[nodes], rise - self._reference])
            )
            numbers, first = np.unique(rows[:, 0].astype(np.int64), return_index=True)
            self.given.append(GivenRise(group, numbers, rows[first, 1], path))
            return None
        if heat.film is None:
            assert heat.flux is not None
            values = spaces.evaluate(heat.flux, nodes, f"{key}.flux")
            self._take_in(spaces.coefficient(values, nodes), heat.flux, group, path, number)
            return None
        coefficient = heat.film.coefficient
        inward = coefficient * (heat.film.temperature - self._reference)
        if inward != 0:
            self._take_in(ufl.as_ufl(inward), inward, group, path, number)
        self.films.append(FilmOn(coefficient, group))
        film: ufl.Form = spaces.weight * coefficient * trial * self._test * measure
        return film

    def _take_in(self, inward: Expr, given: Value, on: Group, path: KeyedPath, table: int) -> None:
        """Add what a boundary takes in, over area; collective."""
        work = self._spaces.weight * inward * self._test * self._spaces.boundary(on)
        nodal = self.nodal(form_cache.form(work))
        self.flows.append(GivenFlow(inward, given, on, nodal, path, table))

    def _whole(self, form: fem.Form) -> csr_matrix:
        """A matrix of all ranks, with the nodes' numbers over all of them; collective."""
        index_map = self.space.dofmap.index_map
        count = index_map.size_local + index_map.num_ghosts
        numbers = index_map.local_to_global(np.arange(count, dtype=np.int32))
        # Columns of nodes that only other ranks' cells have come last, and are empty.
        own = csr_matrix(fem.assemble_matrix(form).to_scipy(ghosted=True))[:, :count].tocoo()
        comm = self._spaces.comm
        places = gather_rows(comm, numbers[own.row]), gather_rows(comm, numbers[own.col])
        return csr_matrix((gather_rows(comm, own.data), places), shape=(self.count, self.count))

    def nodal(self, form: fem.Form) -> Array:
        """A linear form at all nodes of all ranks; collective."""
        own = np.array(fem.assemble_vector(form).array)
        index_map = self.space.dofmap.index_map
        numbers = index_map.local_to_global(np.arange(len(own), dtype=np.int32))
        comm = self._spaces.comm
        rows = gather_rows(comm, np.column_stack([numbers, own]))
        return np.bincount(rows[:, 0].astype(np.int64), rows[:, 1], self.count)

    def taken_in(self, time: float) -> Array:
        """What boundaries take in at a pseudo-time, (nodes of all ranks,) (power)."""
        found = np.zeros(self.count) if self.disturbance is None else self.disturbance.at(time)
        for flow in self.flows:
            found = found + flow.path(time) * flow.nodal
        return found

    def given_at(self, time: float) -> tuple[Integers, Array]:
        """Numbers of nodes whose rise is given at a pseudo-time, and that rise (temperature).

        Without those that follow across a cut. Where boundaries meet, the first one counts.
        """
        found, first, _ = self._counted
        rises = [np.zeros(0), *(one.path(time) * one.rise for one in self.given)]
        return found, np.concatenate(rises)[first]

    def nodes_of_given(self, number: int) -> Integers:
        """Numbers of nodes whose rise is that of one of ``given``.

        Args:
            number: Of the boundary there.
        """
        found, _, owner = self._counted
        return np.asarray(found[owner == number])

    @property
    def _counted(self) -> tuple[Integers, Integers, Integers]:
        """Numbers of nodes with a given rise, their places in all of ``given``, and in which."""
        numbers = [np.zeros(0, dtype=np.int64), *(one.numbers for one in self.given)]
        owner = np.repeat(np.arange(len(self.given)), [len(one) for one in numbers[1:]])
        found, first = np.unique(np.concatenate(numbers), return_index=True)
        moves = ~self.follows[found]
        return found[moves], first[moves], owner[first[moves]]
