"""Hard cases: ``fenics-contact verify --hard``.

Each is solved rightly, or ends in words that name the reason. A module of cases has a theme and
ends with a tuple ``CASES``; the one below lists them all.
"""

from fenics_contact.verification.hard.case import HardCase, HardOutcome, Trials
from fenics_contact.verification.hard.cases import (
    branches,
    coefficients,
    corners,
    incompressible,
    limit_loads,
    materials,
    meshes,
    pairs,
    parameters,
    separation,
    units,
)

CASES: tuple[HardCase, ...] = (
    *incompressible.CASES,
    *parameters.CASES,
    *coefficients.CASES,
    *branches.CASES,
    *limit_loads.CASES,
    *separation.CASES,
    *units.CASES,
    *meshes.CASES,
    *materials.CASES,
    *corners.CASES,
    *pairs.CASES,
)

__all__ = ["CASES", "HardCase", "HardOutcome", "Trials"]
