"""Contact and friction in the plane as exact inequalities: no penalty, no regularisation.

A point is open, sticks, or slips to one side or the other. With that given, displacements and
nodal forces solve a linear system; statuses that break an inequality are changed until none does
(an active-set method). What is left then is an exact solution of the discrete problem, whichever
way it was found: u_n ≤ s, p ≥ 0, |t| ≤ μ p, and slip only against the full friction. Nothing of
the program's contact terms or solvers is used, only its stiffness, loads and gaps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import on_root
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.hard.case import ReferenceFailedError

Start = Callable[[Array], Integers]

OPEN, BACK, STICK, ALONG = -2, -1, 0, 1
_MOST = 40
# Of forces and displacements: what round-off leaves of an equality.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class ExactAnswer:
    """At all contact points, sorted as those of a result.

    Attributes:
        coordinates: (points, 2) (length).
        pressure: (points,) (stress).
        friction: Traction on the body along the normal turned by a right angle (stress).
        weights: Area that each point stands for.
        status: Of each.
    """

    coordinates: Array
    pressure: Array
    friction: Array
    weights: Array
    status: Integers

    @property
    def normal_force(self) -> float:
        """∫ p (force)."""
        return float(self.weights @ self.pressure)

    @property
    def friction_force(self) -> float:
        """∫ of the friction (force)."""
        return float(self.weights @ self.friction)


def exact_answer(scene: Scene, body: Callable[[MPI.Comm], Body], *starts: Start) -> ExactAnswer:
    """Solve a scene of the static law with one contact; collective, found on one rank.

    Args:
        scene: In the plane or axisymmetric, with a coefficient of friction that is a number.
        body: Makes the mesh on a communicator.
        starts: Statuses to begin with, from the coordinates of the points, where beginning with all
            points sticking, or slipping to one side, leads to no rest.

    Raises:
        ReferenceFailedError: Nothing led to rest.
    """

    def solve() -> ExactAnswer:
        problem = _Inequalities(scene, body(MPI.COMM_SELF))
        for start in (_all_stick, _all_along, _all_back, *starts):
            found = problem.solve(start)
            if found is not None:
                return found
        raise ReferenceFailedError("the exact inequalities found no rest")

    return on_root(MPI.COMM_WORLD, solve)


def exact_answers(
    scene: Scene, body: Callable[[MPI.Comm], Body], starts: Iterable[Start]
) -> list[ExactAnswer]:
    """All answers that some statuses lead to, none twice; as above."""

    def solve() -> list[ExactAnswer]:
        problem = _Inequalities(scene, body(MPI.COMM_SELF))
        answers: list[ExactAnswer] = []
        for start in starts:
            found = problem.solve(start)
            if found is None or any(np.array_equal(found.status, a.status) for a in answers):
                continue
            answers.append(found)
        return answers

    return on_root(MPI.COMM_WORLD, solve)


def _all_stick(coordinates: Array) -> Integers:
    return np.full(len(coordinates), STICK)


def _all_along(coordinates: Array) -> Integers:
    return np.full(len(coordinates), ALONG)


def _all_back(coordinates: Array) -> Integers:
    return np.full(len(coordinates), BACK)


def statuses_of(result: Result) -> Start:
    """To begin with those that the program found."""
    points = result.points
    assert points is not None
    along = np.einsum("ij,ij->i", points.slip, turned(points.normals))
    found = np.where(along < 0, BACK, ALONG)
    found[points.status == "STICK"] = STICK
    found[points.status == "OPEN"] = OPEN
    return lambda coordinates: found


def turned(normals: Array) -> Array:
    """Unit vectors along the surface: normals turned by a right angle, (points, 3)."""
    return np.stack([-normals[:, 1], normals[:, 0], 0 * normals[:, 0]], axis=1)


class _Inequalities:
    """A discrete problem of contact with one obstacle."""

    def __init__(self, scene: Scene, body: Body) -> None:
        problem = Problem.on_mesh(scene, body)
        (contact,) = problem.contacts
        trace = contact.trace
        self.order = np.lexsort(np.round(trace.coordinates.T[1::-1] / trace.extent(), 9))
        self.coordinates = trace.coordinates[self.order, :2]
        self.normals = trace.normals[self.order]
        self.weights = trace.weights[self.order]
        kinematics = contact.kinematics
        self.gap = (kinematics.gap - kinematics.indentation)[self.order]
        self.coefficient = float(scene.contact[0].friction_coefficient)  # type: ignore[arg-type]
        self._assemble(problem, trace.nodes[self.order])

    def _assemble(self, problem: Problem, nodes: NDArray[Any]) -> None:
        """Stiffness on the free displacements, and jumps at the points as rows on these."""
        matrix = fem_petsc.assemble_matrix(problem.elastic.stiffness)
        matrix.assemble()
        rows, columns, values = matrix.getValuesCSR()
        size = matrix.getSize()[0]
        stiffness = sparse.csr_matrix((values, columns, rows), shape=(size, size))
        matrix.destroy()
        free = np.setdiff1d(np.arange(size), problem.constrained)
        held = np.zeros(size)
        held[problem.constrained] = problem.prescribed
        self.stiffness = stiffness[free][:, free]
        self.load = (problem.load.reshape(-1) - stiffness @ held)[free]
        points = np.arange(len(nodes))
        across, along = (
            sparse.csr_matrix(
                (
                    directions[:, :2].reshape(-1),
                    (np.repeat(points, 2), (2 * nodes[:, None] + [0, 1]).reshape(-1)),
                ),
                shape=(len(nodes), size),
            )
            for directions in (self.normals, turned(self.normals))
        )
        self.across, self.along = across[:, free], along[:, free]
        self.held_across, self.held_along = across @ held, along @ held
        # Points that supports hold are theirs.
        self.touchable = np.asarray(abs(self.across).sum(axis=1)).ravel() > 1e-9
        self.touchable &= np.isfinite(self.gap)
        self.slidable = np.asarray(abs(self.along).sum(axis=1)).ravel() > 1e-9

    def solve(self, start: Start) -> ExactAnswer | None:
        """Change statuses until none breaks an inequality; None where that finds no rest."""
        status = np.array(start(self.coordinates))
        if self.coefficient == 0:
            status[status == STICK] = ALONG
        status[~self.touchable] = OPEN
        seen: set[bytes] = set()
        lots = np.random.default_rng(0)
        for _ in range(_MOST):
            found = self._with(status)
            if found is None:
                return None
            opening, slip, pressing, friction = found
            following = self._changed(status, opening, slip, pressing, friction)
            if np.array_equal(following, status):
                return ExactAnswer(
                    self.coordinates,
                    pressing / self.weights,
                    friction / self.weights,
                    self.weights,
                    status,
                )
            if status.tobytes() in seen:  # in a cycle only some change at once, drawn by lot
                drawn = lots.random(len(status)) < lots.random()
                following = np.where(drawn, following, status)
            seen.add(status.tobytes())
            status = following
        return None

    def _with(self, status: Integers) -> tuple[Array, Array, Array, Array] | None:
        """Gap, slip, normal and friction force of each point with statuses given.

        None where these leave the body free to move.
        """
        count = len(status)
        closed, sticks = status != OPEN, (status == STICK) & self.slidable
        slips = closed & ~sticks & self.slidable
        # Rows: balance; u_n = s or λ = 0; u_t = 0 or τ = −sign μ λ.
        pick = sparse.diags
        gap = np.where(closed, self.gap - self.held_across, 0.0)
        matrix = sparse.bmat(
            [
                [self.stiffness, self.across.T, -self.along.T],
                [pick(closed.astype(float)) @ self.across, pick((~closed).astype(float)), None],
                [
                    pick(sticks.astype(float)) @ self.along,
                    pick(np.where(slips, self.coefficient * status, 0.0)),
                    pick((~sticks).astype(float)),
                ],
            ],
            format="csc",
        )
        right = np.concatenate([self.load, gap, np.where(sticks, -self.held_along, 0.0)])
        try:
            found = splu(matrix).solve(right)
        except RuntimeError:  # singular
            return None
        displacement = found[: -2 * count]
        opening = self.gap - self.across @ displacement - self.held_across
        slip = self.along @ displacement + self.held_along
        return opening, slip, found[-2 * count : -count], found[-count:]

    def _changed(
        self, status: Integers, opening: Array, slip: Array, pressing: Array, friction: Array
    ) -> Integers:
        """Statuses that mend what breaks an inequality."""
        force = _ROUND_OFF * max(np.abs(pressing).max(), np.abs(friction).max(), 1e-300)
        length = _ROUND_OFF * max(np.abs(slip).max(), np.abs(opening[self.touchable]).max(), 1e-300)
        closed, sticks = status != OPEN, status == STICK
        following = status.copy()
        if self.coefficient > 0:
            too_much = sticks & (np.abs(friction) > self.coefficient * pressing + force)
            following[too_much] = np.where(friction > 0, BACK, ALONG)[too_much]
            backwards = closed & ~sticks & (status * slip < -length)
            following[backwards] = STICK
        following[closed & (pressing < -force)] = OPEN
        entered = self.touchable & ~closed & (opening < -length)
        following[entered] = STICK if self.coefficient > 0 else ALONG
        return following
