"""The few lines that matter most: what preloads and contacts carry, and what friction took."""

from __future__ import annotations

import math

from fenics_contact.common.plain_text import one_line
from fenics_contact.results.quantities import QuantityValue, idle_quantities
from fenics_contact.results.records.contacts import ContactRecord, PreloadRecord
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.words.rounding import rounded, size_of_forces


def headlines(result: Outcome) -> list[str]:
    """A line a preload and a contact, and what friction dissipated; none without an answer.

    Args:
        result: Of a run.
    """
    if not result.converged:
        return []
    size = size_of_forces(result.quantities, result.contacts)
    lines = [_of_preload(name, preload) for name, preload in result.preloads.items()]
    lines += [_of_contact(contact, size) for contact in result.contacts if contact.quantities]
    if result.contacts and "friction_work" not in idle_quantities(result.contacts):
        lines.append(f"Friction dissipated {_estimate('friction_work', result)}.")
    return lines


def _of_preload(name: str, preload: PreloadRecord) -> str:
    force = _with_bar(preload.force, preload.errors, "force", 0.0)
    locked = ", its length locked" if preload.locked else ""
    return f"Preload '{one_line(name)}': force {force}{locked}."


def _of_contact(contact: ContactRecord, size: float) -> str:
    found, idle = contact.quantities, idle_quantities([contact])
    pressing = "normal_force" if found.get("normal_force") is not None else "pressure_integral"
    words = []
    if found.get(pressing) is not None:
        words.append(f"presses with {_estimate(pressing, contact, size)}")
    friction = found.get("friction_force")
    # Around an axis they cancel.
    if isinstance(friction, list) and any(friction) and "friction_force" not in idle:
        resultant = _length_of(contact, friction, size)
        words.append(f"friction {resultant}{_share(contact, friction)}")
    for key, said in (("max_contact_pressure", "peak pressure"), ("max_slip", "slips by up to")):
        if found.get(key) is not None and key not in idle:
            words.append(f"{said} {_estimate(key, contact)}")
    return f"Contact '{one_line(contact.name)}': {', '.join(words)}."


def _estimate(key: str, found: ContactRecord | Outcome, size: float = 0.0) -> str:
    """A value with its bar."""
    value = found.quantities[key]
    assert value is not None
    return _with_bar(value, found.errors, key, size)


def _length_of(contact: ContactRecord, force: list[float], size: float) -> str:
    return _with_bar(math.hypot(*force), contact.errors, "friction_force", size)


def _with_bar(value: QuantityValue, errors: Errors, key: str, size: float) -> str:
    """Without a bar where the run estimated none at all, and where none is needed."""
    said, bar = rounded(value, errors.get(key), size)
    return f"{said} ± {bar}" if errors and bar else said


def _share(contact: ContactRecord, force: list[float]) -> str:
    """How much of what friction could hold it does, where the coefficient is one number."""
    coefficient = contact.parameters.get("friction_coefficient")
    pressing = contact.quantities.get("pressure_integral")
    if not isinstance(coefficient, float) or not isinstance(pressing, float):
        return ""
    limit = coefficient * pressing
    return f" ({100 * math.hypot(*force) / limit:.3g} % of its limit)" if limit > 0 else ""
