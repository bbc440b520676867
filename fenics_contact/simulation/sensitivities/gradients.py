"""The gradient of a quantity, found by its name: a list, to which others can be added."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from fenics_contact.common.errors import InputError
from fenics_contact.evaluate.contact_quantities import ContactAnswer, contact_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.names import OF_POINTS
from fenics_contact.quantities.quantity import Together
from fenics_contact.scene.quantity_names import QuantityName
from fenics_contact.simulation.sensitivities.quantity_gradients import (
    CONTACT_GRADIENTS,
    MODEL_GRADIENTS,
    ContactGradient,
    StateGradient,
    of_point,
)
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.measured import measured

_OF_CONTACTS: dict[str, ContactGradient] = dict(CONTACT_GRADIENTS)


def register(name: str, gradient: ContactGradient) -> None:
    """Give a quantity of contacts its gradient.

    Args:
        name: Of the quantity, a row of the table of quantities.
        gradient: Gives its derivatives; collective.

    Raises:
        ValueError: It has one.
    """
    if name in _OF_CONTACTS:
        raise ValueError(f"the quantity '{name}' has a gradient")
    _OF_CONTACTS[name] = gradient


def unregister(name: str) -> None:
    """Take out a gradient that was registered.

    Args:
        name: Of the quantity.
    """
    del _OF_CONTACTS[name]


def find(problem: Problem, text: str) -> QuantityName:
    """The quantity of a name, if it has derivatives.

    Args:
        problem: The model.
        text: The name, such as ``normal_force`` or ``left.reaction_x``.

    Raises:
        InputError: There is no such quantity, or it has no derivatives.
    """
    try:
        name = problem.scene.names.find(text)
    except ValueError as error:
        raise InputError(f"of: {error}") from None
    if table.is_vector(name.quantity, problem.spaces.components) and name.axis is None:
        raise InputError(f"of: '{text}' is a vector; ask for its components, such as {text}_x")
    known = (*_OF_CONTACTS, *MODEL_GRADIENTS)
    if name.quantity not in known and not name.quantity.startswith(OF_POINTS):
        raise InputError(
            f"of: '{text}' has no derivatives; those that have are "
            + ", ".join([*known, f"{OF_POINTS}NAME"])
        )
    return name


def gradient_of(problem: Problem, solution: Solution, text: str) -> StateGradient:
    """Derivatives of a quantity of an answer in the state of the problem; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer.
        text: Name of the quantity, such as ``normal_force`` or ``left.reaction_x``.

    Raises:
        InputError: There is no such quantity, or it has no derivatives.
    """
    name = find(problem, text)
    if name.quantity in _OF_CONTACTS:
        found = StateGradient.none(problem)
        for number in _contacts_of(problem, solution, name, text):
            answer = ContactAnswer(problem, solution, number)
            own = _OF_CONTACTS[name.quantity](answer, name.axis)
            found = found.plus(StateGradient.of_contact(problem, number, own))
    else:
        found = MODEL_GRADIENTS.get(name.quantity, of_point)(problem, solution, name)
    row = table.find(name.quantity)
    if row is None or not row.is_extensive:
        return found
    return replace(found, resultant=partial(_value, problem, solution, name))


def _value(problem: Problem, solution: Solution, name: QuantityName) -> float:
    """The quantity itself, or its component, in the state of the answer; collective."""
    value = measured(problem, solution)[problem.scene.names.key(name)]
    return float(np.atleast_1d(value)[name.axis or 0])


def _contacts_of(problem: Problem, solution: Solution, name: QuantityName, text: str) -> list[int]:
    """The contacts whose quantities add up to one, or which has the largest; collective."""
    every = list(range(len(problem.contacts)))
    if name.owner:
        return [problem.scene.names.contacts.index(name.owner)]
    row = table.find(name.quantity)
    assert row is not None
    if row.together is Together.SUM or len(every) <= 1:
        return every
    if row.together is Together.LARGEST:
        sizes = [contact_quantities(problem, solution, n)[name.quantity] for n in every]
        return [int(np.argmax(sizes))]
    raise InputError(
        f"of: '{text}': the model has {len(every)} contacts, which have it one by one; ask "
        f"for NAME.{text}, NAME being a contact's"
    )
