"""What ``fenics-contact verify`` has of fretting."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.verification.case import Case, Finding
from fenics_contact.verification.fretting import bulk_load, lives


def _fretting(quick: bool) -> Iterator[Finding]:
    """Stick zone and edge stress under bulk load; lives of stress that is the same all over."""
    yield from bulk_load.findings(quick)
    yield from lives.findings(quick)


CASES: tuple[Case, ...] = (
    Case(
        "fretting",
        "parabola sheared on a half-plane under bulk load; lives in tension and torsion",
        "D. Nowell, D. A. Hills, Int. J. Mech. Sci. 29 (1987) 355-365; K. N. Smith, P. Watson, "
        "T. H. Topper, J. Materials 5 (1970) 767-778",
        _fretting,
    ),
)
