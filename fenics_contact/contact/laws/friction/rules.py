"""The rules of how large friction may be, and those with a coefficient by a table.

The rules of how large friction may be: Coulomb's, by pressure, by slip, with micro-slip, …. A new
rule is a class, a line in ``RULES`` and a class in ``scene/laws/friction_laws.py``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.allowed import own_law
from fenics_contact.contact.laws.friction.coulomb import (
    Compliance,
    Coulomb,
    FormulaBound,
    MicroSlip,
    Nonlocal,
    UserFriction,
)
from fenics_contact.contact.laws.friction.orthotropic import Orthotropic
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.laws.friction_laws import (
    FRICTION_LAWS,
    PressureDependentFriction,
    SlipDependentFriction,
    SpeedDependentFriction,
)
from fenics_contact.scene.laws.law_tables import FrictionLawTable
from fenics_contact.scene.values import Value


def named(places: Sequence[float], values: Sequence[float]) -> dict[str, float]:
    """The table's numbers by the names that ``in_table`` knows."""
    found = {f"place_{number}": place for number, place in enumerate(places)}
    return found | {f"value_{number}": value for number, value in enumerate(values)}


def names_of(key: str, places: str, ones: Array) -> dict[str, Array]:
    """Slopes at the points in the number of the table under a key; nothing for other keys.

    Args:
        key: Of the contact, such as ``friction_law.shares.1``.
        places: What the scene calls the places.
        ones: 1 at the points.
    """
    table, _, rest = key.partition(".")
    name, _, number = rest.partition(".")
    known = {places: "place", "shares": "value"}
    return {f"{known[name]}_{number}": ones} if table == "friction_law" and name in known else {}


def in_table(where: Expr, numbers: Mapping[str, Expr]) -> Expr:
    """The value at a place: linear between those of the table, constant beyond its ends.

    Args:
        where: The place.
        numbers: Those of the table by name, others among them.
    """
    count = sum(name.startswith("place_") for name in numbers)
    places = [numbers[f"place_{number}"] for number in range(count)]
    values = [numbers[f"value_{number}"] for number in range(count)]
    found = values[0]
    for number in range(count - 1):
        share = (where - places[number]) / (places[number + 1] - places[number])
        between = values[number] + share * (values[number + 1] - values[number])
        found = ufl.conditional(ufl.gt(where, places[number]), between, found)
    return ufl.conditional(ufl.gt(where, places[-1]), values[-1], found)


class ByPressure(FrictionRule):
    """g = μ s(p) p, s a table of shares of the coefficient over the pressure."""

    kind: ClassVar[str] = "pressure dependent"

    @property
    def constants(self) -> Mapping[str, float]:
        """Numbers of the table, by name."""
        return named(self._table.pressures, self._table.shares)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the coefficient, and of the table's numbers in themselves."""
        return super().field_slopes(key, unit) or names_of(
            key, "pressures", np.ones_like(self.coefficient)
        )

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(p) p."""
        return fields["coefficient"] * in_table(pressure, fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with its largest share."""
        return self.coefficient * max(self._table.shares)

    @property
    def _table(self) -> PressureDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, PressureDependentFriction)
        return law


