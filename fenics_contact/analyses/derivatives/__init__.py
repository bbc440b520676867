"""Derivatives of quantities in numbers of the scene, and what tolerances of these make of them."""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("derivatives", "tolerances"),
    records=("derivatives", "uncertainty"),
    phase="derivatives",
    uses_body=True,
    goes_with=("cyclic symmetry", "heat", "exact contacts"),
)
