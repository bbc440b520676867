"""A hyperelastic body: its stored energy, and what follows from it about a displacement.

Forces and stiffness are the first and second derivatives of ∫ Ψ(F). The stiffness is that of the
present ``displacement``, so that whoever factorises it says where.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.elasticity import Isotropic
from fenics_contact.body.finite.stored_energy import deformation_gradient, stored_energy
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import HeldDofs
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.scene.body import NEARLY_INCOMPRESSIBLE


@dataclass(frozen=True)
class Stretches:
    """Extreme values of a deformation at the points where energies are integrated.

    Attributes:
        volume_ratio: Least det F.
        most: Largest principal stretch in the plane.
        least: Smallest one.
    """

    volume_ratio: float
    most: float
    least: float


class HyperelasticBody(ElasticBody):
    """∫ Ψ(F) of a body in plane strain, and its forms.

    Args:
        description: Of the body; its materials name one stored energy.
        spaces: Those of the body.
        displacement: The unknown, a dolfinx function.
        held: Dofs that supports hold.

    Raises:
        InputError: A function makes the body nearly incompressible.
    """

    is_linear: ClassVar[bool] = False

    def __init__(
        self,
        description: BodyDescription,
        spaces: Spaces,
        displacement: fem.Function,
        held: HeldDofs,
    ) -> None:
        name = description.material[0].law
        assert name is not None
        self._energy_name, self._constants = name, description.material[0].constants
        super().__init__(description, spaces, displacement, held)
        if self.mixed is not None:
            raise InputError(
                'material.poissons_ratio: with strains = "finite" it is below '
                f"{NEARLY_INCOMPRESSIBLE} everywhere yet, as nearly incompressible bodies lock"
            )
        self.name = f"stored energy, {name}"
        self._stored = form_cache.form(self._energy())
        self._forces = form_cache.form(ufl.derivative(self._energy(), displacement))
        points = compat.quadrature_points(spaces.body.mesh, spaces.bulk_degree)
        self._slopes = form_cache.expression(ufl.grad(displacement), points)
        cells = spaces.body.mesh.topology.index_map(spaces.body.dimension).size_local
        self._cells = np.arange(cells, dtype=np.int32)

    def _energy(self) -> ufl.Form:
        """∫ Ψ(F) of the displacement."""
        return self._spaces.weight * self._density(self._gradient()) * self._spaces.bulk

    def _density(self, gradient: Expr) -> Expr:
        assert isinstance(self.law, Isotropic)
        return stored_energy(self._energy_name, gradient, self.law, self._constants)

    def _gradient(self, displacement: Expr | None = None) -> Expr:
        return deformation_gradient(self.displacement if displacement is None else displacement)

    def nominal_stress(self, displacement: Expr | None = None) -> Expr:
        """First Piola-Kirchhoff stress P = ∂Ψ/∂F, (3, 3): force over undeformed area.

        Args:
            displacement: Of a state; by default of the solution.
        """
        gradient = ufl.variable(self._gradient(displacement))
        return ufl.diff(self._density(gradient), gradient)

    def stress(self) -> Expr:
        """Cauchy stress P Fᵀ/J of the solution as a UFL expression, (3, 3)."""
        gradient = self._gradient()
        return self.nominal_stress() * gradient.T / ufl.det(gradient)

    @property
    def forms(self) -> tuple[fem.Form, ...]:
        """All compiled forms."""
        return (self.stiffness, self._forces, self._stored)

    def forces_at(self, displacement: Array) -> Array:
        """Internal forces ∫ P : ∇v of a displacement; collective.

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).

        Returns:
            (nodes, components) (force).
        """
        self.displacement.x.array[:] = displacement.reshape(-1)
        return self._spaces.assemble(self._forces)

    def energy_at(self, displacement: Array) -> float:
        """∫ Ψ of a displacement; collective (energy).

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
        """
        self.displacement.x.array[:] = displacement.reshape(-1)
        own = float(np.real(fem.assemble_scalar(self._stored)))
        return float(total(self._spaces.comm, own))

    def _gradients_at(self, displacement: Array) -> Array:
        """F in the plane at the points of this rank's own cells, (points, 2, 2)."""
        self.displacement.x.array[:] = displacement.reshape(-1)
        slopes = self._slopes.eval(self._spaces.body.mesh, self._cells).reshape(-1, 2, 2)
        return np.asarray(slopes + np.eye(2))

    def volume_ratio_at(self, displacement: Array) -> float:
        """Least det F of a displacement; collective.

        Cells where it is not a number count as turned inside out.

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
        """
        return self._least_volume_ratio(self._gradients_at(displacement))

    def _least_volume_ratio(self, gradients: Array) -> float:
        """Least det F of all ranks, of gradients F at the points of each; collective."""
        ratios = gradients[:, 0, 0] * gradients[:, 1, 1] - gradients[:, 0, 1] * gradients[:, 1, 0]
        return smallest(self._spaces.comm, np.where(np.isfinite(ratios), ratios, -1.0))

    def stretches_at(self, displacement: Array) -> Stretches:
        """Extreme stretches of a displacement; collective.

        Cells where it is not a number count as turned inside out.

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
        """
        comm = self._spaces.comm
        gradients = self._gradients_at(displacement)
        known = np.where(np.isfinite(gradients), gradients, 0.0)
        singular = np.linalg.svd(known, compute_uv=False)
        return Stretches(
            volume_ratio=self._least_volume_ratio(gradients),
            most=largest(comm, singular[:, 0]),
            least=smallest(comm, singular[:, 1]),
        )
