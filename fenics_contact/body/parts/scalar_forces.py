"""Forces between a scalar q of the body's energy W(u, s, q) and u, a mean stress s.

The bulk is linear, so that second derivatives of W say all: ∂²W/∂u∂q are the forces of a unit of q,
and with ∂²W/∂q² they make the force ∂W/∂q that does work on q.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces, summed_over_ranks
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total


@dataclass(frozen=True, eq=False)
class ScalarForces:
    """Second derivatives of the body's energy in a scalar q.

    Attributes:
        spaces: Those of the body.
        present: The present q, a constant in UFL (length).
        nodal: Forces on the displacements over q, ∂²W/∂u∂q, (nodes, components) (force/length).
        on_mean_stress: ∂²W/∂s∂q of the mean stress s, at its dofs of this rank (area); empty
            without one.
        owned_stresses: How many of these dofs this rank owns.
        stiffness: ∂²W/∂q² (force/length).
    """

    spaces: Spaces
    present: fem.Constant
    nodal: Array
    on_mean_stress: Array
    owned_stresses: int
    stiffness: float

    @classmethod
    def of(
        cls,
        spaces: Spaces,
        present: fem.Constant,
        energy: tuple[Expr, ufl.Measure, Expr],
        displacement: fem.Function,
        mean_stress: fem.Function | None,
    ) -> ScalarForces:
        """From the energy; collective.

        Args:
            spaces: Those of the body.
            present: The present q.
            energy: Its density, weighted, the measure, and q in the density, a UFL variable.
            displacement: u in it.
            mean_stress: s in it, or None.
        """
        density, measure, scalar = energy
        force = ufl.diff(density, scalar) * measure
        stiffness = ufl.diff(ufl.diff(density, scalar), scalar) * measure
        nodal = spaces.assemble(form_cache.form(ufl.derivative(force, displacement)))
        on_mean_stress, owned = np.zeros(0), 0
        if mean_stress is not None:
            found = fem.assemble_vector(form_cache.form(ufl.derivative(force, mean_stress)))
            index_map = mean_stress.function_space.dofmap.index_map
            on_mean_stress = summed_over_ranks(index_map, np.array(found.array))
            owned = index_map.size_local
        own = float(total(spaces.comm, fem.assemble_scalar(form_cache.form(stiffness))))
        return cls(spaces, present, nodal, on_mean_stress, owned, own)

    def force(self, displacement: Array, mean_stress: Array) -> float:
        """∂W/∂q at the present q (force); collective.

        Args:
            displacement: Of this rank's nodes, (nodes, components) (length).
            mean_stress: At the dofs of this rank; empty without one (stress).
        """
        owned, nodes = self.owned_stresses, slice(0, self.spaces.owned_nodes)
        own = float(np.sum(self.nodal[nodes] * displacement[nodes]))
        own += float(self.on_mean_stress[:owned] @ mean_stress[:owned])
        return float(total(self.spaces.comm, own)) + self.stiffness * float(self.present.value)
