"""Masses that move in a few modes alone: what is left of the body follows as in statics.

With M-orthonormal modes V the mass matrix becomes M V Vᵀ M. So the matrix of a step has the inverse
R + V (ω² + 4/Δt²)⁻¹ Vᵀ, where R is the flexibility of the body less that of the modes: the residual
flexibility of component mode synthesis (R. H. MacNeal, Comput. Struct. 1 (1971) 581-601). All that
has no mass, contacts among it, is in balance at the end of each step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.problem.inertia.massless import ContactMasses
from fenics_contact.quantities.names import LEFT_OUT_KINETIC_ENERGY

# Vectors whose momenta are kept: those of a step, and the velocity at its begin.
_KNOWN = 4


@dataclass(frozen=True, eq=False)
class FreeModes:
    """Modes of a body that no contact touches, rigid motions first: Vᵀ M V = 1.

    Attributes:
        shapes: V at the nodes of this rank, (nodes, components, modes).
        forces: M V, likewise; 0 where supports hold.
        squares: ω² (modes,) (1/time²).
    """

    shapes: Array
    forces: Array
    squares: Array

    @property
    def rigid(self) -> int:
        """Number of rigid motions."""
        return int((self.squares == 0).sum())

    def first(self, elastic: int) -> FreeModes:
        """Rigid motions and so many of the others.

        Args:
            elastic: How many.
        """
        kept = slice(self.rigid + elastic)
        return FreeModes(self.shapes[..., kept], self.forces[..., kept], self.squares[kept])


class ModalMasses:
    """M V Vᵀ M in place of M; collective, as all its methods.

    Attributes:
        in_matrix: As of ``ContactMasses``: of few modes the matrix is that of statics.

    Args:
        masses: M.
        modes: V.
        held: What supports hold, (nodes, components).
        spaces: Of the body.
    """

    in_matrix: ClassVar = False

    def __init__(
        self, masses: ContactMasses, modes: FreeModes, held: Flags, spaces: Spaces
    ) -> None:
        self._masses, self._modes, self._held, self._spaces = masses, modes, held, spaces
        self._known: list[tuple[Array, Array]] = []  # of velocities, asked for in several places

    def with_masses(self, load: Array) -> Array:
        """A nodal load that acts where there is mass; see ``ContactMasses.with_masses``."""
        return self._masses.with_masses(load)

    def times(self, values: Array) -> Array:
        """Mass times vectors at nodes, (nodes, components)."""
        known = next((found for one, found in self._known if one is values), None)
        if known is None:
            known = self._modes.forces @ self._along(self._modes.forces, values)
            self._known = [*self._known[1 - _KNOWN :], (values, known)]
        return known

    def quantities(self, velocity: Array) -> dict[str, float]:
        """Kinetic energy of all that is not in the modes, which they take for none (energy).

        Args:
            velocity: Of the nodes, (nodes, components) (length/time).
        """
        own = slice(self._spaces.owned_nodes)
        moving = np.where(self._held, 0.0, self.split_motions(velocity)[0])
        work = np.sum(moving[own] * self._masses.times(moving)[own])
        return {LEFT_OUT_KINETIC_ENERGY: float(0.5 * total(self._spaces.comm, work))}

    def needed(self, left: Array, pressed: Array, slowed: Array) -> Array:
        """Forces needed from contacts and supports; what supports hold has no mass here.

        To supports the balance leaves twice their mean, with what presses there.
        """
        return np.where(self._held, 0.5 * (left + pressed), left)

    def split_forces(self, values: Array) -> tuple[Array, Array]:
        """Forces that nothing of mass answers, and those on modes and on supports.

        Args:
            values: (nodes, components).
        """
        inertial = self._modes.forces @ self._along(self._modes.shapes, values)
        inertial[self._held] = values[self._held]
        return values - inertial, inertial

    def split_motions(self, values: Array) -> tuple[Array, Array]:
        """Displacements or velocities of what has no mass, and those of the modes.

        Args:
            values: (nodes, components).
        """
        inertial = self._modes.shapes @ self._along(self._modes.forces, values)
        return values - inertial, inertial

    def _along(self, modes: Array, values: Array) -> Array:
        own = slice(self._spaces.owned_nodes)
        flat = modes[own].reshape(-1, modes.shape[2])
        return np.asarray(total(self._spaces.comm, values[own].reshape(-1) @ flat))
