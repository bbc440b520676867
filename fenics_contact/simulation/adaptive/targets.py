"""Requested accuracies of a scene, and the shares that penalty and regularisation may take."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

from fenics_contact.common.errors import InputError
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_RADIUS,
    INDENTATION,
    MAX_CONTACT_PRESSURE,
    NORMAL_FORCE,
    STICK_AREA,
    STICK_RADIUS,
)
from fenics_contact.results.check_messages import plan
from fenics_contact.results.records.record import Errors
from fenics_contact.results.result import Result
from fenics_contact.scene.accuracy import Accuracy
from fenics_contact.scene.scene import Scene
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
    missing = {
        INDENTATION: "" if has_depth else "a rigid obstacle",
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
