"""Hard cases: ``fenics-contact verify --hard``.

Each is solved rightly, or ends in words that name the reason. A module of cases has a theme and
ends with tuples of cases; the one below lists them all.
"""

from fenics_contact.verification.hard.case import HardCase, HardOutcome, Trials
from fenics_contact.verification.hard.coefficients import BRANCHES_CASES, COEFFICIENTS_CASES
from fenics_contact.verification.hard.corners import CORNERS_CASES, INCOMPRESSIBLE_CASES
from fenics_contact.verification.hard.limit_loads import LIMIT_LOADS_CASES
from fenics_contact.verification.hard.materials import MATERIALS_CASES
from fenics_contact.verification.hard.meshes import MESHES_CASES
from fenics_contact.verification.hard.pairs import PAIRS_CASES
from fenics_contact.verification.hard.parameters import PARAMETERS_CASES, UNITS_CASES
from fenics_contact.verification.hard.separation import SEPARATION_CASES

CASES: tuple[HardCase, ...] = (
    *INCOMPRESSIBLE_CASES,
    *PARAMETERS_CASES,
    *COEFFICIENTS_CASES,
    *BRANCHES_CASES,
    *LIMIT_LOADS_CASES,
    *SEPARATION_CASES,
    *UNITS_CASES,
    *MESHES_CASES,
    *MATERIALS_CASES,
    *CORNERS_CASES,
    *PAIRS_CASES,
)

__all__ = ["CASES", "HardCase", "HardOutcome", "Trials"]
