"""What joints damp of a mode, beside formulas for their loops."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from fenics_contact.verification.case import Case, Finding
from fenics_contact.verification.vibration.bar import bar
from fenics_contact.verification.vibration.layers import layers


def _damping(quick: bool) -> Iterator[Finding]:
    for name, found in (("bar", bar), ("layers", layers)):
        for finding in found():
            yield dataclasses.replace(finding, quantity=f"{name}, {finding.quantity}")


CASES: tuple[Case, ...] = (
    Case(
        "damping",
        "damping and frequency over amplitude: a bar on a plane, two clamped layers",
        "ζ = D/(4πU); bar: D = 2F³/(3EAτ); layers: L. E. Goodman and J. H. Klumpp, J. Appl. Mech. "
        "23 (1956) 421-429",
        _damping,
    ),
)
