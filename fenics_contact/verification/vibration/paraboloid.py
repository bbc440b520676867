"""A paraboloid on a half-space, moved to and fro: the outer ring of the contact slips."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

from fenics_contact.verification.case import Finding, solved
from fenics_contact.verification.published.cycle import cyclic_scene
from fenics_contact.verification.published.shear import loss, shear_share, shift

# 40,000 unknowns; load steps from one end of the way to the other.
_MESH = {"fine": 1.1, "size": 1.1 / 6, "cells_outside": 3}
_STEPS = 8


def paraboloid(shares: tuple[float, ...] = (0.6, 0.9)) -> Iterator[Finding]:
    """Loss and damping ratio of a cycle over the shear that comes out, 2 %.

    The half body counts twice. U = ½ Q δ stands for the energy of a mode of that force and way.
    """
    for expected in shares:
        scene = cyclic_scene(expected, _STEPS, **_MESH)
        solver = dataclasses.replace(scene.solver, errors="none")
        result = solved(dataclasses.replace(scene, solver=solver))
        begun, ended = (result.steps[step * _STEPS]["quantities"] for step in (1, 3))
        lost = 2 * (ended["friction_work"] - begun["friction_work"])
        share = shear_share(ended)
        at = f"Q = ±{share:.2f} μP"
        yield Finding(f"loss, {at}", lost, loss(share), 2e-2)
        shear = 2 * abs(ended["friction_force"][0])
        ratio = lost / (2 * math.pi * shear * shift(expected))
        exact = loss(share) / (2 * math.pi * shear * shift(share))
        yield Finding(f"damping ratio, {at}", ratio, exact, 2e-2)
