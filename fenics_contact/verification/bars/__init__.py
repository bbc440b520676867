"""Error bars against true errors: ``fenics-contact verify --errors``.

A module of cases ends with a tuple ``CASES``; the one below lists them all.
"""

from fenics_contact.verification.bars import body_cases, flat_cases, round_cases
from fenics_contact.verification.bars.bar_case import BarCase

CASES: tuple[BarCase, ...] = (*round_cases.CASES, *flat_cases.CASES, *body_cases.CASES)

__all__ = ["CASES", "BarCase"]
