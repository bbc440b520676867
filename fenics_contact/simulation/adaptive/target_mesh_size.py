"""How many cells the next mesh is to have, and which sizes it must not exceed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.contact_areas import edges
from fenics_contact.mesh.size_field import SINGULAR
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.quantities import table
from fenics_contact.quantities.quantity import Edge
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import LevelRecord
from fenics_contact.simulation.adaptive.goals import Goals
from fenics_contact.simulation.adaptive.next_mesh import MeshDensity, next_mesh
from fenics_contact.simulation.adaptive.targets import others_than_mesh
from fenics_contact.simulation.scene_run import Run

# Of the cells, from one level to the next: at least and at most so many times as many.
_LEAST, _MOST = 1.2, 4.0
# Likewise, at most, while few cells make most of the error: more of the others would not help.
_MOST_AT_POINTS = 2.0
# Likewise, at least, where the edges of contact or stick get smaller ones.
_FEWER = 0.5
# Order of a quantity's error over that of the energy norm's, before there are two levels.
_FIRST_ORDER = 1.4
# What an error is to become over what is allowed.
_AIM_AT = 0.85
# Likewise of an area: cells at an edge are few, and it varies by chance. And by how much these
# become smaller at the most, at once.
_EDGE_AIM, _EDGE_LEAST = 0.5, 0.1
# What an unknown error is taken to be, over what is allowed.
_UNKNOWN = 2.0
_LEFT = 0.3  # share of the mesh whatever others take: they are to become smaller, too
_FILLED = 0.9  # of the dofs allowed: Gmsh makes about so many of sizes, not just so many
_TRIES = 3


class BudgetExceededError(Exception):
    """Raised where the scene's limits do not suffice for another level."""


