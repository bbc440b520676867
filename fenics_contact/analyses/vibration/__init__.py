"""How a body vibrates about a state: its modes, and what its joints damp of them.

Modes are of the structure whose contacts are stuck; each is then driven to and fro by forces M φ,
without inertia, and the loop tells its frequency and its damping (H. Festjens, G. Chevallier and
J.-L. Dion, Int. J. Mech. Sci. 75 (2013) 170-177; R. M. Lacayo and M. S. Allen, Mech. Syst. Signal
Process. 118 (2019) 133-157).
"""

from fenics_contact.analyses.registry import Analysis

ANALYSIS = Analysis(
    package=__name__,
    tables=("modes", "damping"),
    records=("modes", "damping"),
    files=r"damping\.csv|modes(\.pvd|\d{6}\.p?vtu|_p\d+_\d{6}\.vtu)",
    pictures="damping|modes|animation_modes",
    phase="vibration",
    uses_body=True,
    goes_with=("cyclic symmetry",),
)
