"""Analytic and published benchmarks: ``fenics-contact verify``.

A module of cases ends with a tuple ``CASES``; the one below lists them all.
"""

from fenics_contact.verification import (
    cycle_cases,
    friction_cases,
    hertz_pair_cases,
    incline_cases,
    line_cases,
    pair_cases,
    pair_ways_cases,
    point_cases,
    punch_cases,
    shear_cases,
    slab_cases,
)
from fenics_contact.verification.case import Case, Finding, Outcome

CASES: tuple[Case, ...] = (
    *slab_cases.CASES,
    *point_cases.CASES,
    *line_cases.CASES,
    *punch_cases.CASES,
    *friction_cases.CASES,
    *shear_cases.CASES,
    *cycle_cases.CASES,
    *pair_cases.CASES,
    *pair_ways_cases.CASES,
    *hertz_pair_cases.CASES,
    *incline_cases.CASES,
)

__all__ = ["CASES", "Case", "Finding", "Outcome"]
