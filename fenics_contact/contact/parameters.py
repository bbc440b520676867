"""Penalty and regularisation of a contact where the scene leaves them to the program."""

from __future__ import annotations

from typing import Literal

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.contact.slave_and_master import ContactSides

# ε = this × g h / E, h the shortest edge at the contact: a stuck point creeps by less
# than ε, which changes the stress near it by about E ε / h, so the bias is of this order.
_REGULARISATION_SHARE = 1e-5
# ε₁ = this × h / E: a pressure p then sinks in by this share of the elastic displacement
# p h / E of one cell, so its bias stays below .1 % down to contacts of a single cell.
_PENALTY_SHARE = 3e-4


class ContactScales:
    """Stiffness and size of cells at a contact, also of those opposite.

    Attributes:
        moduli: Stiffnesses of the body, or of the two that touch.
        facet_size: Shortest edge of the cells at the contact (length).
    """

    def __init__(self, sides: ContactSides, elastic: ElasticBody) -> None:
        self.moduli = elastic.moduli_behind(sides.trace.nodes)
        self.facet_size = sides.facet_size
        if sides.opposite is not None:
            self.moduli = self.moduli.against(elastic.moduli_behind(sides.opposite.nodes))

    def penalty_parameter(self, given: float | Literal["auto"]) -> float:
        """The scene's ε₁, or one whose bias in force and peak pressure is below .1 %."""
        if given != "auto":
            return float(given)
        return _PENALTY_SHARE * self.facet_size / self.moduli.confined

    def regularisation_parameter(self, bound: float) -> float:
        """An ε whose bias is below .1 % at a friction bound (length).

        Args:
            bound: The largest (stress).
        """
        return _REGULARISATION_SHARE * self.facet_size / self.moduli.combined * bound