class BySlip(FrictionRule):
    """g = μ s(l) p, s a table of shares over the slip so far l, the length of a point's path.

    l is that at the end of the load step before: within a step the coefficient is known, and the
    error of that is of the order of the step. Points slide only where they touch.
    """

    kind: ClassVar[str] = "slip dependent"
    state: ClassVar[tuple[PointArray, ...]] = (PointArray("slip_so_far", "length"),)

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self._slid = np.zeros(len(self.coefficient))
        self._in_forms = site.trace.function(self._slid)

    @property
    def constants(self) -> Mapping[str, float]:
        """Numbers of the table, by name."""
        return named(self._table.slips, self._table.shares)

    @property
    def changing(self) -> Mapping[str, Expr]:
        """The slip so far."""
        return {"slip_so_far": self._in_forms.ufl}

    @property
    def _values(self) -> Mapping[str, Array | float]:
        return {**super()._values, "slip_so_far": self._slid}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the coefficient, and of the table's numbers in themselves."""
        return super().field_slopes(key, unit) or names_of(
            key, "slips", np.ones_like(self.coefficient)
        )

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(l) p."""
        return fields["coefficient"] * in_table(fields["slip_so_far"], fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with the share of the slip so far."""
        return self.slope(np.zeros(len(self._slid)))

    def at_step_end(self, slip: Array, closed: Flags) -> dict[str, Array]:
        """The slip so far with that of the step, where points touch."""
        way = np.where(closed, np.linalg.norm(slip, axis=1), 0.0)
        return {"slip_so_far": self._slid + way}

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Transposed derivative of ``at_step_end``, in the slip of the step and in that before."""
        of_way = np.where(closed, of_end["slip_so_far"], 0.0)
        size = np.linalg.norm(slip, axis=1)
        direction = slip / np.where(size > 0, size, 1.0)[:, None]
        return of_way[:, None] * direction, of_end

    def take(self, kept: Mapping[str, Array]) -> None:
        """Follow the slip so far."""
        self._slid = kept["slip_so_far"]
        self._in_forms.set(self._slid)

    @property
    def _table(self) -> SlipDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, SlipDependentFriction)
        return law


class BySpeed(FrictionRule):
    """g = μ s(v) p, s a table of shares over the speed v of sliding.

    v is given for each solve: the balance of a step is that of Coulomb's friction.
    """

    kind: ClassVar[str] = "speed dependent"
    follows_speed: ClassVar[bool] = True

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self._speed = np.zeros(len(self.coefficient))
        self._in_forms = site.trace.function(self._speed)

    @property
    def constants(self) -> Mapping[str, float]:
        """Numbers of the table, by name."""
        return named(self._table.speeds, self._table.shares)

    @property
    def changing(self) -> Mapping[str, Expr]:
        """Speed of sliding in the forms."""
        return {"speed": self._in_forms.ufl}

    @property
    def _values(self) -> Mapping[str, Array | float]:
        return {**super()._values, "speed": self._speed}

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(v) p."""
        return fields["coefficient"] * in_table(fields["speed"], fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with its largest share."""
        return self.coefficient * max(self._table.shares)

    def follow_speed(self, speed: Array) -> None:
        """Go by it from now on."""
        self._speed = speed
        self._in_forms.set(speed)

    @property
    def _table(self) -> SpeedDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, SpeedDependentFriction)
        return law


RULES: tuple[type[FrictionRule], ...] = (
    Coulomb,
    ByPressure,
    BySlip,
    BySpeed,
    Compliance,
    Nonlocal,
    MicroSlip,
    Orthotropic,
    FormulaBound,
)
_REGISTERED: dict[type[FrictionRule], type[FrictionLawTable]] = {}


def register(rule: type[FrictionRule], table: type[FrictionLawTable]) -> None:
    """Add a rule, and its table of a scene.

    Args:
        rule: How large friction may be.
        table: A scene class, whose ``kind`` is that of the rule: its keys are the rule's numbers.

    Raises:
        ValueError: There is a rule of this kind.
    """
    FRICTION_LAWS.register(table)
    _REGISTERED[rule] = table


def unregister(rule: type[FrictionRule]) -> None:
    """Take out a rule that was registered."""
    FRICTION_LAWS.unregister(_REGISTERED.pop(rule))


def friction_rule(site: LawSite, normal: NormalLaw) -> FrictionRule:
    """The rule that the scene's contact names, by default Coulomb's; collective.

    Args:
        site: Where it acts.
        normal: The law across the contact.

    Raises:
        InputError: A value of the scene is negative somewhere, or it names a law of a user's that
            is not allowed or not there; on every rank.
    """
    given = site.contact.friction_law
    named = Coulomb.kind if given is None else given.kind
    known = next((rule for rule in (*RULES, *_REGISTERED) if rule.kind == named), None)
    made = known or own_law(named, UserFriction, f"{site.key}.friction_law.kind")
    return made(site, normal)
