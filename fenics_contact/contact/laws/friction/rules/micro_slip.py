"""Friction with micro-slip: surfaces that give way along each other before they slide."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.friction.rules.coulomb import Coulomb
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.laws.friction_laws import MicroSlipFriction
from fenics_contact.scene.values import Value


class MicroSlip(Coulomb):
    """t = μ p s_e/l, |s_e| ≤ l: the paper's φ_ε with a length l of the surfaces in place of ε.

    J. T. Oden, E. B. Pires, J. Appl. Mech. 50 (1983) 67-76. The slip is an elastic part s_e, which
    goes back, and what is beyond l, which does not. By the incremental law each load step goes on
    from the elastic part that the steps before have left. Points that open lose it.
    """

    kind: ClassVar[str] = "micro-slip"
    is_proportional: ClassVar[bool] = False
    state: ClassVar[tuple[PointArray, ...]] = (
        PointArray("elastic_slip", "length", is_vector=True),
    )

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        given = site.contact.friction_law
        assert isinstance(given, MicroSlipFriction)
        self.longest_elastic_slip = self._longest = given.elastic_slip
        self._carried = np.zeros_like(site.trace.normals)

    @property
    def is_linear(self) -> bool:
        """The bound is μ p."""
        return True

    @property
    def carried_slip(self) -> Array:
        """The elastic slip at the end of the load step before."""
        return self._carried

    def elastic(self, slip: Array) -> Array:
        """The elastic part of a slip: along it, and no longer than l."""
        size = np.linalg.norm(slip, axis=1)
        return np.asarray(slip * (self._longest / np.maximum(size, self._longest))[:, None])

    def at_step_end(self, slip: Array, closed: Flags) -> dict[str, Array]:
        """The elastic slip of points that touch."""
        return {"elastic_slip": np.where(closed[:, None], self.elastic(slip), 0.0)}

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Transposed derivative of ``at_step_end``, in the slip and in its longest part l."""
        of_elastic = np.where(closed[:, None], of_end["elastic_slip"], 0.0)
        size = np.linalg.norm(slip, axis=1)
        slides = size > self._longest
        along = np.where(slides[:, None], slip / np.where(slides, size, 1.0)[:, None], 0.0)
        of_longest = np.einsum("ij,ij->i", of_elastic, along)
        of_slip = of_elastic - of_longest[:, None] * along
        of_slip *= (self._longest / np.maximum(size, self._longest))[:, None]
        return of_slip, {"regularisation_parameter": of_longest}

    def vjp_carried_slip(self, of_carried: Array) -> Mapping[str, Array]:
        """Derivatives in the elastic slip, which is the carried slip itself."""
        return {"elastic_slip": of_carried}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of Coulomb's parameters, and of l, which stands in the place of ε."""
        if key == "friction_law.elastic_slip":
            return {"regularisation_parameter": np.ones_like(self.coefficient)}
        return super().field_slopes(key, unit)

    def take(self, kept: Mapping[str, Array]) -> None:
        """Go on from the elastic slip."""
        self._carried = kept["elastic_slip"]
