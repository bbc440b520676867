"""Load steps that were accepted, and snapshots of contacts after them to go back to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import STICK
from fenics_contact.problem.conduction.conduction import HeatMemory
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.solve.systems.system import System


@dataclass(frozen=True, eq=False)
class ContactMemory:
    """The state of a contact, displacements apart, when a load step has been solved.

    Attributes:
        indentation: Of its obstacle (length).
        dissipated: By friction, in the steps before (force × length).
        left_open: Work of pressures, where a gap was measured anew (force × length).
        regularisation_parameter: ε as chosen (length).
        is_scaled: Whether ε has been set.
        at_points: What its laws declare, and what happened at the end of the step before, by name:
            (points,) or (points, components).
        paired_at: Displacement at which two bodies were paired; None as meshed (length).
        dissipated_before: `dissipated` at the begin of each cycle of loads that began (force ×
            length).
        angle: By which its obstacle has turned (radian).
        shape_angle: At which the gap to this is measured (radian).
    """

    indentation: float
    dissipated: float
    left_open: float
    regularisation_parameter: float
    is_scaled: bool
    at_points: dict[str, Array]
    paired_at: Array | None
    dissipated_before: tuple[float, ...] = ()
    angle: float = 0.0
    shape_angle: float = 0.0


def remember(contact: ContactSurface) -> ContactMemory:
    """The present state of a contact."""
    kinematics, friction = contact.kinematics, contact.friction
    return ContactMemory(
        indentation=kinematics.indentation,
        dissipated=contact.last_step.dissipated,
        left_open=contact.last_step.left_open,
        regularisation_parameter=friction.regularisation.chosen,
        is_scaled=friction.regularisation.is_known,
        at_points=friction.kept()
        | {"bound": contact.friction_bound.copy()}
        | contact.last_step.at_points()
        | contact.normal.kept()
        | contact.wear.kept()
        | contact.kinematics.kept()
        | ({} if contact.found is None else contact.found.kept()),
        paired_at=kinematics.paired_at,
        dissipated_before=contact.last_step.dissipated_before,
        angle=kinematics.angle,
        shape_angle=kinematics.shape_angle,
    )


def recall_pairing(contact: ContactSurface, memory: ContactMemory) -> bool:
    """Pair two bodies as they were; whether they were paired otherwise; collective."""
    if contact.kinematics.paired_at is memory.paired_at:
        return False
    contact.update_pairing(memory.paired_at)
    return True


def recall(contact: ContactSurface, memory: ContactMemory) -> None:
    """Go back to a remembered state, bodies being paired as they were."""
    contact.kinematics.drive(memory.indentation)
    contact.kinematics.turn_back(memory.angle, memory.shape_angle)
    done = memory.dissipated, memory.left_open, memory.dissipated_before
    contact.last_step.restore(memory.at_points, *done)
    contact.normal.recall(memory.at_points)
    contact.friction.regularisation.recall(memory.regularisation_parameter, memory.is_scaled)
    contact.friction.recall(memory.at_points)
    contact.take_found(None if contact.found is None else contact.found.recalled(memory.at_points))
    contact.wear.recall(memory.at_points)
    contact.kinematics.recall(memory.at_points)
    contact.kinematics.overlap_by(contact.kinematics.interference, contact.wear.depth)
    contact.normal.set_gap(contact.kinematics.gap)


# Steps are extrapolated to at most so many times their length.
_FARTHEST = 2.0


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Unknowns from which Newton's method starts.

    Attributes:
        time: Pseudo-time.
        find_displacement: Gives that at the body's nodes of this rank, (nodes, components)
            (length); collective.
        scalars: Values of the scalar unknowns.
        find_mean_stress: Gives that of nearly incompressible bodies, at the dofs of this rank; else
            an empty array (stress); collective.
        position: Displacements as ``System.position`` gives them (length); None where another
            system found the state.
    """

    time: float
    find_displacement: Callable[[], Array]
    scalars: Array
    find_mean_stress: Callable[[], Array]
    position: Array | None = None

    @property
    def displacement(self) -> Array:
        """At the body's nodes of this rank, (nodes, components) (length); collective."""
        return self.find_displacement()

    @property
    def mean_stress(self) -> Array:
        """At the dofs of this rank; empty of bodies that have none (stress); collective."""
        return self.find_mean_stress()

    def position_in(self, system: System) -> Array:
        """Where a system begins at them; collective."""
        if self.position is None:
            return system.position_of(self.displacement)
        return self.position

    def towards(self, later: Unknowns, time: float) -> Unknowns:
        """On the straight line through these and later ones, at a still later time."""
        share = min((time - later.time) / (later.time - self.time), _FARTHEST)

        def extrapolated(first: Array, second: Array) -> Array:
            return second + share * (second - first)

        position = None
        if self.position is not None and later.position is not None:
            position = extrapolated(self.position, later.position)
        return Unknowns(
            time,
            lambda: extrapolated(self.displacement, later.displacement),
            extrapolated(self.scalars, later.scalars),
            lambda: extrapolated(self.mean_stress, later.mean_stress),
            position,
        )


