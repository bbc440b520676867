"""What joints damp of a mode, beside formulas for their loops."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from fenics_contact.verification.case import Case, Finding
from fenics_contact.verification.vibration.bar import bar
from fenics_contact.verification.vibration.layers import layers
from fenics_contact.verification.vibration.paraboloid import paraboloid


def _damping(quick: bool) -> Iterator[Finding]:
    joints = {"bar": bar, "layers": layers} | ({} if quick else {"paraboloid": paraboloid})
    for name, found in joints.items():
        for finding in found():
            yield dataclasses.replace(finding, quantity=f"{name}, {finding.quantity}")


CASES: tuple[Case, ...] = (
    Case(
        "damping",
        "damping and frequency over amplitude: a bar on a plane, two layers, a paraboloid",
        "ζ = D/(4πU); bar: D = 2F³/(3EAτ); layers: L. E. Goodman and J. H. Klumpp, J. Appl. Mech. "
        "23 (1956) 421-429; paraboloid: R. D. Mindlin and H. Deresiewicz, J. Appl. Mech. 20 (1953) "
        "327-344",
        _damping,
    ),
)
