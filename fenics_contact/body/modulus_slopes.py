"""Derivatives of the stiffness in a modulus, by UFL's derivative of the elastic energy."""

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
    """ψ · K_θ u of a modulus θ of a material; collective.

    Args:
        elastic: The body, of isotropic materials.
        spaces: Those of it.
    """

    def __init__(self, elastic: ElasticBody, spaces: Spaces) -> None:
        self._elastic, self._spaces = elastic, spaces
        self._state, self._virtual = self._functions(), self._functions()
        self._forms: dict[tuple[str, str], fem.Form] = {}

    def _functions(self) -> tuple[fem.Function, fem.Function | None]:
        """Displacement, and mean stress where that is an unknown."""
        mixed = self._elastic.mixed
        stress = None if mixed is None else fem.Function(mixed.mean_stress.function_space)
        return fem.Function(self._spaces.displacement_space), stress

    def work(
        self, name: str, on: str, state: tuple[Array, Array], virtual: tuple[Array, Array]
    ) -> float:
        """This rank's part of ψ · K_θ u.

        Args:
            name: ``youngs_modulus`` or ``poissons_ratio``.
            on: Group of cells of the material, empty where it fills the body.
            state: u at the nodes of this rank, (nodes, components), and its mean stress at the dofs
                of this rank, empty without one.
            virtual: The same of ψ.
        """
        if (name, on) not in self._forms:
            self._forms[name, on] = form_cache.form(self._work(name, on))
        for functions, values in ((self._state, state), (self._virtual, virtual)):
            for function, array in zip(functions, values, strict=True):
                if function is not None:
                    function.x.array[:] = array.reshape(-1)
        return float(np.real(fem.assemble_scalar(self._forms[name, on])))

    def _work(self, name: str, on: str) -> Any:
        law, spaces = self._elastic.law, self._spaces
        assert isinstance(law, Isotropic)
        free = Isotropic(ufl.variable(law.youngs_modulus), ufl.variable(law.poissons_ratio))
        density = self._elastic.virtual_work(free, self._state, self._virtual)
        rule = {"quadrature_degree": spaces.bulk_degree}
        group = spaces.body.group(on, "material.on") if on else None
        measure = spaces.bulk if group is None else spaces.part(group, rule)
        return ufl.diff(density, getattr(free, name)) * measure
