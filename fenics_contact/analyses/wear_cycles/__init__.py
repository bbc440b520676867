"""Cycles of loads that wear: some are computed, the others passed over by what these wear."""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("cycles.jumps",),
    records=("worn",),
    files=r"wear\.html",
    step_files=r"wear\.csv|wear_profiles\.csv",
    pictures=r"wear|wear_\d+",
    goes_with=("own steps",),
    own_steps=True,
    page_of="wear.csv",
)
