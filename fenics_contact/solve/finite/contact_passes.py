"""Contact and friction on the contact dofs alone: the middle and the inner loop.

S δ = f + r(x + δ) is to be solved for the change δ of the contact dofs, with the forces r of the
exact laws where the points then are. A pass measures gaps, normals and slips, and solves the laws
on this geometry (``solve.exact``), with the turn of the forces as points move along an obstacle.
Statuses that are read off a curved gap after a long step would change for ever: so they are settled
while geometry rests.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import LinAlgError, lu_factor, lu_solve, null_space
from scipy.sparse import csr_matrix, vstack

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import from_root
from fenics_contact.contact.finite.current_obstacle import CurrentObstacle
from fenics_contact.contact.state import OPEN, STICK
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.at_points.contact_points import ContactPoints
from fenics_contact.solve.at_points.point_laws import laws_of
from fenics_contact.solve.exact.local_problem import LocalProblem, PointLaws
from fenics_contact.solve.exact.solver import solve
from fenics_contact.solve.systems.contact_dofs import ContactDofs

logger = logging.getLogger(__name__)

# Passes of the middle loop; two to four are usual.
_MOST = 30
# Of |S| |δ|, what round-off may leave.
_ROUNDING = 20 * float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class PointAnswer:
    """Forces of a pass, the same on every rank.

    Attributes:
        rows: Of each point, across and along (force).
        closed: Points that touch, (points,).
        sticks: Those of these that stick.
        change: Further change of the free contact dofs (length).
    """

    rows: Array
    closed: Flags
    sticks: Flags
    change: Array


class ContactPasses:
    """The contacts of a problem, solved on the tangent of the body.

    Attributes:
        count: Passes so far.

    Args:
        problem: The model.
        dofs: The contact dofs.
    """

    def __init__(self, problem: Problem, dofs: ContactDofs) -> None:
        self._problem, self._dofs = problem, dofs
        self._contacts = [one for one in problem.contacts if one.forces.terms]
        self._place = np.full(int(dofs.numbers.max(initial=-1)) + 1, -1)
        self._place[dofs.free] = np.arange(len(dofs.free))
        self._rows = np.zeros(0)  # forces at the points, where the laws were solved last
        self.count = 0

    def forget(self) -> None:
        """Begin the next solve without any forces."""
        self._rows = np.zeros(0)

    def solve(
        self, schur: Array | None, forces: Array, base: Array, share: float
    ) -> tuple[Array, Array]:
        """Solve for the change of the contact dofs; contacts are measured there; collective.

        Args:
            schur: S, on rank 0.
            forces: f on the free contact dofs, likewise (force).
            base: Displacement before the change, with supports at their new values, at the nodes
                of this rank, (nodes, components) (length).
            share: Of the forces, what may be left of them.

        Returns:
            δ, on every rank (length), and all contact forces at the body's nodes, (nodes,
            components) (force).

        Raises:
            NotConvergedError: There is no answer, or it is not found.
        """
        change = np.zeros(len(self._dofs.free))
        for number in range(_MOST):
            geometry = self._last = self._measure(base, change)
            if number and self._is_settled(schur, forces, change, geometry, share):
                return change, self.forces()
            answer = self._solved(schur, forces, change, geometry)
            self._act(geometry.points, answer)
            self._closed, self._sticks = answer.closed, answer.sticks
            self._rows = answer.rows
            change = change + answer.change
            self.count += 1
        raise NotConvergedError(
            f"contact geometry does not settle in {_MOST} passes: the load step is too long", ()
        )

    def unstable_motions(self, schur: Array | None) -> int:
        """Number of motions of the contact dofs that grow by themselves at the answer; collective.

        Free are motions that keep closed points closed, and those that stick where they are.
        Friction of a point that slips follows the force across it, so that the tangent of these
        motions is not symmetric: counted are its eigenvalues with a real part below 0.

        Args:
            schur: S about the answer, on rank 0.
        """
        at, found = self._last, None
        if schur is not None:
            tangent = schur - at.turning(self._rows)
            found = _falling(tangent, at, self._closed, self._sticks, self._rows)
        return int(from_root(self._problem.comm, found) or 0)

    def forces(self) -> Array:
        """All contact forces at the body's nodes at present, (nodes, components); collective."""
        found = np.zeros_like(self._problem.load)
        for contact in self._contacts:
            found += contact.kinematics.on_body(contact.forces.all())
        return found

    def _measure(self, base: Array, change: Array) -> _Geometry:
        """Measure all contacts where the change takes them; collective."""
        places = base + self._dofs.placed(change).reshape(base.shape)
        for contact in self._contacts:
            contact.measure(places)
        points = [ContactPoints(contact) for contact in self._contacts]
        return _Geometry(
            points=points,
            rows=self._over_free(points),
            openings=np.concatenate([np.zeros(0), *(one.openings().ravel() for one in points)]),
            curvature=_of_points(points, lambda one: one.curvature),
            slip_rate=_of_points(points, lambda one: one.slip_rate),
        )

    def _over_free(self, points: Sequence[ContactPoints]) -> csr_matrix:
        """Gaps and slips of the points over the free contact dofs."""
        found = []
        for one in points:
            place = self._place[one.contact.trace.surface.dofs]
            entries = one.jump_rows().tocoo()
            kept = place[entries.col] >= 0
            where = entries.row[kept], place[entries.col[kept]]
            shape = (entries.shape[0], len(self._dofs.free))
            found.append(csr_matrix((entries.data[kept], where), shape=shape))
        return csr_matrix(vstack(found)) if found else csr_matrix((0, len(self._dofs.free)))

    def _is_settled(
        self, schur: Array | None, forces: Array, change: Array, at: _Geometry, share: float
    ) -> bool:
        """Whether forces balance, and laws hold, on the geometry as it is now; collective."""
        is_settled = None
        if schur is not None:
            left = schur @ change - forces - at.rows.T @ self._rows
            gaps, slips = np.abs(at.openings.reshape(-1, 2).T)
            edges = [np.full(one.count, one.contact.facet_size) for one in at.points]
            small = CurrentObstacle.gap_left * np.concatenate([np.zeros(0), *edges])
            open_laws = (self._closed & (gaps > small)) | (self._sticks & (slips > small))
            entered = ~self._closed & (at.openings[::2] < -small)
            limit = share * (np.abs(self._rows).sum() + np.abs(forces).sum())
            limit += _ROUNDING * float((np.abs(schur) @ np.abs(change)).sum())
            is_settled = bool(np.abs(left).sum() <= limit and not (open_laws | entered).any())
        return bool(from_root(self._problem.comm, is_settled))

    def _solved(
        self, schur: Array | None, forces: Array, change: Array, at: _Geometry
    ) -> PointAnswer:
        """The laws on a geometry that rests; collective.

        Raises:
            NotConvergedError: No answer was found.
        """
        laws = laws_of(at.points) if at.points else None
        found: PointAnswer | str | None = None
        if schur is not None:
            found = self._on_root(schur, forces - schur @ change, at, laws)
        found = from_root(self._problem.comm, found)
        assert found is not None
        if isinstance(found, str):
            raise NotConvergedError(found, ())
        return found

    def _on_root(
        self, schur: Array, left: Array, at: _Geometry, laws: PointLaws | None
    ) -> PointAnswer | str:
        """Solve the laws on a geometry that rests, on rank 0; in words why there is no answer."""
        if len(self._rows) != len(at.openings):
            self._rows = np.zeros(len(at.openings))
        try:
            factor = lu_factor(schur - at.turning(self._rows))
            moved = lu_solve(factor, at.rows.T.toarray())
            free = at.openings + at.moves @ lu_solve(factor, left)
            problem = None if laws is None else LocalProblem(at.moves @ moved, free, laws)
            with np.errstate(all="ignore"):
                answer = None if problem is None else solve(problem, self._rows, is_patient=False)
        except (ArithmeticError, ValueError, LinAlgError) as error:
            return f"contact and friction on the deformed body break down: {error}"
        nothing = np.zeros(0)
        if answer is None:
            return PointAnswer(nothing, nothing > 0, nothing > 0, lu_solve(factor, left))
        if not answer.converged:
            return (
                f"contact and friction have no answer on the deformed body: {answer.residual:.1e} "
                f"of the forces is left after {answer.steps} steps"
            )
        closed, sticks = answer.statuses != OPEN, answer.statuses == STICK
        change = lu_solve(factor, left + at.rows.T @ answer.forces)
        return PointAnswer(answer.forces, closed, sticks, change)

    def _act(self, points: Sequence[ContactPoints], answer: PointAnswer) -> None:
        """Have the forces act; collective."""
        first = 0
        for one in points:
            last = first + one.count
            rows = answer.rows[first * one.size : last * one.size].reshape(-1, one.size)
            pressure, traction = one.tractions(rows)
            found = one.contact.found
            assert found is not None
            found = replace(
                found,
                pressure=pressure,
                traction=traction,
                closed=one.flags(answer.closed[first:last]),
                sticks=one.flags(answer.sticks[first:last]),
            )
            one.contact.take_found(found)
            first = last


