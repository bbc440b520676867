"""Error bars against true errors: ``fenics-contact verify --errors``.

A module of cases ends with tuples of them; the one below lists them all.
"""

from fenics_contact.verification.error_bars.case import BarCase
from fenics_contact.verification.error_bars.cyclic import BODIES_CASES, CYCLIC_CASES, LIFTING_CASES
from fenics_contact.verification.error_bars.flat import FLAT_CASES
from fenics_contact.verification.error_bars.round import ROUND_CASES

CASES: tuple[BarCase, ...] = (
    *ROUND_CASES,
    *FLAT_CASES,
    *LIFTING_CASES,
    *BODIES_CASES,
    *CYCLIC_CASES,
)

__all__ = ["CASES", "BarCase"]
