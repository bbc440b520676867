"""What a run says of its answer."""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.parallel import largest
from fenics_contact.problem import Problem
from fenics_contact.result import Check
from fenics_contact.solution import Solution

# Slip over the size of a contact between two pairings, from which pressures are visibly off:
# without friction a shift of .01 changes them by 1 %.
_FAR = 0.01


def untouched(problem: Problem, solution: Solution) -> str:
    """A sentence on obstacles that the body does not touch, or nothing; collective."""
    touched = [
        largest(problem.comm, np.abs(state.contact_pressure)) > 0 for state in solution.states
    ]
    free = [
        f"'{contact.label}'"
        for contact, touches in zip(problem.contacts, touched, strict=True)
        if not touches and contact.normal is not None
    ]
    return f" The body does not touch the obstacle at {' and '.join(free)}." if free else ""


def of_checks(checks: dict[str, Check]) -> str:
    """Whether to trust it."""
    failed = [name.replace("_", " ") for name, check in checks.items() if not check.passed]
    if failed:
        return f"Converged, but do not trust it: failed {', '.join(failed)}."
    return f"Converged; all {len(checks)} checks of the physics passed."


def slid_far(steps: list[dict[str, Any]]) -> str:
    """A sentence on bodies that slid far within a load step, or nothing."""
    found: dict[str, float] = {}
    for step in steps:
        for contact in step["contacts"]:
            slid = contact["quantities"].get("slip_since_pairing", 0.0)
            found[contact["name"]] = max(slid, found.get(contact["name"], 0.0))
    far = [f"'{name}' by {slid:.2g}" for name, slid in found.items() if slid > _FAR]
    if not far:
        return ""
    return (
        f" Bodies slid far within a load step, over the contact's size at {' and '.join(far)}: "
        "pressures may be off by as much; take more load steps."
    )
