"""Work and energies along the load steps, and whether they balance.

The work of every force is counted by the trapezoidal rule. The bulk is linear, so what loads,
supports and contacts together do to it is its change of strain energy exactly: a defect is what
contacts made of the path within their steps, or a wrong answer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    DAMPING_WORK,
    ELASTIC_SLIP_ENERGY,
    ENERGY_DEFECT,
    EXTERNAL_WORK,
    FRICTION_WORK,
    KINETIC_ENERGY,
    PENALTY_ENERGY,
    SPRING_ENERGY,
    STRAIN_ENERGY,
)
from fenics_contact.results.records.steps import LoadRecord
from fenics_contact.results.result import Check
from fenics_contact.solve.systems.solution import Solution


def load_records(problem: Problem, displacement: Array) -> list[LoadRecord]:
    """Each load of a scene at present; collective.

    Args:
        problem: In the state of the load step.
        displacement: There, at the nodes of this rank, (nodes, components) (length).
    """
    own = slice(problem.spaces.owned_nodes)
    found = []
    for name, nodal, factor in problem.acting_loads:
        size = np.linalg.norm(nodal[own], axis=1).sum()
        work = np.sum(nodal[own] * displacement[own])
        every, done = total(problem.comm, np.array([size, work]))
        found.append(
            LoadRecord(name=name, force=float(factor * every), displacement=float(done / every))
        )
    return found


# Round-off of sums; and of energies, over that of a scalar in a body that is held everywhere.
_ROUND_OFF, _OF_ENERGIES = 1e-9, 1e-14
# Of the work done: what a contact may do to the balance besides what is known to be left open.
_SHARE = 0.02

_OF_OBSTACLES = ("pressures", "frictions", "motions")
_SUMS = ("work", "done", "round_off", "left_open", "changed")
_STORED = (STRAIN_ENERGY, SPRING_ENERGY, PENALTY_ENERGY, ELASTIC_SLIP_ENERGY, KINETIC_ENERGY)
_LOST = (FRICTION_WORK, DAMPING_WORK)


@dataclass(frozen=True)
class _Mark:
    """Sums since the start, and what is stored, at the end of a cycle (all energies).

    Attributes:
        work: External work.
        done: The same without regard to signs.
        unsure: What round-off and changes of contact leave open.
        stored: In the body and in contacts.
        lost: By friction.
    """

    work: float
    done: float
    unsure: float
    stored: float
    lost: float


class EnergyBalance:
    """External work, summed over the load steps that were accepted.

    Attributes:
        work: External work so far (energy).
        done: The same without regard to signs: of loads, supports, obstacles and scalars in every
            step (energy).
        round_off: What the accepted imbalance may leave of the balance (energy).
        left_open: What the steps leave open of the work, where points began to touch, to slip,
            to stick or to slip back within one (energy).
        changed: Whether any contact point's status changed since the start.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self.work, self.done, self.round_off = 0.0, 0.0, 0.0
        self.left_open = 0.0
        self.changed = False
        self._cycle: tuple[_Mark | None, _Mark | None] = None, None  # its begin and its end
        self._stress = np.zeros(0)  # the mean stress of the last step, where it is an unknown
        inertia = problem.inertia
        first, motions = inertia.first, _with_turns(inertia.motions)
        self._before: InternalForces | None = None
        self._last: dict[str, Array] = {
            "pressures": _with_turns(first.pressures),
            "frictions": np.zeros_like(motions),
            "motions": motions,
            "scalars": np.array(
                first.scalars or [(0.0, one.at_begin) for one in problem.body_scalars]
            ).reshape(-1, 2),
        }
        self._on_scalars = [one.forces_on_body for one in problem.body_scalars]
        self._overlaps: list[Array | float] = list(first.overlaps)
        self._first = inertia.energy

    def count(self, forces: InternalForces) -> None:
        """Count a step that was accepted, before slip is counted from it; collective."""
        problem, solution = self._problem, forces.solution
        last, before = self._last, self._before
        moved = forces.displacement - self._place_before(before)
        done = list(forces.works_since(before))
        motions = last["motions"].copy()
        done += [self._work_of_obstacle(i, solution) for i in range(len(problem.contacts))]
        motions = last["motions"] - motions
        done += self._works_on_scalars(solution)
        done += self._works_of_temperatures(forces)
        self.work += float(sum(done))
        self.done += float(np.abs(done).sum())
        farthest = largest(problem.comm, np.abs(moved[: problem.spaces.owned_nodes]))
        self.round_off += solution.imbalance_limit * farthest + self._of_scalars(solution)
        self.left_open += forces.left_open
        pairs = zip(problem.contacts, solution.states, strict=True)
        for (contact, state), motion in zip(pairs, motions, strict=True):
            self.left_open += contact.work.left_open(state)
            self.left_open += _work_at_edges(contact, state, moved, motion)
            changed = contact.last_step.changed(state) & contact.trace.owned
            self.changed |= total(problem.comm, changed.sum()) > 0
            self.changed |= contact.last_step.left_open > 0
        self._before = forces

    def _place_before(self, before: InternalForces | None) -> Array | float:
        """Where nodes were at the end of the step before, (nodes, components) (length)."""
        if before is not None:
            return before.displacement
        return self._problem.inertia.displacement

    def _work_of_obstacle(self, number: int, solution: Solution) -> float:
        """In a step, of what stands opposite; it becomes the last step's; collective."""
        contact = self._problem.contacts[number]
        kinematics, state, before = contact.kinematics, solution.states[number], contact.last_step
        every = solution.normal_force[number], solution.friction_force[number]
        own = np.stack([kinematics.wrench(force) for force in every])
        pressed, rubbed = total(contact.spaces.comm, own)
        motion = kinematics.motion
        pressures, frictions, motions = (self._last[name] for name in _OF_OBSTACLES)
        if before.acts_all_along:
            frictions[number] = rubbed
        mean = 0.5 * (pressures[number] + pressed + frictions[number] + rubbed)
        work = float(mean @ (motion - motions[number]))
        pressures[number], frictions[number], motions[number] = pressed, rubbed, motion
        overlap = kinematics.interference - kinematics.worn
        pushed_in = overlap - self._overlaps[number]
        self._overlaps[number] = overlap
        if kinematics.paired_at is None:
            # A curved obstacle that moves along the surface pushes the gap before it; and what
            # overlaps as drawn pushes the overlap out in the first step.
            stays = np.isfinite(before.gap) & np.isfinite(kinematics.gap)
            pushed_in[stays] = before.gap[stays] - kinematics.present_gap[stays]
        pressure = 0.5 * (before.state.contact_pressure + state.contact_pressure)
        return work + float(contact.trace.integral(pressure * pushed_in))

    def _works_on_scalars(self, solution: Solution) -> list[float]:
        """∫ N dq of each of the body's scalars in a step; it becomes the last step's."""
        last = self._last["scalars"]
        rows = [(state.force if state.works else 0.0, state.value) for state in solution.scalars]
        now = np.array(rows).reshape(-1, 2)
        self._last["scalars"] = now
        works = 0.5 * (last[:, 0] + now[:, 0]) * (now[:, 1] - last[:, 1])
        return [float(work) for work in works]

    def _of_scalars(self, solution: Solution) -> float:
        """What round-off leaves of the works on scalars: a free body's are 0 that expands."""
        pairs = zip(self._problem.body_scalars, solution.scalars, strict=True)
        energies = (one.forces_on_body.stiffness * state.value**2 for one, state in pairs)
        return _OF_ENERGIES * sum(map(abs, energies))

    def _works_of_temperatures(self, forces: InternalForces) -> list[float]:
        """−∫ σ : dε of strains free of stress that temperatures have changed in a step; collective.

        By the trapezoidal rule, with what a unit of a scalar does to the body before and after:
        its forces c and stiffness D, ½ q (c' − c) · (u + u') + ½ q² (D' − D); with a mean stress s
        as an unknown, and what a unit does to it, ½ q (m' − m) · (s + s') besides.
        """
        if self._problem.elastic.follows_temperature:
            return [self._energy_of_moduli(forces)]
        if not self._on_scalars:
            return []
        before, last = self._place_before(self._before), self._on_scalars
        now = [one.forces_on_body for one in self._problem.body_scalars]
        self._on_scalars = now
        own, works, stress = slice(self._problem.spaces.owned_nodes), list[float](), self._stress
        self._stress = forces.solution.mean_stress
        squeezed = self._stress + (stress if len(stress) else 0.0)
        for old, new, state in zip(last, now, forces.solution.scalars, strict=True):
            if old is new:
                continue
            moved = np.asarray(before + forces.displacement)[own]
            there = slice(new.owned_stresses)
            by_stress = (new.on_mean_stress - old.on_mean_stress)[there] @ squeezed[there]
            by_forces = np.sum((new.nodal - old.nodal)[own] * moved)
            done = float(total(self._problem.comm, float(by_forces + by_stress)))
            stored = state.value * (new.stiffness - old.stiffness)
            works.append(0.5 * state.value * (done + stored))
        return works

    def _energy_of_moduli(self, forces: InternalForces) -> float:
        """Change of the elastic energy by moduli and temperatures that change; collective.

        It is ½ (F' · y − F · y') for displacements and scalars y with the forces F = K y. With the
        work of loads by the trapezoidal rule it adds up to the change of ½ y · F.
        """
        before = self._before
        if before is None:
            values = [
                state.force * one.at_begin
                for state, one in zip(
                    forces.solution.scalars, self._problem.body_scalars, strict=True
                )
            ]
            return 0.5 * float(sum(values))
        one, other = (
            self._work(two[0].solution, two[1].solution)
            for two in ((forces, before), (before, forces))
        )
        return 0.5 * (one - other)

    def _work(self, acting: Solution, moved: Solution) -> float:
        """Work of the body's forces in a solution on another one's displacements; collective."""
        own = slice(self._problem.spaces.owned_nodes)
        nodal = np.sum(acting.internal_force[own] * moved.displacement[own])
        pairs = zip(acting.scalars, moved.scalars, strict=True)
        by_scalars = sum(one.force * other.value for one, other in pairs if one.works)
        return float(total(self._problem.comm, float(nodal))) + by_scalars

    @property
    def sums(self) -> list[float]:
        """Sums so far, to be given to ``resume``."""
        return [float(getattr(self, name)) for name in _SUMS]

    def resume(self, sums: Sequence[float], forces: InternalForces) -> None:
        """Go on from the last load step of another run; collective."""
        self.count(forces)  # for the last forces and motions
        for name, value in zip(_SUMS, sums, strict=True):
            setattr(self, name, type(getattr(self, name))(value))

    @property
    def applies(self) -> bool:
        """Whether there is a path to count along: the static law of friction has none."""
        static = any(not contact.friction.follows_path for contact in self._problem.frictional)
        return self._problem.scene.load_steps.several and not static

    @property
    def open_share(self) -> float:
        """``left_open``, in steps and between them, over the work done; 0 without a path."""
        size = self._size
        judged = self.applies and self._problem.elastic.is_linear
        return self._open / size if judged and size > 0 else 0.0

    @property
    def _open(self) -> float:
        """``left_open``, in steps and between them (energy)."""
        between = sum(contact.last_step.left_open for contact in self._problem.contacts)
        return self.left_open + between

    @property
    def _size(self) -> float:
        """Energy that is brought in altogether: by work, and at the start (energy)."""
        return self.done + self._first

    def quantities(self, quantities: Mapping[str, Any]) -> dict[str, float]:
        """``external_work`` along the steps, and the ``energy_defect`` that it leaves.

        Args:
            quantities: The other ones at the end of the step that was counted last.
        """
        if not self._problem.scene.load_steps.several:
            return {}  # of a single step, the work of the final forces is given
        defect = self._first + self.work - _sum(quantities, (*_STORED, *_LOST))
        balance = {ENERGY_DEFECT: defect} if self.applies else {}
        return {EXTERNAL_WORK: self.work, **balance}

    def check(self, quantities: Mapping[str, Any]) -> Check | None:
        """|defect| over the work done; None without a path, and in finite strains.

        There the trapezoidal rule takes forces to be straight lines between load steps.
        """
        size = self._size
        if not self.applies or size == 0 or not self._problem.elastic.is_linear:
            return None
        open_share = min(self.open_share, self._problem.inertia.most_open)
        limit = _ROUND_OFF + self.round_off / size + open_share
        if self.changed:
            limit += _SHARE
        return Check(abs(quantities[ENERGY_DEFECT]) / size, limit)

    def end_cycle(self, quantities: Mapping[str, Any]) -> None:
        """Remember where a cycle of loads ends.

        Args:
            quantities: Of its last load step.
        """
        end = _Mark(
            work=self.work,
            done=self.done,
            unsure=_ROUND_OFF * self.done + self.round_off + self._open,
            stored=_sum(quantities, _STORED),
            lost=_sum(quantities, _LOST),
        )
        self._cycle = self._cycle[1], end

    def check_cycle(self) -> Check | None:
        """|∮ dW − D| of the last cycle over the work done in it; None without a path, or a begin.

        Where the loop is closed, what drives put in is what friction takes. Of what is still stored
        at its end, and was not at its begin, ``energy_balance`` judges. A loss is judged by its own
        size: beside a large static load the other check would not see it.
        """
        begin, end = self._cycle
        if begin is None or end is None or not self.applies or end.done == begin.done:
            return None
        size, lost = end.done - begin.done, end.lost - begin.lost
        unsure = end.unsure - begin.unsure + abs(end.stored - begin.stored)
        if self.changed:
            unsure += _SHARE * abs(lost)
        return Check(abs(end.work - begin.work - lost) / size, unsure / size)


