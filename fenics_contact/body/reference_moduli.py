"""How stiff a body is, in round numbers: what parameters are scaled with."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property


@dataclass(frozen=True)
class Moduli:
    """Stiffnesses of a body, or of two that touch each other, for estimates.

    Attributes:
        reference: Young's modulus, or the largest eigenvalue of E_ijkl (stress).
        poissons_ratio: −1 where there is none.
        is_plane_stress: Whether the thickness is free.
        opposite: Those of a second body.
    """

    reference: float
    poissons_ratio: float
    is_plane_stress: bool
    opposite: Moduli | None = None

    def against(self, other: Moduli) -> Moduli:
        """Two bodies that touch each other: their compliances add up."""
        return replace(self, opposite=other)

    @cached_property
    def combined(self) -> float:
        """``reference`` of both bodies (stress)."""
        return self._with(self.reference, "combined")

    @cached_property
    def plane_strain(self) -> float:
        """E/(1 − ν²), or E in plane stress; of two bodies E* (K. L. Johnson, (4.1)) (stress)."""
        own = self.reference
        if not self.is_plane_stress and self.poissons_ratio > -1:
            own /= 1 - self.poissons_ratio**2
        return self._with(own, "plane_strain")

    @cached_property
    def confined(self) -> float:
        """E (1 − ν) / ((1 + ν)(1 − 2ν)): stress over uniaxial strain (stress)."""
        own, nu = self.reference, self.poissons_ratio
        if not self.is_plane_stress and nu > -1:
            own *= max((1 - nu) / ((1 + nu) * (1 - 2 * nu)), 1.0)
        return self._with(own, "confined")

    def _with(self, own: float, name: str) -> float:
        if self.opposite is None:
            return own
        return 1 / (1 / own + 1 / float(getattr(self.opposite, name)))
