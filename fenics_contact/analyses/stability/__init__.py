"""Whether bodies slide steadily or begin to squeal: complex modes about a state of sliding."""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("stability",),
    records=("stability",),
    files=r"stability\.csv|squeal(\.pvd|\d{6}\.p?vtu|_p\d+_\d{6}\.vtu)",
    pictures="stability|squeal",
    phase="stability",
    uses_body=True,
)
