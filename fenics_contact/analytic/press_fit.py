"""Press fits of two long cylinders: G. Lamé's thick-walled tubes, in user's units.

S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed., McGraw-Hill 1970, Section 28.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tube:
    """A cylinder, hollow or not.

    Attributes:
        inner: Radius of its bore, 0 without one (length).
        outer: Outer radius (length).
        youngs_modulus: E (stress).
        poissons_ratio: ν.
    """

    inner: float
    outer: float
    youngs_modulus: float
    poissons_ratio: float

    def compliance(self, at: float, pressed_from: str, is_long: bool) -> float:
        """How far its surface at a radius moves over a pressure on it (length/stress).

        b/E [(r_o² + r_i²)/(r_o² − r_i²) ± ν], + under a pressure from inside; where it cannot
        become longer, with E/(1 − ν²) and ν/(1 − ν) in place of E and ν.

        Args:
            at: The radius, one of its own (length).
            pressed_from: ``inside`` or ``outside``.
            is_long: Whether its length is kept (plane strain), not free (plane stress).
        """
        modulus, ratio = self.youngs_modulus, self.poissons_ratio
        if is_long:
            modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
        squares = self.outer**2 + self.inner**2, self.outer**2 - self.inner**2
        sign = 1 if pressed_from == "inside" else -1
        return at / modulus * (squares[0] / squares[1] + sign * ratio)


def pressure(
    shaft: Tube, hub: Tube, interference: float, is_long: bool, give: float = 0.0
) -> float:
    """Pressure between a shaft and a hub (stress).

    Args:
        shaft: The cylinder inside.
        hub: That around it, whose bore is where the shaft ends.
        interference: How much too large the shaft's radius is (length).
        is_long: As of ``Tube.compliance``.
        give: Of the contact itself: depth over pressure (length/stress).
    """
    radius = hub.inner
    inside = shaft.compliance(radius, "outside", is_long)
    outside = hub.compliance(radius, "inside", is_long)
    return interference / (inside + outside + give)