class TargetMeshSize:
    """The sizes of cells of the next mesh, by the errors of a level.

    Args:
        run: That of the level, with estimated errors of its cells.
        levels: All levels so far.
        asked: Quantity → relative error that is allowed.
        errors: What they are.
        goals: Which cells count for them.
        first_sizes: Of each contact, rows of x, y, z and a size that its surfaces are to keep,
            on this rank (length).
    """

    def __init__(
        self,
        run: Run,
        levels: Sequence[LevelRecord],
        asked: Mapping[str, float],
        errors: Errors,
        goals: Goals,
        first_sizes: Sequence[Array],
    ) -> None:
        assert run.scene.accuracy is not None
        self._run, self._levels, self._asked, self._errors = run, levels, asked, errors
        self._cells, self._first_sizes = goals.of(self._urgency()), first_sizes
        self._accuracy = run.scene.accuracy

    def mesh(self, has_own_body: bool) -> Body:
        """A mesh of as many cells as the errors ask for; collective.

        Args:
            has_own_body: Whether the first mesh was passed, and is not the scene's.

        Raises:
            BudgetExceededError: That is more than allowed.
        """
        run, at_edges, kept = self._run, self._edges(), self._kept()
        cells, dofs = self._levels[-1].cells, self._levels[-1].dofs
        most = cells * self._accuracy.max_dofs / dofs
        has_edges = total(run.problem.comm, len(at_edges)) > 0
        wanted = cells * self._growth(has_edges)
        used_up = BudgetExceededError(
            f"the accuracy.max_dofs = {self._accuracy.max_dofs} do not suffice for a finer mesh"
        )
        if _LEAST * cells > most:
            raise used_up
        wanted = min(wanted, _FILLED * most)
        for _ in range(_TRIES):
            density = MeshDensity(wanted, self._cells, np.concatenate([at_edges, *kept]))
            body = next_mesh(run.scene, run.problem, density, has_own_body)
            found = body.mesh.topology.index_map(body.dimension).size_global
            if found <= most:
                return body
            wanted *= _FILLED * most / found
        raise used_up

    def _urgency(self) -> dict[str, float]:
        """Return each quantity's error over the allowed one; of areas at most that of others.

        What areas are off by is a matter of their edges first, where cells are made smaller anyway.
        """
        found = {name: self._mesh_ratio((name,)) for name in self._errors}
        areas = self._areas()
        others = max((ratio for name, ratio in found.items() if name not in areas), default=1.0)
        return {name: min(r, others) if name in areas else r for name, r in found.items()}

    def _edges(self) -> Array:
        """Sizes that cells at edges of contact and stick are not to exceed, on this rank.

        An area is as wrong as a share of the pieces that its edge passes through: the error goes
        with their size.
        """
        run = self._run
        assert run.solution is not None
        rows = [np.zeros((0, 4))]
        for contact, state in zip(run.problem.contacts, run.solution.states, strict=True):
            for edge, found in zip(Edge, edges(contact, state), strict=True):
                areas = table.bounded_by(edge)
                ratio = self._mesh_ratio(self._asked_of(areas, contact.label))
                if ratio > 0:
                    share = float(np.clip(_EDGE_AIM / ratio, _EDGE_LEAST, 1.0))
                    rows.append(found * [1, 1, 1, share])
        return np.concatenate(rows)

    def _kept(self) -> list[Array]:
        """Rows of the sizes that contacts are to keep which touch anywhere; collective."""
        run = self._run
        assert run.solution is not None
        touches = [(state.status != OPEN).any() for state in run.solution.states]
        found = total(run.problem.comm, np.array(touches, dtype=np.int64)) > 0
        return [rows for rows, is_kept in zip(self._first_sizes, found, strict=True) if is_kept]

    def _areas(self) -> list[str]:
        return self._asked_of([name for edge in Edge for name in table.bounded_by(edge)])

    def _asked_of(self, quantities: Sequence[str], contact: str = "") -> list[str]:
        """The names asked for that are of some quantities, of a contact or of all."""
        find = self._run.scene.names.find
        found = [(text, find(text)) for text in self._asked]
        owners = ("", contact)
        return [
            t for t, n in found if n.quantity in quantities and (not contact or n.owner in owners)
        ]

    def _mesh_ratio(self, names: Sequence[str]) -> float:
        """The mesh's error over what is left to it, the largest of some quantities."""
        ratios = [0.0]
        for name in names:
            found = self._errors[name]
            others = sum(others_than_mesh(found).values())
            left = max(self._asked[name] - others, _LEFT * self._asked[name])
            ratios.append(_UNKNOWN if found["mesh"] is None else found["mesh"] / left)
        return max(ratios)

    def _growth(self, has_edges: bool) -> float:
        """How many times as many cells the errors ask for, but for those of areas, at edges."""
        order = self._run.problem.spaces.degree / self._run.problem.body.dimension
        areas = self._areas() if has_edges else []
        growths = [
            (self._mesh_ratio((name,)) / _AIM_AT)
            ** (1 / np.clip(self._observed_order(name, order), order, 2 * order))
            for name in self._errors
            if name not in areas
        ]
        least = _FEWER if has_edges and growths else _LEAST
        most = _MOST_AT_POINTS if self._is_at_points() else _MOST
        return float(np.clip(max(growths, default=0.0), least, most))

    def _is_at_points(self) -> bool:
        """Whether few cells, as those at singular points, make most of the error."""
        squared, comm = self._cells, self._run.problem.comm
        whole = total(comm, squared.sum())
        large = squared > SINGULAR * whole / self._levels[-1].cells
        return bool(total(comm, squared[large].sum()) > 0.5 * whole)

    def _observed_order(self, name: str, order: float) -> float:
        """Return the order of a quantity's error in the number of cells, by the last two levels.

        At first it is taken to be between that of the energy norm and twice that.
        """
        if len(self._levels) < 2:
            return _FIRST_ORDER * order
        before, now = (level.sources[name]["mesh"] for level in self._levels[-2:])
        more = self._levels[-1].cells / self._levels[-2].cells
        if not (before and now) or more < _LEAST:
            return _FIRST_ORDER * order
        return float(np.log(before / now) / np.log(more))
