"""The friction of one contact, compiled: j_ε of the jump, with its primal-dual tangent."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.common import form_cache
from fenics_contact.contact.laws.energies import (
    coulomb_residual,
    friction_energy,
    primal_dual_residual,
    traction_work,
)
from fenics_contact.contact.laws.normal_term import NormalTerm
from fenics_contact.contact.surface.trace import Trace

Array = NDArray[np.float64]

# Of g / |u_T|: what tangents keep along the slip. A body of which all points slip, under loads just
# below those that friction can hold, would be moved so far by a Newton step that rounding ends it.
_LEFT_STIFF = 1e-10


class FrictionTerm:
    """j_ε (paper, (2.7)) with its primal-dual tangent.

    Attributes:
        name: What is modelled, in words.
        energy: j_ε as a UFL form.
        residual: Its first derivative, compiled.
        tangent: The primal-dual tangent, compiled.
        bound: g at the points (stress).
        regularisation_parameter: ε (length).
        mode: What it does in a solve: ``law`` follows the friction law; ``coupled`` does so
            and lets the tangent know that the bound follows the pressure; ``status`` has
            springs g/ε on points that stick and held tractions on those that slip (paper,
            Step 3); ``held`` keeps tractions on all points (Step 4); ``off`` does nothing.

    Args:
        name: What is modelled, in words.
        trace: The contact points.
        jump: The jump, a dolfinx function.
        coefficient: Friction coefficient at the points.
        normal: The term across the contact that makes the pressure; None if that is given.
        incremental: Whether slip counts from the last accepted step, not from the start.
    """

    def __init__(
        self,
        name: str,
        trace: Trace,
        jump: Any,
        coefficient: Array,
        normal: NormalTerm | None,
        incremental: bool,
    ) -> None:
        self.name = name
        self.mode: Literal["law", "coupled", "status", "held", "off"] = "law"
        self._trace, self._jump, self._normal = trace, jump, normal
        self._coefficient = coefficient
        surface = trace.surface
        count = len(trace.weights)
        self._reference = np.zeros((count, surface.components))
        self._accepted = trace.function(self._reference) if incremental else None
        slipped = jump if self._accepted is None else jump - self._accepted.ufl
        self.bound = np.zeros(count)
        self._bound = trace.function(self.bound)
        self._epsilon = fem.Constant(surface.mesh, 1.0)
        self._chosen, self._left = 1.0, 1.0
        self._share = fem.Constant(surface.mesh, 1.0)
        self._slip = np.zeros_like(self._reference)
        self._dual = np.zeros_like(self._reference)
        self._direction = trace.function(self._dual)
        # Not 0 anywhere: it divides, also where the weight is 0.
        self._length = trace.function(np.ones(count), empty=1.0)
        self._test = ufl.TestFunction(surface.space)
        self.energy = friction_energy(
            slipped, trace.normal, self._bound.ufl, self._epsilon, trace.weight, trace.measure
        )
        self._modified = primal_dual_residual(
            slipped,
            self._test,
            trace.normal,
            self._bound.ufl,
            self._epsilon,
            self._direction.ufl,
            self._length.ufl,
            trace.weight,
            trace.measure,
        )
        self.stick_all()
        self.residual = form_cache.form(ufl.derivative(self.energy, jump))
        self.tangent = form_cache.form(ufl.derivative(self._modified, jump))

    @property
    def forms(self) -> tuple[Any, ...]:
        """The compiled forms that every solve needs."""
        return (self.residual, self.tangent)

    @property
    def tangents(self) -> tuple[Any, ...]:
        """Forms of the tangent in the present mode."""
        if self.mode == "coupled":
            return (self.tangent, self._coupling)
        return (self.tangent,) if self.mode in ("law", "status") else ()

    @cached_property
    def _coupling(self) -> Any:
        """Derivative of the bound μ p in the jump, the direction held; compiled when asked."""
        assert self._normal is not None
        trace = self._trace
        residual = coulomb_residual(
            self._jump,
            self._test,
            trace.normal,
            self._normal.gap_ufl,
            self._normal.stiffness_ufl,
            self._share * trace.coefficient(self._coefficient),
            self._direction.ufl,
            trace.weight,
            trace.measure,
        )
        return form_cache.form(ufl.derivative(residual, self._jump))

    @cached_property
    def _springs(self) -> Any:
        """∫ g/ε w_T · v_T, compiled when asked."""
        return form_cache.form(self._modified)

    @cached_property
    def _tractions(self) -> tuple[Any, Any]:
        """Tractions at the points and ∫ τ · v_T, compiled when asked."""
        trace = self._trace
        function = trace.function(np.zeros_like(self._slip))
        work = traction_work(function.ufl, self._test, trace.normal, trace.weight, trace.measure)
        return function, form_cache.form(work)

    @property
    def regularisation_parameter(self) -> float:
        """ε as used (length)."""
        return float(self._epsilon.value)

    @regularisation_parameter.setter
    def regularisation_parameter(self, epsilon: float) -> None:
        self._chosen = epsilon
        self._epsilon.value = epsilon * self._left

    @property
    def chosen_parameter(self) -> float:
        """The ε that was set, of which a part may be used (length)."""
        return self._chosen

    def regularise_less(self, left: float) -> None:
        """Use this part of every ε that is set, from now on."""
        self._left = left
        self.regularisation_parameter = self._chosen

    def set_bound(self, bound: Array) -> None:
        """Set g at the points (stress)."""
        self.bound = bound
        self._bound.set(bound)

    def set_share(self, share: float) -> None:
        """Use this share of the coefficient, from below or above 1, on the way to all of it."""
        self._share.value = share

    def bound_of(self, pressure: Array) -> Array:
        """μ p at the points (stress)."""
        return float(self._share.value) * self._coefficient * pressure

    def hold(self, traction: Array) -> None:
        """Set the tractions of the modes ``held`` and ``status``, (points, components)."""
        self._tractions[0].set(traction)

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        assemble = self._trace.surface.assemble
        if self.mode == "off":
            return np.zeros((len(self._trace.all_nodes), self._slip.shape[1]))
        if self.mode == "held":
            return assemble(self._tractions[1])
        if self.mode == "status":
            return assemble(self._tractions[1]) - assemble(self._springs)
        return -assemble(self.residual)

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""
        self._slip = np.zeros_like(self._slip)
        self._dual = np.zeros_like(self._slip)
        self._set_tangent_state()

    def slip_all(self, slip: Array) -> None:
        """Set the tangent to points that have slipped.

        Args:
            slip: As the law counts it, nowhere 0, (points, components) (length).
        """
        self._slip = slip
        self._dual = slip / np.linalg.norm(slip, axis=1)[:, None]
        self._set_tangent_state()

    def follow(self, slip: Array) -> None:
        """Move the tangent to a new state: q by its own linearised equation, |q| ≤ 1.

        Args:
            slip: w_T since the start at the points, shape (points, components) (length).
        """
        if self.mode not in ("law", "coupled"):
            return
        slip = slip - self._reference
        lengths, directions = self._lengths_and_directions()
        lengthening = np.einsum("ij,ij->i", directions, slip - self._slip)
        dual = (slip - self._dual * lengthening[:, None]) / lengths[:, None]
        self._dual = dual / np.maximum(np.linalg.norm(dual, axis=1), 1.0)[:, None]
        self._slip = slip
        self._set_tangent_state()

    def accept(self, slip: Array) -> None:
        """A load step is done: from now on slip counts from here, if the law is incremental."""
        if self._accepted is not None:
            self._reference = slip
            self._accepted.set(slip)

    @property
    def reference(self) -> Array:
        """The slip that counts as none, at the points, (points, components) (length)."""
        return self._reference

    def recall(self, reference: Array, bound: Array) -> None:
        """Follow the law as after a load step, whatever has been tried since.

        Args:
            reference: As ``reference``.
            bound: g at the points (stress).
        """
        self.mode = "law"
        self.set_share(1.0)
        self.set_bound(bound)
        self.accept(reference)

    def counted(self, slip: Array) -> Array:
        """The slip that the law sees: since the start, or since the last accepted step."""
        return slip - self._reference

    def set_status(self, sticks: NDArray[np.bool_], directions: Array, bound: Array) -> None:
        """Springs g/ε on points that stick, tractions −g × direction on those that slip."""
        self.mode = "status"
        self.set_bound(np.where(sticks, bound, 0.0))
        self.hold(np.where(sticks, 0.0, -bound)[:, None] * directions)
        self.stick_all()

    def glue(self, stiffness: float, points: NDArray[np.bool_]) -> None:
        """Springs along the surface at some points (stress/length), whatever the pressure."""
        bound = np.where(points, stiffness * self.regularisation_parameter, 0.0)
        self.set_status(np.ones(len(bound), dtype=bool), np.zeros_like(self._slip), bound)

    def traction(self, slip: Array) -> Array:
        """−g φ_ε′ at the points for a slip since the start (paper, (2.8)) (stress)."""
        slip = self.counted(slip)
        length = np.maximum(np.linalg.norm(slip, axis=1), self.regularisation_parameter)
        return -(self.bound / length)[:, None] * slip + 0.0  # no −0

    def _lengths_and_directions(self) -> tuple[Array, Array]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size = np.linalg.norm(self._slip, axis=1)
        slips = size > self.regularisation_parameter
        directions = np.where(slips[:, None], self._slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, self.regularisation_parameter), directions

    def _set_tangent_state(self) -> None:
        self._direction.set((1 - _LEFT_STIFF) * self._dual)
        self._length.set(self._lengths_and_directions()[0])
