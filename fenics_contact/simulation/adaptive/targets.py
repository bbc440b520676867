"""Requested accuracies of a scene, and how far the errors of an answer are from them.

Most errors are relative to the quantity itself. One that may vanish is measured by what is its
size then: components by the length of their vector, friction by the normal force, areas that stick
or slip by that in contact. And forces and displacements by no less than a small share of the
largest of their kind: that of a support that carries next to nothing need not be known to a share
of that.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Mapping, Sequence

import numpy as np

from fenics_contact.common.errors import InputError
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_RADIUS,
    INDENTATION,
    MAX_CONTACT_PRESSURE,
    NORMAL_FORCE,
    OBSTACLE_ROTATION,
    OF_POINTS,
    REACTION,
    REACTION_MOMENT,
    STICK_AREA,
    STICK_RADIUS,
    STRAIN_ENERGY,
)
from fenics_contact.results.check_messages import plan
from fenics_contact.results.records.record import Errors, Quantities
from fenics_contact.results.result import Result
from fenics_contact.results.rounding import sizes_of
from fenics_contact.scene.quantity_names import OF_PRELOADS, QuantityName, QuantityNames
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.settings import Accuracy
from fenics_contact.simulation.adaptive.next_mesh import hindrance
from fenics_contact.simulation.scene_run import Run

# Share of the accuracy that penalty, regularisation and iteration may take, and what they are
# brought down to once they take more.
_SHARE, _AIM = 0.2, 0.1
# By at most so many times from one level to the next.
_SMALLER = 100.0


def asked_of(run: Run) -> dict[str, float]:
    """Quantities that a scene asks for and has, each with the relative error allowed.

    Raises:
        InputError: There is none, or its errors cannot be estimated.
    """
    accuracy, contacts = run.scene.accuracy, run.problem.contacts
    assert accuracy is not None
    if run.scene.solver.errors == "none":
        raise InputError('solver.errors = "none": accuracy needs the errors; leave one of them out')
    if run.problem.elastic.mixed is not None:
        raise InputError(
            "accuracy: meshes are not adapted to nearly incompressible bodies; leave it out, and "
            "look at the error bars"
        )
    _require_present(accuracy, run)
    present = set()
    if any(contact.normal.has_counterpart for contact in contacts):
        present |= {NORMAL_FORCE, MAX_CONTACT_PRESSURE}
    if any(contact.is_one_sided for contact in contacts):
        present.add(CONTACT_AREA)
    if run.problem.frictional:
        present.add(STICK_AREA)
    asked = accuracy.asked(present)
    if not asked:
        raise InputError(
            f"accuracy.main = {accuracy.main:g}: the scene has none of its quantities; ask for "
            "another one, such as strain_energy"
        )
    return _of_each_contact(asked, [contact.label for contact in contacts])


def _require_present(accuracy: Accuracy, run: Run) -> None:
    """Refuse quantities of contacts, obstacles and an axis in a scene that has none.

    Raises:
        InputError: There is such a one.
    """
    contacts = run.problem.contacts
    has_depth = run.problem.has_datum and any(c.contact.obstacle is not None for c in contacts)
    turns = any(c.kinematics.turning.axis.any() for c in contacts)
    missing = {
        INDENTATION: "" if has_depth else "a rigid obstacle",
        OBSTACLE_ROTATION: "" if turns else "an obstacle that turns",
        **dict.fromkeys(
            (CONTACT_RADIUS, STICK_RADIUS),
            "" if run.problem.spaces.kinematics == "axisymmetric" else "an axis of revolution",
        ),
    }
    for text in accuracy.asked([]):
        quantity = run.scene.names.find(text).quantity
        lacks = "" if contacts or quantity not in table.names_for_contacts() else "a contact"
        lacks = lacks or missing.get(quantity, "")
        if lacks:
            raise InputError(f"accuracy: '{text}' needs {lacks}, which the scene has not")


def _of_each_contact(asked: Mapping[str, float], labels: Sequence[str]) -> dict[str, float]:
    """With several contacts a force asked for is that of each; one by its name stays as it is."""
    if len(labels) < 2:
        return dict(asked)
    found: dict[str, float] = {}
    for text, limit in asked.items():
        of_each = "." not in text and text.startswith(table.resultants_of_contacts())
        names = [f"{label}.{text}" for label in labels] if of_each else [text]
        found |= {name: asked.get(name, limit) for name in names}
    return found


def balanced(scene: Scene, result: Result, errors: Errors, asked: Mapping[str, float]) -> Scene:
    """The scene with smaller ε₁ and ε where they take too much, and the scene did not set them.

    Errors are proportional to both (see ``parameter_errors``).

    Args:
        scene: Of the level.
        result: Its result, with the parameters as used.
        errors: Relative, by quantity and source.
        asked: Relative errors allowed.
    """
    contacts = list(scene.contact)
    for source, key in (
        ("penalty", "penalty_parameter"),
        ("regularisation", "regularisation_parameter"),
    ):
        excess = max((found.get(source) or 0.0) / asked[name] for name, found in errors.items())
        if excess <= _SHARE:
            continue
        for number, contact in enumerate(contacts):
            used = result.contacts[number]["parameters"].get(key)
            if getattr(contact, key) == "auto" and used:
                smaller = used / min(excess / _AIM, _SMALLER)
                contacts[number] = dataclasses.replace(contact, **{key: smaller})
    return dataclasses.replace(scene, contact=tuple(contacts))


def adaptive_plan(run: Run) -> str:
    """Return what ``fenics-contact check`` says of the requested accuracy; empty without one."""
    if run.scene.accuracy is None:
        return ""
    words = plan(asked_of(run), run.scene.accuracy)
    reason = hindrance(run.scene, run.problem.body, is_own=False)
    return f"{words} But {reason}." if reason else words


# Of the largest force, or displacement, by which smaller ones are measured.
_SMALL = 0.01


def relative_errors(
    result: Result, asked: Mapping[str, float], names: QuantityNames, applied: float = 0.0
) -> Errors:
    """Return the relative errors of the requested quantities, by source.

    Args:
        result: With ``errors``.
        asked: The quantities by their names.
        names: Those of its scene.
        applied: Sum of the sizes of the loads' nodal forces: where they balance each other, the
            resultants of contacts and supports are round-off (force).

    Returns:
        By name; without sources, and None in total, where the answer has no such quantity.
    """
    found: dict[str, dict[str, float | None]] = {}
    for text in asked:
        name = names.find(text)
        values, errors = _of_owner(result, name)
        quantity = _given(values, name.quantity)
        row = errors.get(quantity) or {"mesh": None, "total": None}
        if values.get(quantity) is None:
            row = {"total": None}
        size = _size(result, values, quantity, applied)
        found[text] = {source: _over(error, size) for source, error in row.items()}
    return found


def measured_keys(
    result: Result, asked: Iterable[str], names: QuantityNames
) -> dict[str, Hashable]:
    """The key among what is measured of each quantity asked for; as of ``relative_errors``."""
    found = {}
    for text in asked:
        name = names.find(text)
        quantity = _given(_of_owner(result, name)[0], name.quantity)
        found[text] = names.key(dataclasses.replace(name, quantity=quantity))
    return found


def _of_owner(result: Result, name: QuantityName) -> tuple[Quantities, Errors]:
    """Quantities and their errors, of what a name says that they are of."""
    if not name.owner:
        return result.quantities, result.errors
    if name.quantity in table.OF_SUPPORTS:
        of_supports = result.reactions[name.owner]
        return of_supports.quantities, of_supports.errors
    if name.quantity in OF_PRELOADS:
        preload = result.preloads[name.owner]
        return preload, preload.errors
    contact = next(contact for contact in result.contacts if contact.name == name.owner)
    return contact.quantities, contact.errors


def _given(values: Quantities, quantity: str) -> str:
    """Return the quantity, or that which replaces a normal force without an axis."""
    row = table.find(quantity)
    has_other = row is not None and row.instead and values.get(quantity) is None
    return row.instead if row is not None and has_other else quantity


def _size(result: Result, values: Quantities, quantity: str, applied: float) -> float:
    """Return the size that errors of a quantity are relative to; 0 where it is not known."""
    row = table.find(quantity)
    by = _given(values, (row and row.relative_to) or quantity)
    value = values.get(by, result.quantities.get(by))
    if value is None:
        return 0.0
    force = _largest_force(result)
    least = 0.0
    if quantity in _forces():
        least = _SMALL * force
    elif quantity == REACTION_MOMENT:
        least = _SMALL * sizes_of({}, result.reactions.values())[table.measured_by(quantity)]
    elif quantity.startswith(OF_POINTS) and max(force, applied) > 0:
        # The displacement that goes with the forces.
        least = _SMALL * 2 * result.quantities[STRAIN_ENERGY] / max(force, applied)
    return max(float(np.linalg.norm(value)), least)


def _largest_force(result: Result) -> float:
    """Return the largest of the resultants of all contacts and supports (force)."""
    values = [of.get(force) for of in _parts(result) for force in _forces()]
    return max((float(np.linalg.norm(v)) for v in values if v is not None), default=0.0)


def _forces() -> tuple[str, ...]:
    """Names of resultants of contacts and supports."""
    return (*table.resultants_of_contacts(), REACTION)


def _parts(result: Result) -> list[Quantities]:
    return [*(contact.quantities for contact in result.contacts), *result.reactions.values()]


def others_than_mesh(found: Mapping[str, float | None]) -> dict[str, float]:
    """A quantity's errors by the other sources, of those that it has."""
    return {s: v for s, v in found.items() if s not in ("mesh", "total") and v}


def _over(error: float | None, size: float) -> float | None:
    """Relative; of what is nothing, any error is infinite."""
    if error is None or error == 0:
        return error
    return error / size if size > 0 else float("inf")


def is_met(errors: Errors, asked: Mapping[str, float]) -> bool:
    """Whether all are estimated and small enough."""
    totals = {name: found["total"] for name, found in errors.items()}
    return all(value is not None and value <= asked[name] for name, value in totals.items())
