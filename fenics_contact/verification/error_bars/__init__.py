"""Error bars against true errors: ``fenics-contact verify --errors``.

A module of cases ends with a tuple ``CASES``; the one below lists them all.
"""

from fenics_contact.verification.error_bars import bodies as body_cases
from fenics_contact.verification.error_bars import cyclic as cyclic_cases
from fenics_contact.verification.error_bars import flat as flat_cases
from fenics_contact.verification.error_bars import lifting as lifting_cases
from fenics_contact.verification.error_bars import round as round_cases
from fenics_contact.verification.error_bars.case import BarCase

CASES: tuple[BarCase, ...] = (
    *round_cases.CASES,
    *flat_cases.CASES,
    *lifting_cases.CASES,
    *body_cases.CASES,
    *cyclic_cases.CASES,
)

__all__ = ["CASES", "BarCase"]
