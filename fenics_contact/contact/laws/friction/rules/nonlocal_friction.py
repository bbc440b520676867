"""Nonlocal friction: the bound at a point follows the pressure around it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.rules.coulomb import Coulomb
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.scene.laws.friction_laws import NonlocalFriction
from fenics_contact.scene.values import Value


class Nonlocal(Coulomb):
    """g = μ (w_ρ ∗ p), averaged over a radius ρ along the surface (``surface/averaging``).

    G. Duvaut, C. R. Acad. Sci. Paris A 290 (1980) 263-265; J. T. Oden, E. B. Pires, J. Appl. Mech.
    50 (1983) 67-76. Only where something stands opposite; also at open points within ρ of others
    that press.
    """

    kind: ClassVar[str] = "nonlocal"
    is_proportional: ClassVar[bool] = False

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        given = site.contact.friction_law
        assert isinstance(given, NonlocalFriction)
        self.neighbours: SurfaceAverage = SurfaceAverage(site.trace, given.averaging_radius)

    @property
    def is_linear(self) -> bool:
        """Whether the bound grows in proportion with all pressures: an average does."""
        return True

    def averaged(self, pressure: Array) -> Array:
        """The pressure w_ρ ∗ p."""
        self._follow_reach()
        return self.neighbours.apply(pressure)

    def average_transposed(self, of_averaged: Array) -> Array:
        """Derivatives in the pressure at all points, by the transposed average."""
        self._follow_reach()
        return self.neighbours.transposed(of_averaged)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """A larger radius changes the averaged pressure."""
        if key != "friction_law.averaging_radius":
            return super().field_slopes(key, unit)
        self._follow_reach()
        pressure = self.normal.pressure(self.site.kinematics.jump_at_points())
        return {"averaged": self.neighbours.radius_slope(pressure)}

    def _follow_reach(self) -> None:
        """Average over the points that have something opposite now: there may be others later."""
        everywhere = np.ones(len(self.coefficient), dtype=bool)
        is_given = self.normal.pressure_is_known
        self.neighbours.over(everywhere if is_given else self.site.kinematics.reached)
