"""Where Newton's method starts: bodies and obstacles that only contact holds, just in contact.

Out of contact the first tangent would be singular. So the free motions are found first, with
the body rigid and the obstacles on soft springs: a convex problem in a handful of unknowns.
"""

from __future__ import annotations

import logging

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_root, largest, of_every_rank
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions, null_space
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.solve.systems.system import System

# The springs are first as soft as the body over the whole surface, then over the patch found.
_ROUNDS = 3


def starting_point(problem: Problem) -> Array:
    """Displacements from which the contacts act; obstacles are taken to theirs; collective.

    Returns:
        Nodal displacements of this rank, (nodes, components) (length).
    """
    displacement = np.zeros_like(problem.load)
    rigid = RigidMotions(problem)
    if rigid.count == 0:
        return displacement
    weights, closing, gap = rigid.closings()
    loose = _unresisted(problem, rigid, closing)
    if len(weights) == 0 or loose.shape[1] == 0:
        return displacement
    size = max(contact.trace.extent() for contact in problem.contacts)
    motion = np.zeros(loose.shape[1])
    rows, force = closing @ loose, rigid.force @ loose
    length = size
    for _ in range(_ROUNDS):
        stiffness = weights * problem.elastic.reference_modulus / length
        motion = _on_springs(stiffness, rows, gap, force, motion, size)
        patch = float(weights[rows @ motion > gap].sum())
        plane = problem.spaces.kinematics in ("plane strain", "plane stress")
        length = min(max(patch if plane else np.sqrt(patch), 1e-6 * size), size)
    motion = from_root(problem.comm, motion)
    for one, moved in zip(rigid.floating, rigid.of_floating(loose @ motion), strict=True):
        one.take(one.start + float(moved))
    return rigid.displacement(loose @ motion)


def _unresisted(problem: Problem, rigid: RigidMotions, closing: Array) -> Array:
    """Combinations of the motions that friction does not resist, as columns.

    What does not touch yet does not rub; of the motions that would be free then, only those that
    close a gap are taken. On a curved surface every motion rubs a little: those of Coulomb's
    friction are free that close, where things touch, more than they rub.
    """
    held = _gram(problem, *rigid.slips())
    free = null_space(held)
    rubbing = free.T @ _gram(problem, *rigid.slips(coulomb=True, touching=True)) @ free
    pressing = free.T @ _gram(problem, *rigid.touching_closings()) @ free
    rows = closing @ free
    anywhere = rows.T @ rows
    scale = np.trace(rubbing + pressing) / (np.trace(anywhere) or 1.0)
    loose = free @ _mostly_pressing(rubbing, pressing + 1e-6 * (scale or 1.0) * anywhere)
    rows = closing @ loose
    values, vectors = np.linalg.eigh(rows.T @ rows)
    closes = values > 1e-13 * max(values.max(initial=0.0), np.finfo(float).tiny)
    return np.asarray(loose @ vectors[:, closes])


def _gram(problem: Problem, weights: Array, vectors: Array) -> Array:
    """Σ w v v over the points of all ranks, by motions; collective."""
    own = np.einsum("q,qci,qcj->ij", weights, vectors, vectors)
    return np.asarray(np.sum(of_every_rank(problem.comm, own), axis=0))


def _mostly_pressing(rubbing: Array, pressing: Array) -> Array:
    """Orthonormal columns that span the combinations a with a·R a < a·P a of their own."""
    values, vectors = np.linalg.eigh(rubbing + pressing)
    kept = values > 1e-13 * max(values.max(initial=0.0), np.finfo(float).tiny)
    unit = vectors[:, kept] / np.sqrt(values[kept])
    shares, combinations = np.linalg.eigh(unit.T @ rubbing @ unit)
    return np.asarray(np.linalg.qr(unit @ combinations[:, shares < 0.5])[0])


