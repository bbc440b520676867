"""The compiled forms of friction with a bound: j_ε of the jump, its residual and its tangent."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import Form as CompiledForm
from ufl import Form
from ufl.core.expr import Expr

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.energies import (
    coulomb_residual,
    friction_energy,
    primal_dual_residual,
    traction_work,
)
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.tangent import TangentState
from fenics_contact.contact.surface.point_rule import TraceFunction


class FrictionForms:
    """Forms on a contact surface, each compiled when it is first asked for.

    What changes is a constant or a function, so that nothing is compiled again. They have the
    law's numbers of the last ``update``.

    Attributes:
        bound: g (stress).
        accepted: The slip that counts as none; None where that is no slip at all (length).
        epsilon: ε (length).
        factor: Of the bound that follows the pressure.

    Args:
        law: The friction law.
        tangent: The state that the tangent is at.
    """

    def __init__(self, law: FrictionLaw, tangent: TangentState) -> None:
        trace = law.site.trace
        self._law, self._rule, self._state, self._trace = law, law.rule, tangent, trace
        self._jump = law.site.kinematics.jump
        self._set: dict[TraceFunction, Array] = {}
        self.bound = trace.function(np.zeros(len(trace.weights)))
        self.accepted = trace.function(np.zeros_like(trace.normals)) if law.follows_path else None
        self.epsilon = fem.Constant(trace.surface.mesh, 1.0)
        self.factor = fem.Constant(trace.surface.mesh, 1.0)
        self.update()

    def update(self, share: float = 1.0) -> None:
        """Take the law's present numbers; collective.

        Args:
            share: Of the coefficient that is used.
        """
        self.epsilon.value = self._law.regularisation.parameter
        self.factor.value = share * self._law.factor
        self._take(self.bound, self._law.bound)
        if self.accepted is not None:
            self._take(self.accepted, self._law.reference)

    def _take(self, function: TraceFunction, values: Array) -> None:
        """Set a function, unless it has these values already: laws exchange arrays as a whole."""
        if self._set.get(function) is not values:
            function.set(values)
            self._set[function] = values

    @property
    def _slipped(self) -> Expr:
        """The jump that counts, in UFL (length)."""
        return self._jump if self.accepted is None else self._jump - self.accepted.ufl

    @cached_property
    def _test(self) -> Expr:
        return ufl.TestFunction(self._trace.surface.space)

    @cached_property
    def _scaling(self) -> Callable[[Expr], Expr]:
        """M, by which friction scales slip, in UFL."""
        return self._rule.metric.in_ufl(self._trace)

    @cached_property
    def energy(self) -> Form:
        """j_ε as a UFL form."""
        trace = self._trace
        return friction_energy(
            self._slipped,
            trace.normal,
            self.bound.ufl,
            self.epsilon,
            trace.weight,
            trace.measure,
            self._scaling,
        )

    @cached_property
    def _modified(self) -> Form:
        """The virtual work whose derivative is the primal-dual tangent."""
        trace = self._trace
        return primal_dual_residual(
            self._slipped,
            self._test,
            trace.normal,
            self.bound.ufl,
            self.epsilon,
            self._state.direction.ufl,
            self._state.length.ufl,
            trace.weight,
            trace.measure,
            self._scaling,
        )

    @cached_property
    def residual(self) -> CompiledForm:
        """First derivative of j_ε."""
        return form_cache.form(ufl.derivative(self.energy, self._jump))

    @cached_property
    def tangent(self) -> CompiledForm:
        """The primal-dual tangent."""
        return form_cache.form(ufl.derivative(self._modified, self._jump))

    @cached_property
    def coupling(self) -> CompiledForm:
        """Derivative of the bound in the jump by the pressure, the direction held."""
        trace, rule = self._trace, self._rule
        residual = coulomb_residual(
            self._test,
            trace.normal,
            self.factor * rule.in_ufl(rule.normal.pressure_ufl(self._jump)),
            self._state.direction.ufl,
            trace.weight,
            trace.measure,
            self._scaling,
        )
        return form_cache.form(ufl.derivative(residual, self._jump))

    @cached_property
    def springs(self) -> CompiledForm:
        """∫ g/ε w_T · v_T."""
        return form_cache.form(self._modified)

    @cached_property
    def tractions(self) -> tuple[TraceFunction, CompiledForm]:
        """Tractions at the points and ∫ τ · v_T."""
        trace = self._trace
        function = trace.function(np.zeros_like(trace.normals))
        work = traction_work(function.ufl, self._test, trace.normal, trace.weight, trace.measure)
        return function, form_cache.form(work)
