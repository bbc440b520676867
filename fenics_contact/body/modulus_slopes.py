"""What the stiffness changes by with a modulus, by UFL's derivative of the elastic energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.elasticity import Isotropic
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array


class ModulusSlopes:
    """ψ · K_θ u of a modulus θ of a material, u being the body's present displacement; collective.

    Args:
        elastic: The body, of isotropic materials.
        spaces: Those of it.
        displacement: u.
    """

    def __init__(self, elastic: ElasticBody, spaces: Spaces, displacement: fem.Function) -> None:
        self._elastic, self._spaces = elastic, spaces
        mixed = elastic.mixed
        self._state = displacement, None if mixed is None else mixed.mean_stress
        self._virtual = fem.Function(spaces.displacement_space)
        self._virtual_stress = (
            None if mixed is None else fem.Function(mixed.mean_stress.function_space)
        )
        self._forms: dict[tuple[str, str], fem.Form] = {}

    def work(self, name: str, on: str, virtual: Array, virtual_stress: Array) -> float:
        """This rank's part of ψ · K_θ u.

        Args:
            name: ``youngs_modulus`` or ``poissons_ratio``.
            on: Group of cells of the material, empty where it fills the body.
            virtual: ψ at the nodes of this rank, (nodes, components).
            virtual_stress: Its mean stress at the dofs of this rank; empty without one.
        """
        if (name, on) not in self._forms:
            self._forms[name, on] = form_cache.form(self._work(name, on))
        self._virtual.x.array[:] = virtual.reshape(-1)
        if self._virtual_stress is not None:
            self._virtual_stress.x.array[:] = virtual_stress
        return float(np.real(fem.assemble_scalar(self._forms[name, on])))

    def _work(self, name: str, on: str) -> Any:
        law, spaces = self._elastic.law, self._spaces
        assert isinstance(law, Isotropic)
        free = Isotropic(ufl.variable(law.youngs_modulus), ufl.variable(law.poissons_ratio))
        density = self._elastic.virtual_work(
            free, self._state, (self._virtual, self._virtual_stress)
        )
        rule = {"quadrature_degree": spaces.bulk_degree}
        group = spaces.body.group(on, "material.on") if on else None
        measure = spaces.bulk if group is None else spaces.part(group, rule)
        return ufl.diff(density, getattr(free, name)) * measure
