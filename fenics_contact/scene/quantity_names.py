"""Quantities by the names under which they are asked for. No FEniCSx in here.

``normal_force`` is that of the whole model, ``left.reaction`` that of a contact or of supports,
``displacement_tip`` that of a point; ``_x``, ``_y`` or ``_z`` at the end is a component.
"""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import dataclass

from fenics_contact.common.wording import nearest
from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_WORK, OF_POINTS, REACTION
from fenics_contact.quantities.table import OF_SUPPORTS
from fenics_contact.scene.values import AXES

OF_PRELOADS = tuple(table.MEASURED_BY_PRELOADS)


@dataclass(frozen=True)
class QuantityName:
    """A quantity of a contact, of supports or of the whole model, as a name gives it.

    Attributes:
        owner: Name of the contact or of the supports; empty for the whole model.
        quantity: As in ``result.json``.
        axis: Number of the component, None for all of it.
    """

    owner: str
    quantity: str
    axis: int | None = None


@dataclass(frozen=True)
class Reaction:
    """Key of a quantity of a support by its number, or of all supports of a name together.

    Keys of a contact's quantities are pairs of its number and the quantity, those of the whole
    model's the quantity alone.
    """

    of: int | str
    quantity: str = REACTION


@dataclass(frozen=True)
class OfScalar:
    """Key of a quantity of a scalar unknown that results name, such as a preload, by that name."""

    name: str
    quantity: str


@dataclass(frozen=True)
class LossOfCycle:
    """Key of what friction dissipates in a cycle of loads.

    Attributes:
        cycle: Its number, counted from 1.
        contact: Number of the contact; None for all.
    """

    cycle: int
    contact: int | None = None

    @property
    def friction_work(self) -> Hashable:
        """Key of the work of which it is the part of the cycle."""
        return FRICTION_WORK if self.contact is None else (self.contact, FRICTION_WORK)


@dataclass(frozen=True)
class QuantityNames:
    """The names that a scene gives to contacts, supports and points.

    Attributes:
        contacts: Each once.
        supports: Several supports may have the same.
        points: Each once.
        dimension: Number of components of a vector.
        preloads: Each once.
        have_moments: Whether supports have moments: not in axisymmetric models.

    >>> names = QuantityNames(("top",), ("left", "upper.left"), ("tip",), 3)
    >>> names.find("upper.left.reaction_x")
    QuantityName(owner='upper.left', quantity='reaction', axis=0)
    >>> names.find("left.reaction_moment_z").axis
    2
    >>> names.find("left.normal_force")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: 'left.normal_force': the support 'left' has reaction, reaction_x, ...
    """

    contacts: tuple[str, ...]
    supports: tuple[str, ...]
    points: tuple[str, ...]
    dimension: int
    preloads: tuple[str, ...] = ()
    have_moments: bool = True

    def find(self, text: str) -> QuantityName:
        """Return the quantity that a name is of.

        Args:
            text: ``quantity`` or ``NAME.quantity``; the quantity is what follows the last dot.

        Raises:
            ValueError: The scene has nothing of this name, or two things; says what it has.
        """
        owner, _, quantity = text.rpartition(".")
        readings = self._readings(owner) if owner or "." not in text else {}
        if quantity not in readings:
            raise ValueError(f"'{text}': {self._accepted(owner, quantity, list(readings))}")
        found = readings[quantity]
        if len(found) > 1:
            names = " and ".join(f"'{name.quantity.removeprefix(OF_POINTS)}'" for name in found)
            raise ValueError(
                f"'{text}' could be of the points {names}: give one of them another name"
            )
        return found[0]

    def key(self, name: QuantityName) -> Hashable:
        """Return the key of a quantity in the dictionaries of values and errors."""
        if not name.owner:
            return name.quantity
        if name.quantity in OF_SUPPORTS:
            return Reaction(name.owner, name.quantity)
        if name.quantity in OF_PRELOADS:
            return OfScalar(name.owner, name.quantity)
        return (self.contacts.index(name.owner), name.quantity)

    def _readings(self, owner: str) -> dict[str, list[QuantityName]]:
        """Return the meanings of each quantity of an owner; names of points may end like axes."""
        quantities = list(table.names_for_model()) if not owner else []
        quantities += [OF_POINTS + point for point in self.points] if not owner else []
        quantities += table.names_for_contacts() if owner in self.contacts else ()
        quantities += self._of_supports if owner in self.supports else ()
        quantities += OF_PRELOADS if owner in self.preloads else ()
        found: dict[str, list[QuantityName]] = {}
        for quantity in quantities:
            found.setdefault(quantity, []).append(QuantityName(owner, quantity))
            if table.is_vector(quantity, self.dimension):
                for axis, letter in enumerate(AXES[: self.dimension]):
                    component = QuantityName(owner, quantity, axis)
                    found.setdefault(f"{quantity}_{letter}", []).append(component)
        return found

    @property
    def _of_supports(self) -> tuple[str, ...]:
        """Quantities of a support."""
        every = OF_SUPPORTS if self.have_moments else (REACTION,)
        return tuple(every)

    def _accepted(self, owner: str, quantity: str, quantities: list[str]) -> str:
        """Return in words which names there are in place of an unknown one."""
        if not quantities:
            known = list(dict.fromkeys([*self.contacts, *self.supports, *self.preloads]))
            return (
                f"no contact and no support is called '{owner}'; {_nearest(owner, known)}"
                f"There are {', '.join(known) or 'none'}"
            )
        hint = _nearest(quantity, quantities)
        if not owner:
            return f"{hint}The whole model has {', '.join(quantities)}"
        kinds = [
            f"the {kind} '{owner}'"
            for kind, names in (
                ("contact", self.contacts),
                ("support", self.supports),
                ("preload", self.preloads),
            )
            if owner in names
        ]
        return f"{hint}{' and '.join(kinds)} has {', '.join(quantities)}"


def _nearest(text: str, known: list[str]) -> str:
    """A question after the nearest of the known names; empty where none is near."""
    near = nearest(text, known)
    return f"did you mean '{near[0]}'? " if near else ""


def looks_like_quantity(key: str) -> bool:
    """Whether a key can only be meant as a quantity by its name, known or not."""
    return re.search(pattern_of_quantities(), key) is not None


def pattern_of_quantities() -> str:
    """Regular expression of keys that can only be names of quantities, for the schema, too."""
    return rf"\.|^{OF_POINTS}|^({'|'.join(table.names_for_model())})(_[xyz])?$"


def in_words(text: str) -> str:
    """A quantity's name as text.

    >>> in_words("upper_left.reaction_x"), in_words("normal_force")
    ('reaction x of upper_left', 'normal force')
    """
    owner, _, quantity = text.rpartition(".")
    return quantity.replace("_", " ") + (f" of {owner}" if owner else "")


def require_name(name: str) -> None:
    """Refuse a name that cannot be told from others where it is read.

    Raises:
        ValueError: It has characters that are not printed, or blanks at its ends.
    """
    if not name.isprintable() or name != name.strip():
        raise ValueError(f"name = {name!r} may have only printable characters, and no blank ends")
