"""How much of what friction can hold contacts and parts use, in an answer (``rigid_slip``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.existence.rigid_slip import RigidSlip, allowance
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Share of a motion from which a part of it is named.
_TAKES_PART = 0.05
#: Less than all of what friction can hold: what answers of bodies that are held have at the most.
HELD = 1 - 1e-6


@dataclass(frozen=True)
class SlipLimit:
    """The motion against which friction is used up most.

    Attributes:
        share: Of what friction can hold against it, that it does hold.
        motion: In words.
        parts: Names of the parts that move.
        kind: ``moment`` or ``force``, whichever drives it; empty where parts move differently.
        applied: That of the loads, by ``kind``; without one their work (force, force × length).
        most: The most that friction can hold, likewise.
    """

    share: float
    motion: str
    parts: tuple[str, ...]
    kind: str
    applied: float
    most: float

    @property
    def words(self) -> str:
        """Sentence that parts slip as one, without a full stop."""
        who = " and ".join(f"'{name}'" for name in self.parts) or "an obstacle"
        most, asked = f"a {self.kind} of {self.most:.4g}", f"{self.applied:.4g}"
        if not self.kind:
            most, asked = "what it can", f"{self.applied / self.most:.4g} times as much"
        return (
            f"{who} slips as a whole ({self.motion}): no support holds it so, friction can hold "
            f"{most} at the most, and the loads ask for {asked}"
        )


def share_of_contact(contact: ContactSurface, state: ContactState) -> float | None:
    """Share of its friction that a contact uses against rigid slip of one side; collective.

    Where it meets planes of symmetry, against slip that is symmetric to them.

    Args:
        contact: The contact.
        state: What happens at its points.

    Returns:
        0 … 1; None without friction, and where no rigid motion slips along all that is closed.
    """
    if not contact.friction.has_friction:
        return None
    jumps = _relative_motions(contact, state.status != OPEN)
    share, _ = _rigid_slip([contact], [state], [jumps]).share()
    return None if share is None else min(share, 1.0)


class SlipShares:
    """Shares of all contacts together, against motions left free by supports and glue; collective.

    Args:
        problem: The model, in the state of the answer.
        states: What happens at the points of each contact.
    """

    def __init__(self, problem: Problem, states: Sequence[ContactState]) -> None:
        self._problem, self._rigid = problem, RigidMotions(problem)
        acting = zip(problem.contacts, states, strict=True)
        self._acting = [(one, state) for one, state in acting if not one.normal.sticks]

    def of_parts(self) -> dict[str, float | None]:
        """Share of each part that friction may hold, by all its contacts, the others at rest.

        Parts that are glued to each other move together.
        """
        glued, found = self._glued_parts(), {}
        for number, name in enumerate(self._problem.spaces.parts.names):
            slip = self._slip(self._rigid.alone(glued[number]))
            share = None if slip is None else slip.share()[0]
            found[name] = None if share is None else min(share, 1.0)
        return found

    def largest(self) -> SlipLimit | None:
        """Largest share over all free motions of one part or several; None where none rubs."""
        return self._limit(self._slip(np.eye(self._rigid.count)))

    def asked_by_loads(self) -> SlipLimit | None:
        """Largest share of friction that the present loads ask for: 1 and more is not held.

        By the pressures of the answer, which the loads may change.
        """
        slip = self._slip(np.eye(self._rigid.count))
        return self._limit(None if slip is None else replace(slip, work=self._rigid.force))

    def factor(self, varying: Array, present: float) -> float | None:
        """Factor of varying loads at which parts slip as one, by the pressures found; collective.

        Args:
            varying: Their nodal forces for a factor of 1, (nodes, components) (force).
            present: The factor with which the answer was found.

        Returns:
            None where they push nothing that friction holds.
        """
        slip = self._slip(np.eye(self._rigid.count))
        return None if slip is None else slip.factor(self._rigid.work_of(varying), present)

    def _limit(self, slip: RigidSlip | None) -> SlipLimit | None:
        """Limit by the motion of the largest share, among all that are free."""
        share, motion = (None, np.zeros(0)) if slip is None else slip.share()
        if slip is None or share is None:
            return None
        rigid = self._rigid
        applied = abs(float(rigid.force @ motion))
        most = float(slip.bounds @ np.linalg.norm(slip.slips @ motion, axis=1))
        motion = np.where(np.abs(motion) > _TAKES_PART * np.abs(motion).max(), motion, 0.0)
        kind, speed = rigid.kind_of(motion)
        return SlipLimit(
            share=share,
            motion=rigid.describe(motion),
            parts=tuple(rigid.parts_moved(motion)),
            kind=kind,
            applied=applied / speed,
            most=most / speed,
        )

    def _slip(self, among: Array) -> RigidSlip | None:
        """Slips of some combinations of the free motions, as columns; None of none."""
        if among.shape[1] == 0 or not self._acting:
            return None
        contacts, states = [one for one, _ in self._acting], [state for _, state in self._acting]
        jumps = [self._rigid.jumps(contact) @ among for contact in contacts]
        return _rigid_slip(contacts, states, jumps)

    def _glued_parts(self) -> Flags:
        """Whether parts are glued to each other, and each to itself, (parts, parts)."""
        problem, parts = self._problem, self._problem.spaces.parts
        together = np.eye(parts.count, dtype=bool)
        for contact in problem.contacts:
            if not contact.normal.sticks:
                continue
            nodes = contact.kinematics.reaches(np.ones(len(contact.trace.all_nodes), dtype=bool))
            here = np.bincount(parts.of_node[nodes], minlength=parts.count)
            touched = total(problem.comm, here) > 0
            together |= np.outer(touched, touched)
        return np.linalg.matrix_power(together.astype(np.int64), parts.count) > 0


def slip_shares(problem: Problem, states: Sequence[ContactState]) -> SlipShares | None:
    """Slip shares of an answer; None where no contact has friction; collective."""
    rubs = any(contact.friction.has_friction for contact in problem.contacts)
    return SlipShares(problem, states) if rubs else None


def _relative_motions(contact: ContactSurface, closed: Flags) -> Array:
    """Rigid motions of one side alone, at the points, (points, components, motions); collective."""
    trace, spaces = contact.trace, contact.spaces
    counted = closed & trace.owned
    places, comm = np.zeros((len(closed), 3)), spaces.comm
    size = spaces.components
    places[:, :size] = trace.coordinates[:, :size]
    rows = np.hstack([places, np.ones((len(places), 1))])[counted]
    *centre, count = total(comm, rows.sum(axis=0))
    arms = places - np.array(centre) / max(count, 1)
    arms /= np.sqrt(total(comm, (arms[counted] ** 2).sum()) / max(count, 1)) or 1.0
    mirrored = {axis for axis, _ in trace.symmetry.planes()}
    axes = range(size)
    spins = [axis for axis in ((2,) if size == 2 else (0, 1, 2)) if mirrored <= {axis}]
    if spaces.kinematics == "axisymmetric":
        axes, spins = range(1, 2), []
    found = [np.broadcast_to(np.eye(3)[k], places.shape) for k in axes if k not in mirrored]
    found += [np.cross(np.eye(3)[k], arms) for k in spins]
    if not found:
        return np.zeros((len(places), size, 0))
    return np.stack(found, axis=-1)[:, :size]


def _rigid_slip(
    contacts: Sequence[ContactSurface], states: Sequence[ContactState], jumps: Sequence[Array]
) -> RigidSlip:
    """Slips of motions at the closed points of some contacts; collective.

    Args:
        contacts: At least one, all of one problem.
        states: What happens at the points of each.
        jumps: Of the motions there, (points, components, motions).
    """
    spaces, motions = contacts[0].spaces, jumps[0].shape[2]
    across, allowed = np.zeros((2, motions, motions))
    work, rows = np.zeros(motions), [np.zeros((0, 1 + spaces.components * motions))]
    for contact, state, jump in zip(contacts, states, jumps, strict=True):
        closed = contact.trace.owned & (state.status != OPEN)
        weights, normals = contact.trace.weights[closed], contact.trace.normals[closed]
        normal = np.einsum("qci,qc->qi", jump[closed], normals)
        slips = jump[closed] - normals[:, :, None] * normal[:, None, :]
        if contact.is_one_sided:
            across += np.einsum("q,qi,qj->ij", weights, normal, normal)
        part = np.einsum("q,qci,qcj->ij", weights, slips, slips)
        allowed += allowance(contact.kinematics.facet_turn) ** 2 * part
        if contact.friction.has_friction:
            work_here, held = _friction_of(contact, state, jump)
            work += work_here
            rows.append(held)
    table = gather_rows(spaces.comm, np.concatenate(rows))
    across, allowed = total(spaces.comm, np.stack([across, allowed]))
    return RigidSlip(
        across=across,
        allowed=allowed,
        work=np.asarray(total(spaces.comm, work)),
        bounds=table[:, 0],
        slips=table[:, 1:].reshape(len(table), spaces.components, motions),
    )


def _friction_of(contact: ContactSurface, state: ContactState, jump: Array) -> tuple[Array, Array]:
    """Work of the friction found on motions, and what friction can hold, on this rank.

    A bound that is averaged over a neighbourhood also holds points that do not touch.

    Args:
        contact: The contact, with friction.
        state: What happens at its points.
        jump: Of the motions there, (points, components, motions).

    Returns:
        The work, (motions,), and rows of the bound and the slips as friction feels them.
    """
    bound = contact.bound_at(state.contact_pressure)
    held = contact.trace.owned & ((state.status != OPEN) | (bound > 0))
    weights, normals = contact.trace.weights, contact.trace.normals
    slips = jump - normals[:, :, None] * np.einsum("qci,qc->qi", jump, normals)[:, None, :]
    traction = state.friction_traction[held]
    work = -np.einsum("q,qc,qci->i", weights[held], traction, slips[held])
    felt = contact.friction.rule.metric.at_each(slips)[held]
    rows = (weights * bound)[held], felt.reshape(len(felt), np.prod(jump.shape[1:], dtype=int))
    return work, np.column_stack(rows)