def _sum(quantities: Mapping[str, Any], names: Sequence[str]) -> float:
    """Sum of the quantities of some names that there are."""
    return sum(float(quantities.get(name, 0.0)) for name in names)


def _with_turns(motions: Array) -> Array:
    """Of each contact a motion, or a force, with an angle, or a moment, of 0 behind it."""
    return np.column_stack([motions, np.zeros(len(motions))])


def _work_at_edges(
    contact: ContactSurface, state: ContactState, moved: Array, motion: Array
) -> float:
    """Work of pressures at points that an obstacle's edge passed in a step; collective.

    There they vanish, or are there, at once: ½ p Δw_n is the trapezoidal rule's, and nobody's.
    Beyond the edge of another body only the slave's part of Δw_n is known: by both moduli, the
    other springs back as well.

    Args:
        contact: As the last step left it.
        state: At the end of this one.
        moved: At the body's nodes of this rank in the step, (nodes, components) (length).
        motion: Of the obstacle, (components + 1,) (length, radian).
    """
    kinematics, last = contact.kinematics, contact.last_step.state
    passed = np.isfinite(contact.last_step.gap) != np.isfinite(kinematics.gap)
    if total(contact.spaces.comm, passed.sum()) == 0:
        return 0.0
    jump = contact.trace.at_points(kinematics.relative_or_own(moved)) - kinematics.field(motion)
    pressure = 0.5 * (last.contact_pressure + state.contact_pressure)
    both = contact.moduli.reference / contact.moduli.combined
    across = both * pressure * np.abs(kinematics.normal(jump))
    return float(contact.trace.integral(np.where(passed, across, 0.0)))
