"""Modes of bodies that no contact touches, by the static factorisation; rigid motions among them.

Where nothing holds a body, springs at as few contact dofs as it has rigid motions do. What is in
balance with itself does not feel them; and what they push is just these motions.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import from_root, total
from fenics_contact.problem.inertia.massless import ContactMasses
from fenics_contact.problem.inertia.modal_masses import FreeModes
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.modes.eigenmodes import Eigenmodes


class PinnedBody:
    """A body that is held by its supports, and by as few springs as it needs; collective.

    Attributes:
        compliance: Of the contact dofs, on rank 0, else none of them (length/force).

    Args:
        body: Condensed, of K as in statics.
    """

    def __init__(self, body: CondensedBody) -> None:
        self._body = body
        of_schur = body.of_schur
        springs = np.zeros(0)
        self.compliance = np.zeros((0, 0))
        if of_schur is not None:
            self.compliance, springs = of_schur.compliance
        self._springs: Array = from_root(body.bulk.comm, springs)

    def solve(self, load: Array) -> Array:
        """Displacements, at this rank's unknowns of the stiffness (length).

        Args:
            load: As of ``CondensedBulk.condense``; or several at once, (…, unknowns).
        """
        bulk = self._body.bulk
        condensed = bulk.condense(load)
        at_contacts = condensed
        if bulk.comm.rank == 0:
            at_contacts = np.asarray(condensed @ self.compliance)  # which is symmetric
        return bulk.expand(load, at_contacts)

    def rigid_motions(self) -> Array:
        """What nothing holds, at this rank's unknowns, (motions, unknowns)."""
        pins = np.flatnonzero(self._springs)
        at_contacts = np.zeros((len(pins), 0))
        if self._body.bulk.comm.rank == 0:
            at_contacts = self.compliance[pins] * self._springs[pins, None]
        none = np.zeros((len(pins), len(self._body.stiffness.numbers)))
        return self._body.bulk.expand(none, at_contacts) if len(pins) else none


def free_modes(body: CondensedBody, masses: ContactMasses, held: Flags, number: int) -> FreeModes:
    """Rigid motions, and the lowest other modes; collective.

    Args:
        body: Condensed, of K as in statics.
        masses: Of its nodes.
        held: What supports hold, (nodes, components).
        number: Of modes beside the rigid motions.

    Raises:
        InputError: There are not so many.
        NotConvergedError: They were not found.
    """
    stiffness, spaces = body.stiffness, body.discrete.spaces
    pinned, free = PinnedBody(body), ~held
    own = slice(spaces.owned_nodes)

    def times_mass(nodal: Array) -> Array:
        return masses.times(nodal * free) * free

    def dots(one: Array, other: Array) -> Array:
        flat = (each[:, own].reshape(len(each), -1) for each in (one, other))
        return np.asarray(total(spaces.comm, next(flat) @ next(flat).T))

    shape = (-1, *held.shape)
    rows = [stiffness.at_nodes(row) for row in pinned.rigid_motions()]
    rigid = np.array(rows).reshape(shape)
    moved = np.array([times_mass(row) for row in rigid]).reshape(shape)
    if len(rigid):
        inverse = np.linalg.inv(np.linalg.cholesky(dots(rigid, moved)))
        rigid, moved = (np.tensordot(inverse, each, 1) for each in (rigid, moved))

    def solve(nodal: Array) -> Array:
        """By what is not rigid of forces, what is not rigid of the answer."""
        nodal = nodal - np.tensordot(dots(rigid, nodal[None])[:, 0], moved, 1)
        load = stiffness.load(nodal, np.zeros_like(nodal), body.held)
        found = stiffness.at_nodes(pinned.solve(load))
        return np.asarray(found - np.tensordot(dots(moved, found[None])[:, 0], rigid, 1))

    count = int(total(spaces.comm, float(free[own].sum())))
    modes = Eigenmodes(spaces, times_mass, solve, "motion.modes").lowest(number, count, exact=True)
    sizes = [1 / np.sqrt(mode.mass) for mode in modes]
    shapes = [*rigid, *(size * mode.shape for size, mode in zip(sizes, modes, strict=True))]
    forces = [*moved, *(size * mode.forces for size, mode in zip(sizes, modes, strict=True))]
    squares = [0.0] * len(rigid) + [mode.circular_frequency**2 for mode in modes]
    return FreeModes(np.stack(shapes, axis=-1), np.stack(forces, axis=-1), np.array(squares))
