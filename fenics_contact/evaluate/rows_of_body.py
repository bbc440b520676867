"""Rows that a body keeps for its measured numbers: of supports, parts, points and surfaces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from fenics_contact.body.transposed_form import ForcesOnState, TransposedForm
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.evaluate.internal_forces import own_dofs
from fenics_contact.evaluate.nodal_forces import stress_on
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.schur import Functional, GivenState, Key, Wanted

# Of a normal: squares of components below it are round-off.
_ACROSS = 1e-9
# By support and axis first: factors of what the bulk needs at each dof, and forces on the state.
_SharedParts = Mapping[Any, tuple[Array, ForcesOnState]]


class RowsOfBody:
    """The numbers of an answer that are linear in the displacement; collective, as all.

    Args:
        problem: The model.
        body: The body, condensed.
    """

    def __init__(self, problem: Problem, body: CondensedBody) -> None:
        self._problem, self._body, self._rows = problem, body, body.rows
        share = body.stiffness.share
        forces = problem.elastic.scalar_forces
        #: This rank's shares of what a unit of each of its scalars puts on the body (force/length).
        self.of_scalars = self._rows.once(
            "scalars", lambda: [share(one.nodal, one.on_mean_stress) for one in forces]
        )

    def given(self, loads: Sequence[Array], held: Sequence[Array]) -> list[Functional]:
        """Functionals of loads, held displacements and forces of the body's scalars.

        Args:
            loads: This rank's shares (force).
            held: At all nodes, 0 but where held, (nodes, components) each (length).
        """
        at_unknowns = self._body.stiffness.at_unknowns
        return [
            *(Functional(forces=share) for share in loads),
            *(Functional(held=at_unknowns(nodal)) for nodal in held),
            *(Functional(forces=share) for share in self.of_scalars),
        ]

    def make_all(self) -> None:
        """Make the rows that an answer of the problem asks for, if they are not there."""
        problem, rows = self._problem, self._rows
        none = np.zeros(len(problem.body_scalars))
        held = np.zeros(int(rows.maker.held.sum()))
        state = GivenState(np.zeros(rows.maker.count), held, np.zeros(len(rows.maker.held)))
        self.supports(state, none)
        self.support_moments(state, none)
        self.of_parts(state)
        self.points(state)
        for number in range(len(problem.contacts)):
            self.stress(number, state, none)
            self.across(number, state)
        every = [u.prescribes for u in problem.unknowns if u.prescribes is not None]
        moved = [one.of_all(problem.load.size).reshape(problem.load.shape) for one in every]
        load = self._body.stiffness.share(problem.load)
        rows.given.shares(self.given([load], [prescribed(problem), *moved]))

    def supports(self, state: GivenState, scalars: Array) -> Array:
        """Resultant of each applied support, (supports, components) (force)."""
        problem = self._problem
        found = np.zeros((len(problem.applied_supports), problem.spaces.components))
        for (number, axis, _), value in self._by_parts(state).items():
            found[int(number), int(axis)] += value
        return found + self._beyond(state, scalars)

    def _by_parts(self, state: GivenState) -> dict[Key, float]:
        """Resultants by support, axis and part of the body; radial forces cancel."""
        wanted = self._rows.once("supports", self._reactions)
        return self._rows.group("supports").values(wanted, state)

    def _reactions(self) -> Wanted:
        problem = self._problem
        spaces, parts = problem.spaces, problem.spaces.parts
        size = spaces.components
        wanted: dict[Key, Callable[[], Functional]] = {}
        first = 1 if spaces.kinematics == "axisymmetric" else 0
        for number, dofs in enumerate(own_dofs(problem)):
            for axis in range(first, size):
                along = dofs[dofs % size == axis]
                of_part = parts.of_node[along // size]
                counts = total(problem.comm, np.bincount(of_part, minlength=parts.count))
                for part in np.flatnonzero(counts):
                    chosen = along[of_part == part]
                    wanted[number, axis, int(part)] = partial(self._held, chosen, 1.0)
        return wanted

    def _held(self, dofs: Integers, values: Array | float) -> Functional:
        """Σ of reactions at held dofs, times values."""
        nodal: Array = np.zeros(self._problem.load.size)
        nodal[dofs] = values
        nodal = nodal.reshape(self._problem.load.shape)
        return Functional(held=self._body.stiffness.at_unknowns(nodal))

    def _beyond(self, state: GivenState, scalars: Array) -> Array:
        """Where supports meet, what each has of what is counted to the first, as ``supports``."""
        problem = self._problem
        found = np.zeros((len(problem.applied_supports), problem.spaces.components))
        parts = self._rows.once("shared reactions", lambda: problem.shared_reactions.moved_by())
        for key, value in self._of_shared("shared", parts, state, scalars).items():
            found[int(key[0]), int(key[1])] = value
        return found

    def _of_shared(
        self, name: str, parts: _SharedParts, state: GivenState, scalars: Array
    ) -> dict[Key, float]:
        """Values of forces on the state, and of factors of what the bulk needs at held dofs."""
        wanted: dict[Key, Callable[[], Functional]]
        wanted = {key: partial(self._on_state, one, held) for key, (held, one) in parts.items()}
        values = self._rows.group(name).values(wanted, state) if parts else {}
        return {
            key: float(values[key] + one.on_scalars @ scalars) for key, (_, one) in parts.items()
        }

    def support_moments(self, state: GivenState, scalars: Array) -> Array:
        """Moment of each applied support, (supports, rotations) (force times length)."""
        problem = self._problem
        centres, count = problem.support_moments.centres, len(problem.applied_supports)
        found = np.zeros((count, 1 if problem.spaces.components == 2 else 3))
        if not centres:
            return found[:, :0]
        about = str([centre.tolist() for centre in centres])  # rows are of these points
        wanted = self._rows.once(f"moments about {about}", self._turning)
        for key, value in self._rows.group("moments of supports").values(wanted, state).items():
            found[int(key[0]), int(key[1])] = value
        parts = self._rows.once(f"shared about {about}", self._shared_turning)
        for key, value in self._of_shared("shared moments", parts, state, scalars).items():
            found[int(key[0]), int(key[1])] += value
        return found

    def _turning(self) -> Wanted:
        """Moments of reactions at each support's own dofs, by its number, axis and point."""
        problem = self._problem
        centres = problem.support_moments.centres
        wanted: dict[Key, Callable[[], Functional]] = {}
        for number, dofs in enumerate(own_dofs(problem)):
            ways = problem.support_moments.of_unit_rotations(number, dofs)
            sizes = total(problem.comm, np.abs(ways).sum(axis=1))
            for axis in np.flatnonzero(sizes):
                key = (number, int(axis), *centres[number].tolist())
                wanted[key] = partial(self._held, dofs, ways[axis])
        return wanted

    def _shared_turning(self) -> _SharedParts:
        """Parts of the moments of reactions at dofs that several supports share."""
        shared, turned = self._problem.shared_reactions, self._problem.support_moments
        numbers = range(len(self._problem.applied_supports))
        ways = [turned.of_unit_rotations(number, shared.dofs) for number in numbers]
        found, centres = shared.moved_along_by(ways), turned.centres
        return {(*key, *centres[key[0]].tolist()): forces for key, forces in found.items()}

    def of_parts(self, state: GivenState) -> tuple[Array, Array]:
        """Forces and moments of supports on each connected part of the body.

        Returns:
            Their resultants, (supports, parts, components) (force), and the moments of all of them
            about the part's centre over its size, (parts, 3) (force).
        """
        problem = self._problem
        parts, size = problem.spaces.parts, problem.spaces.components
        resultants = np.zeros((len(problem.applied_supports), parts.count, size))
        for key, value in self._by_parts(state).items():
            number, axis, part = map(int, key)
            resultants[number, part, axis] = value
        moments = np.zeros((parts.count, 3))
        wanted = self._rows.once("moments", self._moments)
        for key, value in self._rows.group("moments").values(wanted, state).items():
            moments[tuple(map(int, key))] = value
        return resultants, moments

    def _moments(self) -> Wanted:
        """Σ (x × r)_i of each part; none in axisymmetric models."""
        problem = self._problem
        spaces, parts = problem.spaces, problem.spaces.parts
        if spaces.kinematics == "axisymmetric":
            return {}
        dofs = problem.constrained
        wanted: dict[Key, Callable[[], Functional]] = {}
        nodes, axes = dofs // spaces.components, dofs % spaces.components
        arms = parts.arms[nodes] / parts.sizes[parts.of_node[nodes], None]
        turned = np.cross(arms, np.eye(3)[axes])
        for part in range(parts.count):
            inside = parts.of_node[nodes] == part
            sizes = total(problem.comm, np.abs(turned[inside]).sum(axis=0))
            for axis in np.flatnonzero(sizes):
                values = np.where(inside, turned[:, axis], 0.0)
                wanted[part, int(axis)] = partial(self._held, dofs, values)
        return wanted

    def stabilised(self, state: GivenState) -> Array:
        """Reactions at dofs that a stabilisation holds, on every rank (force)."""
        held = [support.dofs for support in self._problem.stabilisation]
        found = self._at_dofs("stabilised", np.unique(np.concatenate(held)), state)
        return np.array(list(found.values()))

    def across(self, number: int, state: GivenState) -> Array:
        """Reactions at a contact's nodes where supports act across it; mostly there are none.

        Returns:
            (nodes, components) (force).
        """
        problem, contact = self._problem, self._problem.contacts[number]
        size = problem.spaces.components
        normals = contact.trace.normals[: len(contact.nodes)]
        is_held = ~problem.free[contact.nodes] & (normals**2 > _ACROSS)
        nodes, axes = np.nonzero(is_held)
        dofs = contact.nodes[nodes].astype(np.int64) * size + axes
        values = self._at_dofs(f"across {number}", dofs, state)
        found = np.zeros(is_held.shape)
        found[nodes, axes] = [values[key] for key in self._numbers(dofs)]
        return found

    def _at_dofs(self, name: str, dofs: Integers, state: GivenState) -> dict[Key, float]:
        """Reactions at held dofs of this rank (owned and ghost), and at those of all others."""
        numbers = self._numbers(dofs)
        every = gather_rows(self._problem.comm, np.array(numbers, dtype=np.int64).reshape(-1, 1))
        wanted: dict[Key, Callable[[], Functional]] = {}
        for number in np.unique(every).tolist():
            here = dofs[[key == (number,) for key in numbers]]
            wanted[(number,)] = partial(self._held, here, 1.0)
        return self._rows.group(name, is_portable=False).values(wanted, state)

    def _numbers(self, dofs: Integers) -> list[Key]:
        """Numbers over all ranks of dofs of this rank."""
        spaces = self._problem.spaces
        size, index_map = spaces.components, spaces.displacement_space.dofmap.index_map
        nodes = index_map.local_to_global((dofs // size).astype(np.int32)).astype(np.int64)
        return [(number,) for number in (nodes * size + dofs % size).tolist()]

    def stress(self, number: int, state: GivenState, scalars: Array) -> Array:
        """∫ σ n over the slave surface of a contact, by its number, (components,) (force)."""
        name = f"stress {number}"
        parts = self._rows.once(name, partial(self._stress_at, number))
        wanted: Wanted = {(n,): partial(self._on_state, one) for n, one in enumerate(parts)}
        found = np.array(list(self._rows.group(name).values(wanted, state).values()))
        return found + [one.on_scalars @ scalars for one in parts]

    def _stress_at(self, number: int) -> list[ForcesOnState]:
        """Forces on the state whose work is ∫ σ n, by components."""
        problem = self._problem
        spaces, elastic = problem.spaces, problem.elastic
        form = stress_on(spaces, elastic, problem.contacts[number].sides.group)
        transposed = TransposedForm(form, spaces, elastic, elastic.displacement)
        units = np.broadcast_to(
            np.eye(spaces.components)[:, None], (spaces.components, *problem.load.shape)
        )
        return [transposed.of(unit) for unit in units]

    def _on_state(self, forces: ForcesOnState, held: Array | None = None) -> Functional:
        """The functional of forces on the state and of factors of reactions at the nodes' dofs."""
        stiffness = self._body.stiffness
        share = stiffness.share(forces.nodal, forces.on_mean_stress)
        at_held = None
        if held is not None:
            at_held = stiffness.at_unknowns(held.reshape(forces.nodal.shape))
        return Functional(share, at_held)

    def points(self, state: GivenState) -> dict[str, list[float]]:
        """The displacement at the scene's points, by quantity."""
        points, size = self._problem.points, self._problem.spaces.components
        wanted = {
            (*place, axis): partial(self._at_point, number, axis)
            for number, place in enumerate(points.places)
            for axis in range(size)
        }
        found = self._rows.group("points").values(wanted, state)
        rows = [[found[*place, axis] for axis in range(size)] for place in points.places]
        return points.named(np.reshape(rows, (len(rows), size)))

    def _at_point(self, number: int, axis: int) -> Functional:
        """The displacement of a point along an axis."""
        force = self._problem.points.unit_force(number, axis)
        return Functional(forces=self._body.stiffness.at_unknowns(force))


def prescribed(problem: Problem) -> Array:
    """Displacements of supports at present, 0 elsewhere, (nodes, components) (length)."""
    found = np.zeros(problem.load.size)
    found[problem.constrained] = problem.prescribed
    return found.reshape(problem.load.shape)