@dataclass(frozen=True, eq=False)
class AcceptedStep:
    """A load step as it was solved.

    Attributes:
        unknowns: The state.
        contacts: That of the contacts.
        solution: What was found.
        before: The state of the step before; None for the first.
        heat: Temperatures, where these are found by conduction.
    """

    unknowns: Unknowns
    contacts: list[ContactMemory]
    solution: Solution
    before: Unknowns | None
    heat: HeatMemory | None = None

    @property
    def time(self) -> float:
        """Pseudo-time at the end of the load step."""
        return self.unknowns.time


@dataclass(frozen=True, eq=False)
class StepEnd:
    """Where a load step ended, for other answers that pass near by.

    Attributes:
        position: Displacements as ``System.position`` gives them (length).
        scalars: Values of the scalar unknowns.
        tangents: Of each contact's friction, what its tangent was at.
        scales: Of each contact, ε as chosen and whether it has been set.
    """

    position: Array
    scalars: Array
    tangents: list[tuple[Array, Array]]
    scales: list[tuple[float, bool]]

    @classmethod
    def of(cls, newton: Newton) -> StepEnd:
        """The present one; collective."""
        system, contacts = newton.system, newton.problem.contacts
        every = [contact.friction.regularisation for contact in contacts]
        return cls(
            system.position(),
            system.scalar_values(system.state),
            [contact.friction_term.tangent_state.slip_and_direction for contact in contacts],
            [(regularisation.chosen, regularisation.is_known) for regularisation in every],
        )

    def begin(self, newton: Newton, before: StepEnd | None) -> None:
        """Begin a load step as far from this end as the last one ended from its own; collective.

        Args:
            newton: At the beginning of the load step.
            before: Near which the last load step ended; None of the first one.
        """
        system = newton.system
        position, scalars = self.position, self.scalars
        if before is not None:
            position = position + (system.position() - before.position)
            scalars = scalars + (system.scalar_values(system.state) - before.scalars)
        rows = zip(newton.problem.contacts, self.tangents, self.scales, strict=True)
        for contact, tangent, scale in rows:
            contact.friction.regularisation.recall(*scale)
            if len(tangent[0]) == len(contact.friction.reference):  # else it was paired otherwise
                contact.friction_term.tangent_state.take(tangent)
        newton.begin.at(position, scalars)


def contact_change(problem: Problem, before: AcceptedStep | None, found: Solution) -> float:
    """Area that opened, closed, or began or ceased to stick, over that in contact; collective."""
    if before is None:
        return 0.0
    touching = np.zeros(2)
    changed = sticking = 0.0
    states = zip(problem.contacts, before.solution.states, found.states, strict=True)
    for contact, old, new in states:
        closed = [state.contact_pressure > 0 for state in (old, new)]
        sticks = [state.status == STICK for state in (old, new)]
        rows = np.stack([*closed, closed[0] != closed[1], sticks[0] != sticks[1]], axis=1)
        *areas, opened, slipped = contact.trace.integral(rows.astype(np.float64))
        touching += areas
        changed, sticking = changed + opened, sticking + slipped
    if touching.min() == 0:  # the first touch, or the last: no step makes it small
        return 0.0
    return float(max(changed, sticking) / touching.max())


class StepListener:
    """Listener of accepted load steps; a subclass overrides the events that it needs.

    What happens after the last step follows the call of ``LoadSteps.solve``: the system is still
    there then, and no listener is needed for it.
    """

    def accepted(self, step: AcceptedStep) -> None:
        """A load step is accepted, in whose state the problem still is; collective.

        Args:
            step: The load step. Friction does not yet count its slip from there.
        """

    def completed(self) -> None:
        """The last load step is done with, and the next one's size known; collective.

        Another run can go on from here.
        """


@dataclass(frozen=True, eq=False)
class AtEachStep(StepListener):
    """Calls a function at each load step that is accepted.

    Attributes:
        call: Gets the pseudo-time and the solution; collective.
    """

    call: Callable[[float, Solution], None]

    def accepted(self, step: AcceptedStep) -> None:
        """Call the function; collective."""
        self.call(step.time, step.solution)


@dataclass(frozen=True, eq=False)
class AuxiliaryState:
    """State that is kept besides the last load step, such as where a motion's step began.

    Attributes:
        said: What is no array, as JSON has it.
        at_points: Of each contact, by name: values at its points, (points,); none of none.
        nodal: By name: values at the body's nodes of this rank, (nodes, components).
    """

    said: dict[str, Any] = field(default_factory=dict)
    at_points: list[dict[str, Array]] = field(default_factory=list)
    nodal: dict[str, Array] = field(default_factory=dict)

    def values(self, name: str) -> list[Array]:
        """The values of a name at the points of all contacts."""
        return [one[name] for one in self.at_points]

    def of_contact(self, number: int) -> dict[str, Array]:
        """The values at the points of a contact."""
        return self.at_points[number] if self.at_points else {}