def _on_springs(
    stiffness: Array, rows: Array, gap: Array, force: Array, start: Array, size: float
) -> Array:
    """Minimise ½ Σ k ((N a − s)₊)² − f · a."""
    from scipy.optimize import minimize

    overlap = float(stiffness @ np.maximum(-gap, 0.0))
    unit = max(np.abs(force).max(), overlap) * size
    if unit == 0:
        return start

    def depth(motion: Array) -> Array:
        return np.asarray(np.maximum(rows @ (size * motion) - gap, 0.0))

    def energy(motion: Array) -> float:
        return float(float(0.5 * stiffness @ depth(motion) ** 2 - force @ motion * size) / unit)

    def slope(motion: Array) -> Array:
        return np.asarray(((stiffness * depth(motion)) @ rows - force) * size / unit)

    def curvature(motion: Array) -> Array:
        active = stiffness * (depth(motion) > 0)
        return np.asarray(np.einsum("q,qi,qj->ij", active, rows, rows) * size**2 / unit)

    found = minimize(
        energy,
        start / size,
        method="trust-exact",
        jac=slope,
        hess=curvature,
        options={"gtol": 1e-6, "initial_trust_radius": 1e-2, "max_trust_radius": 1e3},
    )
    return np.asarray(found.x * size)


logger = logging.getLogger(__name__)

# Slip over the size of a contact from which two bodies are paired anew: it moves the pressure by
# about as much.
_SLID = 1e-3


class Beginning:
    """The state that a solve begins from.

    Attributes:
        continues: Whether it is an answer of the load step before.
        paired_anew: Whether it was found anew what faces what since the last load step.

    Args:
        problem: The problem.
        system: Its unknowns.
        timings: Seconds so far.
    """

    def __init__(self, problem: Problem, system: System, timings: Timings) -> None:
        self._problem, self._system, self._timings = problem, system, timings
        self.continues = False
        self.paired_anew = False

    def anew(self) -> None:
        """Nothing has slipped, supports stand at their values, loose parts touch; collective."""
        self.continues = False
        displacement = starting_point(self._problem)
        for contact in self._problem.contacts:
            contact.kinematics.move(contact.kinematics.relative(displacement))
        self._system.begin(displacement)
        self._problem.stick_all()

    def where_it_flies(self, displacement: Array) -> None:
        """From where bodies would be if nothing acted on them; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        self.continues = True
        self._system.begin(displacement)
        self._system.follow_supports()
        self._problem.stick_all()

    def at(self, position: Array, scalars: Array) -> None:
        """Take a state, at the present loads; collective.

        Args:
            position: Displacements as ``System.position`` gives them (length).
            scalars: Values of the scalar unknowns.
        """
        self._system.begin_at(position)
        self._system.set_scalars(scalars)
        self._system.set_mean_stress()
        self._system.follow_supports()

    def from_last_step(self) -> None:
        """From the state of the last load step, supports at their new values; collective.

        What only contact holds, and nothing touches, is brought into contact as at the start; so
        are bodies that were paired anew, of which none may be touched then.
        """
        is_doubtful = self.paired_anew or self.is_out_of_touch()
        if is_doubtful and RigidMotions(self._problem).count > 0:
            self.anew()
            return
        self.continues = True
        self._system.follow_supports()
        self._problem.stick_all()

    def update_pairing(self, last: Solution) -> None:
        """Follow bodies that slid along each other in the last load step; collective.

        Args:
            last: Of the step, whose state is the present one.
        """
        slid = [c for c in self._problem.contacts if c.relative_sliding() > _SLID]
        self.paired_anew = bool(slid)
        moved = self._system.at_contacts(last.find_body) if slid else None
        for contact in slid:
            logger.debug("  '%s': finding anew what faces what", contact.label)
            contact.update_pairing(moved)
        if slid:
            self.follow_pairing()

    def follow_pairing(self) -> None:
        """Take what faces what as the contacts know it now; collective."""
        with self._timings.phase("assemble"):
            self._system.update_pairing()

    def is_out_of_touch(self) -> bool:
        """Whether nothing presses on an obstacle that a load drives, or nowhere; collective."""
        pushing = [contact for contact in self._problem.contacts if contact.is_one_sided]
        touched = [largest(self._problem.comm, contact.pressure()) > 0 for contact in pushing]
        loose = [contact.gives_way for contact in pushing]
        apart = any(f and not t for f, t in zip(loose, touched, strict=True))
        return apart or (bool(pushing) and not any(touched))
