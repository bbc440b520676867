"""Results that were written before quantities had today's meaning, as far as they can be told.

Before ``pressure_integral`` was there, the friction force was that on whichever surface was the
slave, the largest slip counted points that did not touch, and contacts were added up.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from fenics_contact.quantities import table
from fenics_contact.results.records.record import Quantities

# What cannot be told from what was written.
_NOT_KNOWN = ("pressure_integral", "contact_force", "max_slip")
_RADII = ("contact_radius", "stick_radius")
# Signs of forces on the body of `on`, of those on the slave; None where that is not known.
Signs = Sequence[float | None]


def result_in_todays_terms(result: dict[str, Any]) -> dict[str, Any]:
    """The content of a ``result.json`` with all keys of today's quantities, None if not known.

    Args:
        result: Of this version, which is not changed, or of an earlier one.
    """
    contacts = result["contacts"]
    if not any(is_earlier(contact["quantities"]) for contact in contacts):
        return result
    signs = _signs(result)
    axisymmetric = result["model"]["kinematics"] == "axisymmetric"
    changed = {
        "contacts": [
            _without_errors(contact | {"quantities": _of_contact(found, sign, axisymmetric)})
            for contact, sign in zip(contacts, signs, strict=True)
            for found in [contact["quantities"]]
        ],
        "quantities": _of_model(result, signs, axisymmetric)["quantities"],
        "steps": steps_in_todays_terms(result["steps"], signs, axisymmetric),
        "branches": [
            _of_model(branch, signs, axisymmetric) for branch in result.get("branches", [])
        ],
    }
    return _without_errors(result | changed)


def steps_in_todays_terms(
    steps: Sequence[Mapping[str, Any]], signs: Signs, axisymmetric: bool
) -> list[dict[str, Any]]:
    """Records of load steps, likewise.

    Args:
        steps: As in ``result.json``.
        signs: Of each contact.
        axisymmetric: Whether contacts may have radii.
    """
    return [_of_model(step, signs, axisymmetric) for step in steps]


def is_earlier(quantities: Quantities) -> bool:
    """Whether a contact's quantities are of before they had today's meaning."""
    return bool(quantities) and "pressure_integral" not in quantities


def _of_model(found: Mapping[str, Any], signs: Signs, axisymmetric: bool) -> dict[str, Any]:
    """A load step, a branch or the whole result: all that has quantities and contacts."""
    contacts = [
        contact | {"quantities": _of_contact(contact["quantities"], sign, axisymmetric)}
        for contact, sign in zip(found.get("contacts", []), signs, strict=False)
    ]
    quantities = found["quantities"]
    if quantities and "pressure_integral" not in quantities:
        only = contacts[0]["quantities"] if len(contacts) == 1 else {}
        resultants = {key: only.get(key) for key in table.resultants_of_contacts()}
        radii = {key: only[key] for key in _RADII if key in only}
        quantities = (
            resultants
            | {
                key: None if key in _NOT_KNOWN else value
                for key, value in quantities.items()
                if key not in table.resultants_of_contacts()
            }
            | radii
        )
    return {**found, "quantities": quantities, **({"contacts": contacts} if contacts else {})}


def _of_contact(quantities: Quantities, sign: float | None, axisymmetric: bool) -> dict[str, Any]:
    if not is_earlier(quantities):
        return dict(quantities)
    friction = None
    if sign is not None:
        friction = [sign * component + 0.0 for component in quantities["friction_force"]]
    resultants = {
        "normal_force": quantities["normal_force"],
        "pressure_integral": None,
        "friction_force": friction,
        "contact_force": None,
    }
    others = {name: value for name, value in quantities.items() if name not in resultants}
    radii = dict.fromkeys(_RADII) if axisymmetric else {}
    return resultants | others | {"max_slip": None} | radii


def _without_errors(found: dict[str, Any]) -> dict[str, Any]:
    """Without the errors of what is not known."""
    quantities = found["quantities"]
    errors = {
        name: row
        for name, row in (found.get("errors") or {}).items()
        if quantities.get(name, 0.0) is not None
    }
    return found | ({"errors": errors} if "errors" in found else {})


def _signs(result: Mapping[str, Any]) -> list[float | None]:
    """Of each contact, by which surface its scene calls `on`."""
    try:
        said = tomllib.loads(result["scene"]).get("contact", [])
    except tomllib.TOMLDecodeError:  # a script made it, of what a scene file cannot hold
        said = []
    signs: list[float | None] = []
    for number, contact in enumerate(result["contacts"]):
        on = said[number].get("on") if number < len(said) else None
        if "slave" not in contact:
            signs.append(1.0)
        else:
            signs.append(None if on is None else 1.0 if contact["slave"] == on else -1.0)
    return signs
