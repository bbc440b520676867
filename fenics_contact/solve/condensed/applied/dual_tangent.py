"""The condensed tangent where S is applied and never formed: GMRES on the forces of contacts.

W acts along directions P at the nodes. With D = Pᵀ W P, which is sparse, and the stiffness Σ of the
nodes, the unknowns are forces s, of jumps a = (D + Σ)⁻¹ s along P. The bodies answer to these by
y = S⁻¹ (r − C q − Qᵀ W P a) + X α, with motions X that no support resists and the body's scalars q.
That the jumps of y are a leaves

    a + Pᵀ Q S⁻¹ Qᵀ W P a − G z = Pᵀ Q S⁻¹ r,    z = (α, q),

beside one equation for each of z, which is eliminated with Σ in place of S (the natural coarse
space of FETI: C. Farhat, F.-X. Roux, Int. J. Numer. Methods Eng. 32 (1991) 1205-1227). The
preconditioner is their "lumped" one: the stiffness of bodies of which nothing but the jumps moves,
where W is stiff, and Σ where it is soft.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import ClassVar

import numpy as np
from petsc4py import PETSc
from scipy.sparse import block_diag, csc_matrix, csr_matrix, diags, identity
from scipy.sparse.linalg import splu

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.solve.condensed.applied.applied_bulk import AppliedSchur
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent
from fenics_contact.solve.condensed.scalar_border import ScalarBorder
from fenics_contact.solve.condensed.split_solver import LEFT, NodalDirections
from fenics_contact.solve.condensed.tangent import TangentOfUnknowns
from fenics_contact.solve.systems.contact_stiffness import Entries

# Stiffness that contacts give a node in a direction, over the body's there, from which they act:
# springs that tell free motions apart are as soft as 1e-6.
_ACTS = 1e-12
# Solves, each of what the ones before have left; steps of GMRES in each.
_SOLVES, _MOST_STEPS = 6, 150
# GMRES measures what is left by its preconditioner: so many times what may be left is near enough.
_NEARLY = 3.0
# Share that a solve leaves, from which it is no solution.
_HARDLY = 0.5
# Stiffness against a motion, over that of the nodes that it moves, up to which nothing resists it.
_SINGULAR = 1e-11


class DualTangent(TangentOfUnknowns):
    """M = A + Qᵀ W Q of all unknowns but the body's scalars, where S in A is applied.

    Args:
        constant: A and Q, without scalars of contacts.
        schur: S.
        nodes: Number of the node that each displacement belongs to.
    """

    left_at_most: ClassVar[float] = 1e-3  # each digit costs as much as the first

    def __init__(self, constant: ConstantTangent, schur: AppliedSchur, nodes: Integers) -> None:
        super().__init__(constant)
        self._schur = schur
        self._directions = NodalDirections(nodes, schur.diagonal, _ACTS)
        self._solvers: dict[bool, _DualSolver] = {}
        self._moved: Array | None = None

    def set(self, entries: Entries) -> None:
        """Set W by its entries; those at the same place add up."""
        super().set(entries)
        self._solvers = {}

    def solve(self, border: ScalarBorder, right: Array, left: float) -> Array:
        """Solve for the unknowns and the body's scalars; not a number where that is singular."""
        free, held = np.flatnonzero(~border.held), np.flatnonzero(border.held)
        forces, own = np.split(right, [self.size])
        known = own[held] / border.units[held]
        forces = forces - border.columns[:, held] @ known
        own = own[free] - border.corner[np.ix_(free, held)] @ known
        inner, found = self._solved(border, forces, own, left, transposed=False)
        scalars = np.zeros(border.count)
        scalars[held], scalars[free] = known, found
        return np.append(inner, scalars)

    def solve_transposed(self, border: ScalarBorder, right: Array) -> Array:
        """Solve with the transpose of the whole; not a number where it is singular."""
        free, held = np.flatnonzero(~border.held), np.flatnonzero(border.held)
        forces, own = np.split(right, [self.size])
        inner, found = self._solved(border, forces, own[free], LEFT, transposed=True)
        scalars = np.zeros(border.count)
        others = own[held] - border.columns[:, held].T @ inner
        others -= border.corner[np.ix_(held, free)] @ found
        scalars[held], scalars[free] = others / border.units[held], found
        return np.append(inner, scalars)

    def compliances(
        self,
        relative_to: Callable[[Integers], csr_matrix],
        across: csr_matrix,
        ways: Sequence[csr_matrix],
    ) -> None:
        """None: as many solves as there are points would cost more than the answer."""

    def _solved(
        self, border: ScalarBorder, forces: Array, own: Array, left: float, transposed: bool
    ) -> tuple[Array, Array]:
        """Unknowns, and the scalars that are free."""
        if transposed not in self._solvers:
            self._solvers[transposed] = self._solver(border, transposed)
        solver = self._solvers[transposed]
        right = np.append(forces, own)
        allowed = left * float(np.linalg.norm(right))
        found, rest = np.zeros(len(right)), right
        norm = start = float(np.linalg.norm(right))
        for _ in range(_SOLVES):
            found += solver.solve(rest, allowed)
            rest, before = right - solver.times(found), norm
            norm = float(np.linalg.norm(rest))
            if not norm > _NEARLY * allowed or norm > _HARDLY * before:
                break
        if not norm <= _HARDLY * start:
            found[:] = np.nan
        return found[: self.size], found[self.size :]

    def _solver(self, border: ScalarBorder, transposed: bool) -> _DualSolver:
        """The solver of the present W, and of the scalars that are free now."""
        if self._moved is None:
            self._moved = self._schur.moved_by(border.columns.T).T
        free = np.flatnonzero(~border.held)
        count = self.constant.count
        added = csr_matrix(self._added.T) if transposed else self._added
        basis, acts = self._directions.split(added[:count, :count])
        derived = identity(self.constant.width - count, format="csr")
        directions = csr_matrix(block_diag([csr_matrix(basis[:, acts]), derived]))
        of_derived = np.full(derived.shape[0], self._schur.stiffest)
        scale = np.concatenate([self._directions.scale[acts], of_derived])
        columns, corner = border.columns[:, free], border.corner[np.ix_(free, free)]
        of_scalars = columns, self._moved[:, free], corner
        return _DualSolver(self.constant, self._schur, added, directions, scale, of_scalars)


