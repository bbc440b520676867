"""Fretting: criteria of fatigue by the history of stress near contacts, over a cycle of loads."""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("fretting",),
    records=("fretting",),
    files=r"fretting\.csv|fretting(\.pvd|\d{6}\.p?vtu|_p\d+_\d{6}\.vtu)",
    pictures=r"fretting_\w+",
)