@dataclass(frozen=True, eq=False)
class _Geometry:
    """Gaps, slips and directions at all contact points as measured last, the same on every rank.

    Attributes:
        points: Those of each contact.
        rows: Of each point the ways across and along over the free contact dofs, (rows, dofs): by
            these forces act.
        openings: Gaps and slips of the present places, (rows,) (length).
        curvature: By which forces turn as points move along, (points,) (1/length).
        slip_rate: How fast slip grows by the way along, (points,).
    """

    points: list[ContactPoints]
    rows: csr_matrix
    openings: Array
    curvature: Array
    slip_rate: Array

    @property
    def moves(self) -> csr_matrix:
        """Change of gaps and slips by that of the free contact dofs, (rows, dofs)."""
        rates = np.stack([np.ones_like(self.slip_rate), self.slip_rate], axis=1)
        return csr_matrix(self.rows.multiply(rates.reshape(-1, 1)))

    def turning(self, forces: Array) -> Array:
        """Change of forces by their turn, over the free contact dofs, (dofs, dofs) (force/length).

        With δn = κ t (t · δ) and δt = −κ n (t · δ) of an obstacle's normal n and tangent t, forces
        r_n n + r_t t change by κ (r_n t − r_t n) (t · δ).

        Args:
            forces: r of the points, (rows,) (force).
        """
        across, along = self.rows[::2], self.rows[1::2]
        turned = along.multiply((self.curvature * forces[::2])[:, None])
        turned = turned - across.multiply((self.curvature * forces[1::2])[:, None])
        return np.asarray((turned.T @ along).toarray())