class _DualSolver:
    """M and scalars around it, for one W.

    Args:
        constant: A and Q.
        schur: S.
        added: W, (all of Q y, all of Q y).
        directions: P, (all of Q y, directions).
        scale: Σ, stiffness of the nodes along each of these.
        scalars: What scalars do to the unknowns, C; S⁻¹ C; and what they do to each other.
    """

    def __init__(
        self,
        constant: ConstantTangent,
        schur: AppliedSchur,
        added: csr_matrix,
        directions: csr_matrix,
        scale: Array,
        scalars: tuple[Array, Array, Array],
    ) -> None:
        self._constant, self._schur, self._added = constant, schur, added
        self._directions, self._scale = directions, scale
        self._columns, self._moved, self._corner = scalars
        self._across = csr_matrix(directions.T)
        self._pushed = csr_matrix(added @ directions)
        self._own = csc_matrix(self._across @ self._pushed)
        # What acts nowhere is factorised with a row of its own: SuperLU has no empty matrices.
        self._eased = splu(csc_matrix(self._own + diags(scale))) if len(scale) else None
        motions = schur.motions
        self._motions = motions
        self._onto = self._across @ self._every(np.hstack([motions, -self._moved]))
        self._from = self._work(self._every(np.hstack([motions, self._moved])))
        free = motions.shape[1]
        beside = np.zeros((self._onto.shape[1],) * 2)
        beside[:free, free:] = motions.T @ self._columns
        beside[free:, :free] = -(self._columns.T @ motions)
        beside[free:, free:] = self._columns.T @ self._moved - self._corner
        self._carried = scale[:, None] * self._onto
        by_nodes = self._from @ self._carried
        size = np.abs(by_nodes.diagonal())
        size[free:] += np.abs(self._corner.diagonal())  # of which ``beside`` may be round-off
        self._size = np.sqrt(np.where(size > 0, size, 1.0))
        scaled = (beside + by_nodes) / np.outer(self._size, self._size)
        # Loads may be in balance where nothing resists a motion.
        self._coarse = np.linalg.pinv(scaled, rcond=_SINGULAR)
        # Forces of derived jumps are made of jumps that are differences.
        first = self._own.shape[0] - len(constant.derived)
        stiff = np.abs(self._own.diagonal()[first:]) / scale[first:]
        self._longer = float(stiff.max(initial=1.0))

    def _every(self, columns: Array) -> Array:
        """Q y of several y, (unknowns, several)."""
        return np.vstack([columns, self._constant.derived @ columns])

    def _eased_jumps(self, forces: Array, trans: str = "N") -> Array:
        """(D + Σ)⁻¹ s."""
        return forces if self._eased is None else np.asarray(self._eased.solve(forces, trans))

    def _work(self, virtual: Array) -> Array:
        """Work that the forces of contacts of unit s do in virtual jumps, (several, directions)."""
        pushed = np.ascontiguousarray(self._pushed.T @ virtual)
        return self._eased_jumps(pushed, "T").T

    def _coarsely(self, right: Array) -> Array:
        """Solve the equations beside for z, where nodes alone are stiff."""
        return np.asarray(self._coarse @ (right / self._size) / self._size)

    def times(self, values: Array) -> Array:
        """Product with unknowns and scalars."""
        inner, scalars = np.split(values, [self._constant.size])
        forces = self._constant.with_contacts(self._added, inner) + self._columns @ scalars
        return np.append(forces, self._columns.T @ inner + self._corner @ scalars)

    def _forces(self, shares: Array) -> Array:
        """Qᵀ W P a of s: forces of contacts on the unknowns."""
        return self._constant.onto_unknowns(self._pushed @ self._eased_jumps(shares))

    def _jumps(self, shares: Array) -> Array:
        """Sum a + Pᵀ Q S⁻¹ Qᵀ W P a of s."""
        moved = self._schur.moved_by(self._forces(shares))
        found = self._across @ self._constant.every(moved)
        return np.asarray(self._eased_jumps(shares) + found)

    def _balanced(self, shares: Array, beside: Array) -> tuple[Array, Array]:
        """Forces s with what z adds, and z, so that the equations beside hold."""
        z = self._coarsely(beside - self._from @ shares)
        return shares + self._carried @ z, z

    def mult(self, matrix: PETSc.Mat, values: PETSc.Vec, result: PETSc.Vec) -> None:
        """Product with what is left for s, as PETSc asks for it."""
        shares, z = self._balanced(np.array(values.array_r), np.zeros(len(self._size)))
        with result as array:
            array[:] = self._jumps(shares) - self._onto @ z

    def apply(self, preconditioner: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Nearly its inverse, as PETSc asks for it."""
        jumps, count = np.array(right.array_r), self._constant.count
        z = self._coarsely(self._from @ (self._scale * jumps))
        rest = jumps - self._onto @ z
        across = self._across[:, :count]
        eased = self._eased_jumps(self._own @ rest)
        own = across @ self._schur.held_times((self._directions @ eased)[:count])
        is_own = np.diff(across.indptr) > 0  # no derived jump
        stiff = np.where(is_own, own - self._scale * eased, 0.0)
        found = self._own.T @ self._eased_jumps(stiff, "T") + self._scale * rest
        found -= self._carried @ self._coarsely(self._from @ found)
        with solution as array:
            array[:] = found + self._carried @ z

    def solve(self, right: Array, left: float) -> Array:
        """Unknowns and scalars.

        Args:
            right: Of both.
            left: Forces that may be left.
        """
        size, motions = self._constant.size, self._motions
        forces, own = np.split(right, [size])
        wanted = self._across @ self._constant.every(self._schur.moved_by(forces))
        beside = np.append(motions.T @ forces, self._moved.T @ forces - own)
        shares, z = self._balanced(np.zeros(len(self._scale)), beside)
        if len(shares):
            given = wanted - self._jumps(shares) + self._onto @ z
            shares, z = self._balanced(_gmres(self, given, left / self._longer), beside)
        alpha, scalars = np.split(z, [motions.shape[1]])
        rest = forces - self._columns @ scalars - self._forces(shares)
        found = self._schur.moved_by(rest) + motions @ alpha
        # Stiff contacts have the jumps of their forces: no difference of long numbers.
        off = self._eased_jumps(shares) - self._across @ self._constant.every(found)
        found += (self._directions @ self._eased_jumps(self._own @ off))[:size]
        return np.append(found, scalars)


def _gmres(context: _DualSolver, right: Array, left: float) -> Array:
    """Forces s by GMRES, until no more of them are left than may be, or steps come to an end."""
    operator = PETSc.Mat().createPython((len(right),) * 2, context, comm=PETSc.COMM_SELF)
    operator.setUp()
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(operator)
    solver.setType("gmres")
    solver.setGMRESRestart(_MOST_STEPS)
    solver.setPCSide(PETSc.PC.Side.LEFT)  # so that forces are what is measured
    solver.setTolerances(rtol=np.finfo(float).eps, atol=left, max_it=_MOST_STEPS)
    solver.getPC().setType("python")
    solver.getPC().setPythonContext(context)
    given = PETSc.Vec().createWithArray(right, comm=PETSc.COMM_SELF)
    found = given.duplicate()
    solver.solve(given, found)
    result = np.array(found.array_r)
    for thing in (solver, operator, given, found):
        thing.destroy()
    return result
