"""Rigid motions that nothing resists in an answer, so that it is one of many.

A part that nothing touches floats in its clearance. One that slips wherever it touches, to both
sides, may go on: friction at its bound is the same however far a point slips. One that touches in
a single line may roll. Equilibrium then tells forces, but not where the part is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import carries_more_than
from fenics_contact.contact.state import SLIP, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions, reduced

# Resistance to a motion over the largest, by squares, below which the accepted imbalance moves a
# part by more than a tenth of its slip.
_RESISTED = 1e-5
# Of the pressure of a contact: what touches, and does not hold anything.
_PRESSED = 1e-6


@dataclass(frozen=True)
class Undetermined:
    """Motions of an answer that nothing resists.

    Attributes:
        floating: Names of parts that nothing touches, and no support holds.
        moving: Names of the other parts that can move.
        motion: One of the motions of these, in words.
    """

    floating: tuple[str, ...]
    moving: tuple[str, ...]
    motion: str

    @property
    def words(self) -> str:
        """Sentences, each with a space before it; nothing where all is determined."""
        found = ""
        if self.floating:
            found += (
                f" Nothing touches {_listed(self.floating)}, and no support holds it: where it is "
                "does not matter for the others, and is one place of many; hold it by a support, "
                "or by a load that presses it on."
            )
        if self.moving:
            found += (
                f" {_listed(self.moving)} can still move without a force ({self.motion}): what "
                "touches it slips at its bound, or lets it roll. So displacements and slips there "
                "are those of one answer of many; a support would tell which."
            )
        return found


def _listed(names: Sequence[str]) -> str:
    return " and ".join(f"'{name}'" for name in names)


def undetermined(
    problem: Problem, states: Sequence[ContactState], imbalance: float
) -> Undetermined | None:
    """Motions of an answer at rest that nothing resists to first order; collective.

    Args:
        problem: The model, in the state of the answer.
        states: What happens at the points of each contact.
        imbalance: That was accepted (force).

    Returns:
        None where each part is held.
    """
    rigid = RigidMotions(problem)
    if rigid.count == 0 or problem.inertia.moves:
        return None
    resisted = np.zeros((rigid.count, rigid.count))
    for contact, state in zip(problem.contacts, states, strict=True):
        if not contact.normal.sticks and carries_more_than(contact, imbalance):
            least = _PRESSED * largest(problem.comm, np.abs(state.contact_pressure))
            resisted += _resistance(contact, state, rigid.jumps(contact), least)
    resisted = np.asarray(total(problem.comm, resisted))
    values, vectors = np.linalg.eigh(resisted)
    free = vectors[:, values <= _RESISTED * max(values.max(), np.finfo(float).tiny)]
    if free.shape[1] == 0:
        return None
    return _named(rigid, resisted, reduced(free))


def _resistance(contact: ContactSurface, state: ContactState, jumps: Array, least: float) -> Array:
    """Squares of jumps that a contact resists, over its area, (motions, motions); of this rank.

    Args:
        contact: The contact.
        state: What happens at its points.
        jumps: Of the motions there, (points, components, motions).
        least: Pressure that is round-off (stress).
    """
    normals, slips = contact.trace.normals, state.status == SLIP
    acts = contact.trace.owned & (np.abs(state.contact_pressure) > least)
    bound = contact.bound_at(state.contact_pressure)
    rubs = contact.trace.owned & (bound > 0) & (acts | (not contact.is_one_sided))
    across = np.einsum("qci,qc->qi", jumps, normals)
    along = jumps - normals[:, :, None] * across[:, None, :]
    direction = np.where(slips[:, None], state.friction_traction, 0.0)
    size = np.linalg.norm(direction, axis=1, keepdims=True)
    direction = direction / np.where(size > 0, size, 1.0)
    along -= direction[:, :, None] * np.einsum("qci,qc->qi", along, direction)[:, None, :]
    weights = contact.trace.weights
    found = np.einsum("q,qi,qj->ij", weights[acts], across[acts], across[acts])
    held = np.einsum("q,qci,qcj->ij", weights[rubs], along[rubs], along[rubs])
    return np.asarray(found + held)


def untouched_parts(problem: Problem) -> list[str]:
    """Names of parts that no contact presses on at present, and no support holds; collective.

    Args:
        problem: The model, in any state.
    """
    rigid = RigidMotions(problem)
    pressed = np.zeros((rigid.count, rigid.count))
    if rigid.count == 0:
        return []
    for contact in problem.contacts:
        acts = contact.trace.owned & (contact.pressure() != 0)
        if contact.normal.sticks:  # what is glued moves as one
            acts = contact.trace.owned
        jumps = rigid.jumps(contact)[acts]
        pressed += np.einsum("q,qci,qcj->ij", contact.trace.weights[acts], jumps, jumps)
    return _floating(rigid, np.asarray(total(problem.comm, pressed)))


def _floating(rigid: RigidMotions, resisted: Array) -> list[str]:
    """Names of parts none of whose motions anything resists."""
    nothing, parts = _RESISTED * np.trace(resisted), rigid.parts
    found = []
    for number, name in enumerate(parts.names):
        alone = rigid.alone(np.arange(parts.count) == number)
        if alone.shape[1] and np.trace(alone.T @ resisted @ alone) <= nothing:
            found.append(name)
    return found


def _named(rigid: RigidMotions, resisted: Array, free: Array) -> Undetermined:
    """Parts that move in free motions, by whether anything resists them at all."""
    floating = _floating(rigid, resisted)
    moving: list[str] = []
    motion = ""
    for each in free.T:
        names = [name for name in rigid.parts_moved(each) if name not in floating]
        motion = motion or (rigid.describe(each) if names else "")
        moving += [name for name in names if name not in moving]
    return Undetermined(tuple(floating), tuple(moving), motion)
