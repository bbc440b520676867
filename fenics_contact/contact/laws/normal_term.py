"""The energy across one contact, compiled: penalty, foundation or glue.

It is derived in the jump (the displacement relative to what stands opposite), a function of a
space on the surface; its forces on the body are minus the residual.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.common import form_cache
from fenics_contact.contact.laws.normal_contact import (
    bonded_energy,
    penetration_energy,
    prescribed_pressure_energy,
)
from fenics_contact.contact.surface.trace import Trace

Array = NDArray[np.float64]


class NormalTerm:
    """½ ∫ k ((w_n − s)₊)², or ½ ∫ k |w|² where the contact is bonded.

    Attributes:
        name: What is modelled, in words.
        residual: First derivative in the jump, compiled.
        tangent: Second derivative, compiled.
    """

    def __init__(
        self, name: str, trace: Trace, jump: Any, gap: Array, stiffness: Array, bonded: bool
    ) -> None:
        self.name = name
        self._stiffness = stiffness
        self._softness = fem.Constant(trace.surface.mesh, 1.0)
        self._trace = trace
        self._bonded = bonded
        self._held: Array | None = None
        weight, measure = trace.weight, trace.measure
        self.stiffness_ufl = trace.coefficient(stiffness) / self._softness
        # Where no obstacle stands, a gap that nothing closes.
        self._far = 1e3 * trace.extent()
        self._gap = trace.function(np.zeros(len(gap)))
        self.gap_ufl = self._gap.ufl
        self.set_gap(gap)
        if self._bonded:
            energy = bonded_energy(jump, self.stiffness_ufl, weight, measure)
        else:
            energy = penetration_energy(
                jump, trace.normal, self.gap_ufl, self.stiffness_ufl, weight, measure
            )
        residual = ufl.derivative(energy, jump)
        self.residual = form_cache.form(residual)
        self.tangent = form_cache.form(ufl.derivative(residual, jump))

    @property
    def stiffness(self) -> Array:
        """Stiffness k at the contact points (stress/length)."""
        return self._stiffness / float(self._softness.value)

    def soften(self, factor: float) -> None:
        """Divide k by a factor, from now on."""
        self._softness.value = factor

    @property
    def forms(self) -> tuple[Any, ...]:
        """All compiled forms."""
        return (self.residual, self.tangent)

    @property
    def tangents(self) -> tuple[Any, ...]:
        """Forms of the tangent in the present mode."""
        return (self.tangent,) if self._held is None else ()

    @cached_property
    def _pressures(self) -> tuple[Any, Any]:
        """Pressures at the points and −∫ p v_n, compiled when asked."""
        trace = self._trace
        function = trace.function(np.zeros(len(self.stiffness)))
        test = ufl.TestFunction(trace.surface.space)
        work = prescribed_pressure_energy(
            test, trace.normal, function.ufl, trace.weight, trace.measure
        )
        return function, form_cache.form(-work)

    def set_gap(self, gap: Array) -> None:
        """Follow an obstacle that moves along the surface."""
        finite = np.isfinite(gap)
        self._gap.set(np.where(finite, gap, self._far))

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        if self._held is not None:
            return self._held
        return -self._trace.surface.assemble(self.residual)

    def hold(self, pressure: Array) -> None:
        """Press with a given pressure from now on, whatever the jump; collective.

        Args:
            pressure: At the points, shape (points,) (stress).
        """
        function, work = self._pressures
        function.set(pressure)
        self._held = self._trace.surface.assemble(work)

    def release(self) -> None:
        """Follow the jump again."""
        self._held = None

    def pressure(self, depth: Array) -> Array:
        """Contact pressure of a depth w_n − s at the points; of w_n where bonded (stress)."""
        reached = np.where(np.isfinite(depth), depth, 0.0)
        return self.stiffness * (reached if self._bonded else np.maximum(reached, 0.0))

    def energy_density(self, jump: Array, depth: Array) -> Array:
        """½ k |w|² or ½ k ((w_n − s)₊)² at the points (energy/area)."""
        if self._bonded:
            return np.asarray(0.5 * self.stiffness * np.einsum("ij,ij->i", jump, jump))
        return 0.5 * self.pressure(depth) * np.where(np.isfinite(depth), depth, 0.0)
