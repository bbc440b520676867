"""The energy terms of one contact, compiled: penalty or glue across it, friction along it.

A term is derived in the jump (the displacement relative to the obstacle), a function of
the displacement space; its forces on the body are minus the residual.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.friction import friction_energy, primal_dual_residual
from fenics_contact.normal_contact import bonded_energy, penetration_energy
from fenics_contact.trace import Trace

Array = NDArray[np.float64]


class NormalTerm:
    """½ ∫ k ((w_n − s)₊)², or ½ ∫ k |w|² where the contact is bonded.

    Attributes:
        name: What is modelled, in words.
        residual: First derivative in the jump, compiled.
        tangent: Second derivative, compiled.
        stiffness: k at the contact points, 0 where nothing stands against them
            (stress/length).
    """

    def __init__(self, name: str, trace: Trace, jump: Any, gap: Array, stiffness: Array) -> None:
        self.name = name
        self.stiffness = stiffness
        self._bonded = name.startswith("bonded")
        weight, measure = trace.weight, trace.measure
        k = trace.coefficient(stiffness)
        if self._bonded:
            energy = bonded_energy(jump, k, weight, measure)
        else:
            # Where there is no obstacle k is 0, and any finite gap will do.
            s = trace.coefficient(np.where(np.isfinite(gap), gap, 0.0))
            energy = penetration_energy(jump, trace.normal, s, k, weight, measure)
        residual = ufl.derivative(energy, jump)
        self.residual = fem.form(residual)
        self.tangent = fem.form(ufl.derivative(residual, jump))

    def pressure(self, depth: Array) -> Array:
        """Contact pressure of a depth w_n − s at the points; of w_n where bonded (stress)."""
        reached = np.where(self.stiffness > 0, depth, 0.0)
        return self.stiffness * (reached if self._bonded else np.maximum(reached, 0.0))

    def energy_density(self, jump: Array, depth: Array) -> Array:
        """½ k |w|² or ½ k ((w_n − s)₊)² at the points (energy/area)."""
        if self._bonded:
            return 0.5 * self.stiffness * np.einsum("ij,ij->i", jump, jump)
        return 0.5 * self.pressure(depth) * np.where(self.stiffness > 0, depth, 0.0)


class FrictionTerm:
    """j_ε (paper, (2.7)) with its primal-dual tangent.

    Attributes:
        name: What is modelled, in words.
        energy: j_ε as a UFL form.
        residual: Its first derivative, compiled.
        tangent: The primal-dual tangent, compiled.
    """

    def __init__(
        self, name: str, trace: Trace, jump: Any, bound: Array, regularisation_parameter: float
    ) -> None:
        self.name = name
        self._bound = bound
        self._epsilon = regularisation_parameter
        spaces = trace.spaces
        g = trace.coefficient(bound)
        epsilon = fem.Constant(spaces.body.mesh, regularisation_parameter)
        self.energy = friction_energy(jump, trace.normal, g, epsilon, trace.weight, trace.measure)
        self._slip = np.zeros((len(trace.weights), spaces.components))
        self._dual = np.zeros_like(self._slip)
        self._direction = trace.function(self._dual)
        # Not 0 anywhere: it divides, also where the weight is 0.
        self._length = trace.function(np.ones(len(self._slip)), empty=1.0)
        modified = primal_dual_residual(
            jump,
            ufl.TestFunction(spaces.displacement_space),
            trace.normal,
            g,
            epsilon,
            self._direction.ufl,
            self._length.ufl,
            trace.weight,
            trace.measure,
        )
        self.stick_all()
        self.residual = fem.form(ufl.derivative(self.energy, jump))
        self.tangent = fem.form(ufl.derivative(modified, jump))

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""
        self._slip = np.zeros_like(self._slip)
        self._dual = np.zeros_like(self._slip)
        self._set_tangent_state()

    def follow(self, slip: Array) -> None:
        """Move the tangent to a new state: q by its own linearised equation, |q| ≤ 1.

        Args:
            slip: u_T at the points, shape (points, components) (length).
        """
        lengths, directions = self._lengths_and_directions()
        lengthening = np.einsum("ij,ij->i", directions, slip - self._slip)
        dual = (slip - self._dual * lengthening[:, None]) / lengths[:, None]
        self._dual = dual / np.maximum(np.linalg.norm(dual, axis=1), 1.0)[:, None]
        self._slip = slip
        self._set_tangent_state()

    def traction(self, slip: Array) -> Array:
        """−g φ_ε′(u_T) at the points (paper, (2.8)), (points, components) (stress)."""
        length = np.maximum(np.linalg.norm(slip, axis=1), self._epsilon)
        return -(self._bound / length)[:, None] * slip + 0.0  # no −0

    def _lengths_and_directions(self) -> tuple[Array, Array]:
        """max(|u_T|, ε) and its gradient, u_T/|u_T| where slipping and 0 where sticking."""
        size = np.linalg.norm(self._slip, axis=1)
        slips = size > self._epsilon
        directions = np.where(slips[:, None], self._slip / np.where(slips, size, 1.0)[:, None], 0.0)
        return np.maximum(size, self._epsilon), directions

    def _set_tangent_state(self) -> None:
        self._direction.set(self._dual)
        self._length.set(self._lengths_and_directions()[0])
