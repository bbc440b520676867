"""Temperatures of a model by stationary conduction, found together with the contact pressures.

How much heat crosses a contact depends on its pressure, which depends on the temperatures. A load
step is solved with temperatures that are held; these follow its pressures, and the step is solved
again, until nothing changes. The pressures are a fixed point, found by ``fixed_point``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import FenicsContactError, NotConvergedError
from fenics_contact.common.parallel import from_root, gather_rows, largest, raise_together
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.problem.conduction.condensed_heat import CondensedHeat
from fenics_contact.problem.conduction.fixed_point import FixedPoint
from fenics_contact.problem.conduction.heat_of_bodies import HeatOfBodies
from fenics_contact.problem.conduction.heat_of_contact import HeatOfContact
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.scene.scene import Scene

# Of the largest conductance: by no more may any change from one solve to the next.
_SAME = 1e-6
_MOST_SOLVES = 60
# Where solves are not exact enough for that: after so many, a change below this one counts as none
# that is not half of the least so far. The check ``heat_balance`` judges what is left.
_STALLED, _NOISE = 10, 1e-5
# Of the highest conductance at any pressure: where all are lower, pressures may be round-off.
_BARELY = 1e-5
_NEGLIGIBLE = 1e-9  # of heat that would flow without a balance: below that none flows


@dataclass(frozen=True, eq=False)
class HeatMemory:
    """Temperatures and pressures of a load step that was accepted.

    Attributes:
        rise: Temperature less the reference, at the nodes of this rank (temperature).
        pressures: Of each contact that conducts, at its points (stress).
    """

    rise: Array
    pressures: list[Array]


class Conduction:
    """Temperatures at the nodes; collective.

    Attributes:
        rise: Temperature less the reference, at the nodes of this rank (temperature).
        contacts: That conduct.
        bodies: Conduction in these.
        time: Present pseudo-time, of repeated cycles that in the first.

    Args:
        scene: With its heat.
        spaces: Those of the body.
        contacts: All, in scene order.
        cut: The cut faces of a sector, or None.
    """

    def __init__(
        self,
        scene: Scene,
        spaces: Spaces,
        contacts: Sequence[ContactSurface],
        cut: CutFaces | None,
    ) -> None:
        self._spaces, self._comm, self._every = spaces, spaces.comm, contacts
        self._path_time = scene.path_time
        self.bodies = HeatOfBodies(scene, spaces, cut)
        self.contacts = [
            HeatOfContact(contact, self.bodies)
            for contact in contacts
            if contact.contact.conductance is not None
        ]
        self._numbers = [contacts.index(one.contact) for one in self.contacts]
        self._parts = self._of_all_nodes(spaces.parts.of_node).astype(np.int64)
        surfaces = [np.zeros(0, dtype=np.int64), *(one.nodes for one in self.contacts)]
        self._condensed: CondensedHeat | None = None
        if self._comm.rank == 0:
            known = self.bodies, np.concatenate(surfaces), self._parts
            self._condensed = CondensedHeat(*known)
        self.rise = np.zeros(len(spaces.coordinates))
        self._pressures = [np.zeros(len(one.contact.trace.weights)) for one in self.contacts]
        self.time = 0.0
        self._way: FixedPoint | None = None
        self._finds_nearest = False
        self._solves, self._least = 0, np.inf

    @property
    def memory(self) -> HeatMemory:
        """Of the present state."""
        return HeatMemory(self.rise.copy(), [one.copy() for one in self._pressures])

    def of_all_contacts(self, memory: HeatMemory) -> list[Array]:
        """Pressures of a memory at the points of all contacts, 0 of those that do not conduct."""
        found = [np.zeros(len(one.trace.weights)) for one in self._every]
        for number, pressure in zip(self._numbers, memory.pressures, strict=True):
            found[number] = pressure
        return found

    def memory_of(self, rise: Array, pressures: Sequence[Array]) -> HeatMemory:
        """The memory of a rise at the nodes, and of pressures as ``of_all_contacts`` gave them."""
        return HeatMemory(rise.copy(), [pressures[number] for number in self._numbers])

    def recall(self, memory: HeatMemory | None) -> None:
        """Go back to a state that was remembered; None for that before the first load step."""
        self._finds_nearest = False
        self._way, self._solves, self._least = None, 0, np.inf
        if memory is None:
            self.rise = np.zeros_like(self.rise)
            self._pressures = [np.zeros_like(one) for one in self._pressures]
            return
        self.rise, self._pressures = memory.rise.copy(), [one.copy() for one in memory.pressures]

    def set_time(self, time: float) -> None:
        """Bring what boundaries have of heat to a pseudo-time; ``begin`` finds temperatures."""
        self.time = self._path_time(time)

    def begin(self) -> None:
        """Find the temperatures of the present time with the pressures there are; collective."""
        self._way, self._solves, self._least = None, 0, np.inf
        self.rise = self._solved(self._pressures)

    @property
    def may_have_several_answers(self) -> bool:
        """Whether a contact conducts the better, the more it is pressed."""
        return any(one.grows for one in self.contacts)

    @property
    def follows_pressures(self) -> bool:
        """Whether a conductance depends on the pressure, or on whether there is any."""
        return any(one.varies or one.contact.is_one_sided for one in self.contacts)

    @property
    def highest_pressure(self) -> float:
        """The highest pressure of which a conductance says anything (stress)."""
        return max(one.highest_pressure for one in self.contacts)

    def start_from(self, pressure: float) -> None:
        """Let the next load step find the answer that is nearest to a uniform pressure.

        Also one that nothing real stays in, since any change of the pressure grows.

        Args:
            pressure: At all points of contacts that conduct (stress).
        """
        self._pressures = [np.full_like(one, pressure) for one in self._pressures]
        self._finds_nearest = True

    def disturb(self, heat: Array | None, time: float) -> None:
        """Let heat flow in besides the scene's, from the next time on that ``begin`` is called.

        Args:
            heat: At all nodes of all ranks, (nodes,) (power); None for none.
            time: Pseudo-time at which it is so large; it grows evenly from nothing.
        """
        self.bodies.disturbance = (
            None if heat is None else Disturbance.growing(heat, self._path_time(time))
        )

    def follow(self, states: Sequence[ContactState], share: float = 1.0) -> bool:
        """Whether temperatures have changed with the pressures of a solve; collective.

        Args:
            states: Of all contacts.
            share: Of the change that counts as none, what is to be left of it.

        Raises:
            NotConvergedError: They have changed for too long.
        """
        found = [state.contact_pressure for state in self.states_of(states)]
        change = self._change(self._pressures, found)
        self._solves += 1
        is_noise = self._solves > _STALLED and 0.5 * self._least < change <= share * _NOISE
        self._least = min(self._least, change)
        if change <= share * _SAME or is_noise:
            return False
        if self._solves >= _MOST_SOLVES:
            raise NotConvergedError(
                f"time {self.time:g}: temperatures and contact pressures have not settled in "
                f"{_MOST_SOLVES} solves; conductances still change by {change:.2g} of the largest, "
                f"most at '{self._most_changed(self._pressures, found)}'",
                (),
            )
        self._pressures = self._ahead(found)
        self.rise = self._solved(self._pressures)
        return True

    def change(self, before: Sequence[ContactState], after: Sequence[ContactState]) -> float:
        """Largest change of a conductance, over the largest; collective.

        Args:
            before: Of all contacts.
            after: Likewise.
        """
        one, other = (
            [state.contact_pressure for state in self.states_of(states)]
            for states in (before, after)
        )
        return self._change(one, other)

    def _most_changed(self, one: Sequence[Array], other: Sequence[Array]) -> str:
        """Label of the contact whose conductance differs most at two pressures; collective."""
        changes = [
            largest(self._comm, np.abs(heat.conductances(after) - heat.conductances(before)))
            for heat, before, after in zip(self.contacts, one, other, strict=True)
        ]
        return self.contacts[int(np.argmax(changes))].contact.label

    def _change(self, one: Sequence[Array], other: Sequence[Array]) -> float:
        """Largest change of conductances between two pressures, over the largest; collective."""
        rows = [
            (heat.conductances(before)[heat.faces], heat.conductances(after)[heat.faces])
            for heat, before, after in zip(self.contacts, one, other, strict=True)
        ]
        every = np.concatenate([np.zeros(0), *(after for _, after in rows)])
        changes = np.concatenate([np.zeros(0), *(after - before for before, after in rows)])
        least = _BARELY * max((one.highest for one in self.contacts), default=0.0)
        size = max(largest(self._comm, every), least)
        change = largest(self._comm, np.abs(changes))
        return change / size if size > 0 else float(change > 0)

    def states_of(self, states: Sequence[ContactState]) -> list[ContactState]:
        """Those of the contacts that conduct, of the states of all."""
        return [states[number] for number in self._numbers]

    def _ahead(self, found: Sequence[Array]) -> list[Array]:
        """Pressures to go on with, by those of earlier solves; collective."""
        if self._way is None:
            owned = [one.contact.trace.owned & one.faces & one.varies for one in self.contacts]
            highest = [
                np.full(len(one), heat.highest_pressure if heat.varies else np.inf)
                for heat, one in zip(self.contacts, found, strict=True)
            ]
            bounded = np.concatenate(owned), np.concatenate(highest)
            self._way = FixedPoint(self._comm, *bounded, self._finds_nearest)
        ahead = self._way.next(np.concatenate(self._pressures), np.concatenate(list(found)))
        parts = np.split(ahead, np.cumsum([len(one) for one in found])[:-1])
        return [
            part if heat.varies else np.maximum(one, 0.0)
            for heat, one, part in zip(self.contacts, found, parts, strict=True)
        ]

    def _solved(self, pressures: Sequence[Array]) -> Array:
        """Rise at the nodes of this rank by pressures at the points; collective.

        Raises:
            InputError: On every rank; nothing says which temperature a body has.
        """

        def solve(condensed: CondensedHeat, *contacts: Any) -> Array:
            return condensed.solve(self.time, *contacts)

        return np.asarray(self._of_root(solve, pressures)[self.bodies.numbers])

    def answer_to(self, heat: Array, states: Sequence[ContactState]) -> Array:
        """Rise of all nodes by heat alone, at conductances that are held; collective.

        Args:
            heat: That flows into all nodes of all ranks, (nodes,) (power).
            states: Of all contacts, whose pressures say what they conduct.

        Returns:
            Of all nodes of all ranks, (nodes,) (temperature).
        """

        def solve(condensed: CondensedHeat, *contacts: Any) -> Array:
            return condensed.solve_for(heat, *contacts)

        pressures = [state.contact_pressure for state in self.states_of(states)]
        return self._of_root(solve, pressures)

    def _of_root(self, solve: Callable[..., Array], pressures: Sequence[Array]) -> Array:
        """Solve for heat on the first rank, at given pressures, for all ranks; collective.

        Raises:
            FenicsContactError: On every rank, what it raises.
        """
        paired = [one.paired for one in self.contacts]
        weighted = [
            one.weighted(one.conductances(pressure))
            for one, pressure in zip(self.contacts, pressures, strict=True)
        ]
        whole: Array | None = None
        error: FenicsContactError | None = None
        if self._condensed is not None:
            try:
                whole = solve(self._condensed, paired, weighted)
            except FenicsContactError as caught:
                error = caught
        raise_together(self._comm, error)
        return np.asarray(from_root(self._comm, np.zeros(0) if whole is None else whole))

    @property
    def _whole(self) -> Array:
        """Rise of all nodes of all ranks, (nodes,); collective (temperature)."""
        return self._of_all_nodes(self.rise)

    def number_of(self, one: HeatOfContact) -> int:
        """The number among all contacts of one that conducts."""
        return self._numbers[self.contacts.index(one)]

    def _of_all_nodes(self, values: Array | Integers) -> Array:
        """Values of all nodes of all ranks by those of this rank's nodes; collective."""
        owned = slice(self._spaces.owned_nodes)
        rows = np.column_stack([self.bodies.numbers, values])[owned]
        numbers, found = gather_rows(self._comm, rows).T
        return np.asarray(found[np.argsort(numbers)])

    def steps(self) -> list[Array]:
        """Temperature opposite less the own one, at the points of each contact; collective.

        At this rank's points, 0 where no heat can cross (temperature).
        """
        return self.steps_of(self._whole)

    def steps_of(self, every: Array) -> list[Array]:
        """Temperature opposite less the own one, for given temperatures of all nodes.

        Args:
            every: Rise of all nodes of all ranks, (nodes,) (temperature).
        """
        found, mine = [], every[self.bodies.numbers]
        for one in self.contacts:
            pair, trace = one.paired, one.contact.trace
            own, whole = mine[trace.all_nodes], np.zeros(len(pair.active))
            whole[pair.active] = pair.opposite(every)
            there = whole[trace.surface.numbers]
            step = trace.at_points((there - own)[:, None])[:, 0]
            found.append(np.where(one.faces, step, 0.0))
        return found

    def flows(self, states: Sequence[ContactState]) -> dict[int, float]:
        """Heat into the body of ``on`` across each contact that conducts; collective (power).

        Args:
            states: Of all contacts, whose pressures say how much crosses.
        """
        found = {}
        for number, one, step in zip(self._numbers, self.contacts, self.steps(), strict=True):
            conductance = one.conductances(states[number].contact_pressure)
            into_slave = float(one.contact.trace.integral(conductance * step))
            found[number] = one.contact.sides.on_sign * into_slave
        return found

    def imbalance(self, states: Sequence[ContactState]) -> float | None:
        """Heat that a body takes in and does not give, over all heat; collective.

        Across contacts as their pressures say. The largest of all bodies; None without heat.

        Args:
            states: Of all contacts.
        """
        across = np.zeros(self.bodies.count)
        for heat in self.across(states).values():
            across += heat
        bodies, rise = self.bodies, self._whole
        fold = bodies.following.T
        left, across = fold @ (bodies.matrix @ rise - bodies.taken_in(self.time)), fold @ across
        given, _ = bodies.given_at(self.time)
        every = float(np.abs(left[given]).sum() + np.abs(bodies.taken_in(self.time)).sum())
        every += _NEGLIGIBLE * float((abs(bodies.matrix) @ np.abs(rise)).sum())
        if every == 0:
            return None
        left[given] = across[given] = 0.0
        sums = np.bincount(self._parts, left - across)
        return float(np.abs(sums).max() / every)

    def across(self, states: Sequence[ContactState]) -> dict[int, Array]:
        """Heat that crosses each contact that conducts, into both bodies; collective.

        Args:
            states: Of all contacts, whose pressures say how much crosses.

        Returns:
            By the contact's number, what flows into all nodes of all ranks, (nodes,) (power).
        """
        return self.over(states, self.steps())

    def by_unit_steps(self, states: Sequence[ContactState]) -> dict[int, Array]:
        """Heat that would cross each contact if its slave were colder by one degree everywhere.

        Collective.

        Args:
            states: Of all contacts, whose pressures say how much crosses.

        Returns:
            By the contact's number, what flows into all nodes of all ranks, (nodes,) (power).
        """
        return self.over(states, [one.faces.astype(float) for one in self.contacts])

    def over(self, states: Sequence[ContactState], steps: Sequence[Array]) -> dict[int, Array]:
        """Heat into all nodes by steps of temperature at the points; collective.

        Args:
            states: Of all contacts, whose pressures say how much crosses.
            steps: Of each contact that conducts, at this rank's points, (points,) (temperature).
        """
        found = {}
        for number, one, step in zip(self._numbers, self.contacts, steps, strict=True):
            pair, heat = one.paired, np.zeros(self.bodies.count)
            conducted = one.weighted(one.conductances(states[number].contact_pressure) * step)
            onto_slave = pair.points.T @ conducted
            np.add.at(heat, pair.slave, onto_slave)
            np.add.at(heat, pair.master, -pair.onto_master(onto_slave))
            found[number] = heat
        return found