# Of the largest entry of a tangent: eigenvalues that are round-off.
_ROUND_OFF = 1e-10


def _falling(tangent: Array, at: _Geometry, closed: Flags, sticks: Flags, forces: Array) -> int:
    """Number of motions that grow, of those that contact and friction leave, on rank 0.

    With the tangent T, motions z = Z y and what slipping points put on them, r_t = (r_t/r_n) r_n,
    they go by Lᵀ T Z, where the rows of L are those of Z less (r_t/r_n) those across the point.
    """
    across, along = (at.rows[part::2].toarray() for part in (0, 1))
    stops = np.concatenate([across[closed], along[sticks]])
    stops = stops[np.linalg.norm(stops, axis=1) > 0]
    free = np.eye(len(tangent)) if not len(stops) else null_space(stops)
    slips = closed & ~sticks & (forces[::2] > 0)
    ratio = forces[1::2][slips] / forces[::2][slips]
    carried = across[slips] * ratio[:, None]
    pushed = free - carried.T @ (along[slips] @ free)
    found = np.linalg.eigvals(pushed.T @ tangent @ free)
    return int((found.real < -_ROUND_OFF * np.abs(tangent).max(initial=0.0)).sum())


def _of_points(points: Sequence[ContactPoints], value: Callable[[CurrentObstacle], Array]) -> Array:
    """Values at the points of all ranks and contacts, on every rank; collective, (points,)."""
    found = [np.zeros(0)]
    for one in points:
        kinematics = one.contact.kinematics
        assert isinstance(kinematics, CurrentObstacle)
        found.append(one.of_all_ranks(value(kinematics)))
    return np.concatenate(found)
