"""The outer loop of finite strains: Newton's method on the body, the contacts solved within.

A step of it factorises the tangent of the body once, whatever contact does. It is cut where cells
would turn inside out, or where the imbalance does not fall as the step promises: along the step the
contact forces go from the last ones to the new ones, so that the imbalance is
M(α) = |DΨ(u + α δ) − f − (1 − α) r_old − α r_new|, with the slope −M(0) at first. That of the
forces which the laws have on the way tells nothing: these are rigid.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.finite.contact_passes import ContactPasses
from fenics_contact.solve.finite.tangent_body import TangentBody
from fenics_contact.solve.systems.contact_dofs import ContactDofs

logger = logging.getLogger(__name__)

# Steps of the outer loop; three to five are usual, ten after a turn by a right angle.
_MOST = 16
# Volume over that undeformed below which a step is cut, and the shortest step.
_LEAST_VOLUME, _SHORTEST = 0.02, 1 / 64
# Of the imbalance: what a step of length α is to take off, over α; and the shortest that is looked
# at for it.
_FALLS_BY, _LEAST_CUT = 0.25, 0.1
# Share of the forces that each pass on the contacts may leave, beside the scene's tolerance.
_OF_TOLERANCE = 0.01
# A step that leaves no more than this of the imbalance keeps the factor for the next one.
_CHORD = 0.03
# Share of the forces above which no imbalance is taken for round-off.
_LARGEST_FLOOR = 1e-6
# Imbalance over the forces from which steps lead away.
_DIVERGED = 1e6


@dataclass(frozen=True)
class NestedAnswer:
    """How the outer loop ended.

    Attributes:
        limit: Imbalance of the forces on the body that counts as none (force).
        history: The imbalance after each step (force).
        unstable_motions: How many motions grow by themselves at the answer; None where not known.
        way: How it was found, in words.
    """

    limit: float
    history: tuple[float, ...]
    unstable_motions: int | None
    way: str = "exact laws in the deformed geometry, within each step on the body"


class NestedSolver:
    """Solves a load step in finite strains from the present displacement.

    Attributes:
        factorisations: How often the body was factorised so far.
        forces: What an imbalance is small against: loads, contacts and reactions (force).

    Args:
        problem: The model.
        dofs: The contact dofs.
        timings: Seconds so far.
    """

    def __init__(self, problem: Problem, dofs: ContactDofs, timings: Timings) -> None:
        assert isinstance(problem.elastic, HyperelasticBody)
        self._problem, self._dofs, self._timings = problem, dofs, timings
        self._elastic = problem.elastic
        self._passes = ContactPasses(problem, dofs)
        self._body: TangentBody | None = None
        self.factorisations, self.forces = 0, 0.0

    def solve(self, require_going_on: Callable[[], None]) -> NestedAnswer:
        """Take the problem to the answer at its present time; collective.

        Args:
            require_going_on: Called before each step; raises where somebody asked to stop.

        Raises:
            NotConvergedError: There is none, or it is not found.
        """
        u, acting = self._displacement(), self._passes.forces()
        history: list[float] = []
        self._forget_body()
        for number in range(_MOST):
            require_going_on()
            supported = self._supported(u)
            needed = self._elastic.forces_at(u)
            left = self._problem.load - needed
            if not self._keeps_factor(history):
                self._factorise(u)
            assert self._body is not None
            condensed = self._body.condense(left, supported)
            parts = self._body.schur, condensed, u + supported
            change, found = self._passes.solve(*parts, _OF_TOLERANCE * self._tolerance)
            step = self._body.expand(change)
            alpha = self._longest(u, step)
            if number and not supported.any():
                alpha = self._searched(u, step, acting, found, alpha)
            u = u + alpha * step
            acting = acting + alpha * (found - acting)
            history.append(self._imbalance(u, acting))
            logger.debug(
                "  step %d on the body: imbalance %.1e of %.3g, length %g, %d passes on contacts",
                *(number + 1, history[-1], self.forces, alpha, self._passes.count),
            )
            allowed = self._allowed(u)
            if alpha == 1 and history[-1] <= allowed:
                falling = self._unstable_motions()
                return NestedAnswer(allowed, tuple(history), falling)
            if not history[-1] <= _DIVERGED * self.forces:
                break
        raise NotConvergedError(
            f"the force imbalance is {history[-1]:.1e} of {self.forces:.3g} after {len(history)} "
            "steps on the deformed body: does it snap through, or fold in a corner?",
            tuple(history),
        )

    def _unstable_motions(self) -> int | None:
        """Motions that grow by themselves, by the last tangent; collective."""
        assert self._body is not None
        inside = self._body.negative_eigenvalues()
        on_contacts = self._passes.unstable_motions(self._body.schur)
        return None if inside is None else inside + on_contacts

    def _displacement(self) -> Array:
        """Present displacement at the nodes of this rank, (nodes, components) (length)."""
        return np.array(self._problem.displacement.x.array).reshape(self._problem.load.shape)

    def _supported(self, u: Array) -> Array:
        """How far supports have yet to move, 0 elsewhere, (nodes, components) (length)."""
        found = np.zeros(u.size)
        held = self._problem.constrained
        found[held] = self._problem.prescribed - u.reshape(-1)[held]
        return found.reshape(u.shape)

    @property
    def _tolerance(self) -> float:
        return self._problem.scene.solver.tolerance

    def _allowed(self, u: Array) -> float:
        """Imbalance that counts as none: of the forces, or of round-off; collective (force)."""
        assert self._body is not None
        floor = min(self._body.round_off(u), _LARGEST_FLOOR * self.forces)
        return max(self._tolerance * self.forces, floor)

    def _keeps_factor(self, history: list[float]) -> bool:
        """Whether the last factor serves the next step, too: what it left is little."""
        if self._body is None or len(history) < 2:
            return False
        return history[-1] <= _CHORD * history[-2]

    def _factorise(self, u: Array) -> None:
        """The tangent about a displacement; collective."""
        self._forget_body()
        self._problem.displacement.x.array[:] = u.reshape(-1)
        with self._timings.phase("factorise"):
            self._body = TangentBody(self._problem, self._dofs)
        self.factorisations += 1

    def _forget_body(self) -> None:
        if self._body is not None:
            self._body.destroy()
        self._body = None

    def _longest(self, u: Array, step: Array) -> float:
        """The longest share of a step in which no cell turns inside out; collective.

        Raises:
            NotConvergedError: It is too short.
        """
        alpha = 1.0
        while self._elastic.volume_ratio_at(u + alpha * step) <= _LEAST_VOLUME:
            alpha /= 2
            if alpha < _SHORTEST:
                raise NotConvergedError("cells turn inside out: the load step is too long", ())
        return alpha

    def _searched(self, u: Array, step: Array, acting: Array, found: Array, alpha: float) -> float:
        """The share of a step that takes enough off the imbalance; collective."""

        def imbalance(share: float) -> float:
            forces = acting + share * (found - acting)
            left = self._free(self._elastic.forces_at(u + share * step) - self._problem.load)
            left -= self._free(forces)
            return float(np.sqrt(total(self._problem.comm, float(np.sum(left**2)))))

        before, tried = imbalance(0.0), list[tuple[float, float]]()
        while True:
            tried.append((imbalance(alpha), alpha))
            if tried[-1][0] <= (1 - _FALLS_BY * alpha) * before or alpha < _LEAST_CUT:
                break
            alpha /= 2
        return min(tried)[1]

    def _free(self, nodal: Array) -> Array:
        """Forces at the nodes of this rank that no support takes, (own nodes, components)."""
        own = slice(self._problem.spaces.owned_nodes)
        return np.where(self._problem.free, nodal, 0.0)[own]

    def _size(self, nodal: Array) -> float:
        """1-norm of forces at the nodes; collective."""
        own = slice(self._problem.spaces.owned_nodes)
        return float(total(self._problem.comm, float(np.abs(nodal[own]).sum())))

    def _imbalance(self, u: Array, acting: Array) -> float:
        """1-norm of what no support takes, and all forces by the way; collective (force)."""
        needed = self._elastic.forces_at(u)
        left = needed - self._problem.load - acting
        parts = self._problem.load, acting, np.where(self._problem.free, 0.0, left)
        self.forces = sum(self._size(part) for part in parts)
        return self._size(np.where(self._problem.free, left, 0.0))

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._forget_body()
