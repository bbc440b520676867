"""A body that moves in a few modes, condensed onto its contacts: (R + V D Vᵀ)⁻¹ there, and back.

No step solves inside the body. What loads beside those of inertia do, and what forces at contact
dofs do, is found when they act first, and remembered: n numbers for each.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import from_root, raise_together, total
from fenics_contact.problem.massless import FreeModes
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.free_modes import PinnedBody

# Of a load: what is left of it beside modes and known loads is round-off.
_SAME = 1e-12
# Of the largest force at the contact dofs, by which round-off differs from one that presses.
_NO_FORCE = 1e-13
# Contact dofs whose flexibility is found together, and the memory of one rank for all (bytes).
_BLOCK, _MOST_BYTES = 16, 1e9


class ModalBulk(CondensedBulk):
    """The condensed bulk of a step of motion in a few modes; collective.

    Args:
        body: Condensed, of K as in statics.
        modes: V.
        size: Length of a step (time).

    Raises:
        NotConvergedError: The modes leave nothing of the body at its contacts; on every rank.
    """

    def __init__(self, body: CondensedBody, modes: FreeModes, size: float) -> None:
        self._static, self._pinned = body.bulk, PinnedBody(body)
        self.comm, self.count = self._static.comm, self._static.count
        stiffness, dofs = body.stiffness, body.dofs
        self._motions = 1 / (modes.squares + 4 / size**2)  # D
        shapes, forces = (np.moveaxis(each, 2, 0) for each in (modes.shapes, modes.forces))
        self._shapes = np.array([stiffness.at_unknowns(one) for one in shapes]).T
        self._forces = np.array([stiffness.share(one) for one in forces]).T
        at_contacts = [dofs.gathered(one.reshape(-1))[dofs.is_free] for one in shapes]
        self._at_contacts = np.array(at_contacts).T
        self._flexed = self._pinned.solve(np.ascontiguousarray(self._forces.T)).T  # G M V
        # Mean stresses of modes are those that their forces of inertia make, ω² M V.
        stresses = slice(len(stiffness.displacements), None)
        self._shapes[stresses] = self._flexed[stresses] * modes.squares
        self._inner = self._dots(self._forces, self._flexed)
        nodal = [dofs.gathered(stiffness.at_nodes(one).reshape(-1)) for one in self._flexed.T]
        self._flexed_there = np.array(nodal)[:, dofs.is_free].T
        self._make_schur()
        self._loads: list[tuple[Array, Array, Array]] = []
        self._unknowns, self._known = len(stiffness.numbers), 0
        self._pushed = np.zeros((self._unknowns, 0))  # R of single forces, as many as are known
        self._place = np.full(self.count, -1)
        self._last: tuple[Array, Array, Array, Array] | None = None
        self._largest = 0.0

    def _make_schur(self) -> None:
        self.schur, error = None, None
        if self.comm.rank == 0:
            there, flexed = self._at_contacts, self._flexed_there
            residual = self._pinned.compliance - there @ flexed.T - flexed @ there.T
            residual += there @ self._inner @ there.T
            self._flexibility = residual
            compliance = residual + (there * self._motions) @ there.T
            try:
                factor = cho_factor(0.5 * (compliance + compliance.T), lower=True)
                self.schur = np.ascontiguousarray(cho_solve(factor, np.eye(self.count)))
            except np.linalg.LinAlgError:
                error = NotConvergedError(
                    "motion.modes: so many modes leave no other motion to the contacts; ask for "
                    "fewer, or leave modes out"
                )
        raise_together(self.comm, error)

    @property
    def factorisations(self) -> int:  # type: ignore[override]
        """How often K was factorised."""
        return self._static.factorisations

    def _dots(self, one: Array, other: Array) -> Array:
        """oneᵀ other, of which one has this rank's share."""
        return np.asarray(total(self.comm, one.T @ other))

    def condense(self, load: Array) -> Array:
        """Forces at the free contact dofs that move them as a load does, on rank 0.

        Args:
            load: This rank's share of the forces on its unknowns; values where held.
        """
        along = self._dots(self._shapes, load)
        moved, there = self._residual(load - self._forces @ along, load)
        condensed = np.zeros(self.count)
        if self.schur is not None:
            condensed = self.schur @ (there + self._at_contacts @ (self._motions * along))
        self._last = load, along, moved, condensed
        return condensed

    def expand(self, load: Array, x: Array) -> Array:
        """This rank's unknowns where the contact dofs are x (on rank 0)."""
        same = self._last is not None and np.array_equal(load, self._last[0])
        if total(self.comm, float(same)) != self.comm.size:
            self.condense(load)
        assert self._last is not None
        _, along, moved, condensed = self._last
        forces = None if self.schur is None else self.schur @ x - condensed
        which, acting = from_root(self.comm, self._acting(forces, condensed))
        along = along + acting @ self._at_contacts[which]
        in_modes = self._shapes @ (self._motions * along)
        return np.asarray(moved + in_modes + self._moved_by(which, acting))

    def condense_and_expand(self, load: Array) -> tuple[Array, Array]:
        """Both, one load after the other."""
        pairs = [(self.condense(one), self.expand(one, np.zeros(self.count))) for one in load]
        condensed, found = (np.array(column) for column in zip(*pairs, strict=True))
        return condensed, found

    def _acting(self, forces: Array | None, condensed: Array) -> tuple[Integers, Array]:
        """Where contacts press, and how much."""
        if forces is None:
            return np.zeros(0, dtype=np.int64), np.zeros(0)
        self._largest = max(self._largest, float(np.abs(condensed).max(initial=0.0)))
        which = np.flatnonzero(np.abs(forces) > _NO_FORCE * self._largest)
        return which, forces[which]

    def _moved_by(self, which: Integers, forces: Array) -> Array:
        """R of forces at contact dofs."""
        new = self._in_blocks(which[self._place[which] < 0])
        size = (self._known + len(new)) * self._unknowns * 8
        if total(self.comm, float(size > _MOST_BYTES)):
            return self._pushed_by(which, forces[:, None])[:, 0]
        for first in range(0, len(new), _BLOCK):
            self._remember(new[first : first + _BLOCK])
        every = np.zeros(self._known)
        every[self._place[which]] = forces
        return np.asarray(self._pushed[:, : self._known] @ every)

    def _in_blocks(self, new: Integers) -> Integers:
        """With others that will press soon, those they move most: a block costs little more."""
        more = -len(new) % _BLOCK
        if more and self.comm.rank == 0:
            sizes = np.abs(self._flexibility[new]).max(axis=0)
            sizes[self._place >= 0] = sizes[new] = -1.0
            others = np.argsort(-sizes, kind="stable")[:more]
            new = np.concatenate([new, others[sizes[others] >= 0]])
        return from_root(self.comm, new)

    def _remember(self, new: Integers) -> None:
        """Find R of forces of 1 at some contact dofs."""
        last = self._known + len(new)
        if last > self._pushed.shape[1]:
            room = max(last, min(2 * last, int(_MOST_BYTES / 8 / self._unknowns)))
            wider = np.zeros((self._unknowns, room), order="F")
            wider[:, : self._known] = self._pushed[:, : self._known]
            self._pushed = wider
        self._pushed[:, self._known : last] = self._pushed_by(new, np.eye(len(new)))
        self._place[new] = np.arange(self._known, last)
        self._known = last

    def _pushed_by(self, which: Integers, forces: Array) -> Array:
        """R of the columns of forces at contact dofs, by a solve inside the body."""
        moved = np.zeros((forces.shape[1], 0))
        if self.comm.rank == 0:
            moved = forces.T @ self._pinned.compliance[which]
        none = np.zeros((forces.shape[1], self._unknowns))
        found = self._static.expand(none, moved).T
        along, flexed = (each[which].T @ forces for each in (self._at_contacts, self._flexed_there))
        of_modes = self._shapes @ (flexed - self._inner @ along) + self._flexed @ along
        return np.asarray(found - of_modes)

    def _residual(self, left: Array, load: Array) -> tuple[Array, Array]:
        """R of what a load leaves besides the modes, and its part at the free contact dofs."""
        size = total(self.comm, np.abs(load).sum())
        moved, there = np.zeros_like(left), np.zeros(self.count)
        for known, response, at_contacts in self._loads:
            share = total(self.comm, float(known @ left))
            left = left - share * known
            moved, there = moved + share * response, there + share * at_contacts
        if total(self.comm, np.abs(left).sum()) > _SAME * size:
            share = np.sqrt(total(self.comm, float(left @ left)))
            self._loads.append((left / share, *self._flexible(left / share)))
            moved, there = moved + share * self._loads[-1][1], there + share * self._loads[-1][2]
        return moved, there

    def _flexible(self, load: Array) -> tuple[Array, Array]:
        """``_residual`` of a load that modes do not feel, by a solve inside the body."""
        at_contacts = self._static.condense(load)
        there = np.zeros(self.count)
        if self.comm.rank == 0:
            there = self._pinned.compliance @ at_contacts
        found = self._static.expand(load, there)
        along = self._dots(self._forces, found)
        return found - self._shapes @ along, there - self._at_contacts @ along

    def destroy(self) -> None:
        """The body as in statics is kept by its owner."""
