"""Stress along straight lines through the body, such as a section or a path to a notch."""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("line",),
    records=("lines",),
    files=r"lines\.csv",
    pictures=r"line_\d+",
    goes_with=("cyclic symmetry", "heat", "exact contacts"),
)
