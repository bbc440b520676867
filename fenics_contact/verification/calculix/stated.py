"""Where results of CalculiX's tests are from, and how they are compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fenics_contact.common.arrays import Array
from fenics_contact.scene.body import Material
from fenics_contact.verification.case import Finding

SUITE = (
    "CalculiX's test suite (G. Dhondt; GitHub, Dhondtguido/CalculiX, folder test, commit 3593817): "
    "of each input, such as {0}.inp, the results in {0}.{1}"
)
STEEL = Material(210e3, 0.3, density=7.8e-9)


def stated(
    label: str, found: Sequence[float] | Array, reference: Sequence[float], tolerance: float
) -> Iterator[Finding]:
    """Components of a vector, but those that are stated as nothing.

    Args:
        label: The input, and what it is.
        found: Ours.
        reference: CalculiX's; 0 where it states round-off.
        tolerance: Of each, relative.
    """
    for axis, ours, theirs in zip("xyz", found, reference, strict=True):
        if theirs:
            yield Finding(f"{label}, {axis}", float(ours), theirs, tolerance)
