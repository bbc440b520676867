"""How large friction may be, a file a rule: Coulomb's, by pressure, by slip, with micro-slip, ….

A new rule is a file of its own, a line in ``RULES`` and a class in ``scene/laws/friction_laws.py``.
"""

from __future__ import annotations

from fenics_contact.contact.laws.allowed import own_law
from fenics_contact.contact.laws.friction.rules.by_pressure import ByPressure
from fenics_contact.contact.laws.friction.rules.by_slip import BySlip
from fenics_contact.contact.laws.friction.rules.by_speed import BySpeed
from fenics_contact.contact.laws.friction.rules.compliance import Compliance
from fenics_contact.contact.laws.friction.rules.coulomb import Coulomb
from fenics_contact.contact.laws.friction.rules.micro_slip import MicroSlip
from fenics_contact.contact.laws.friction.rules.nonlocal_friction import Nonlocal
from fenics_contact.contact.laws.friction.rules.orthotropic import Orthotropic
from fenics_contact.contact.laws.friction.rules.own_bound import FormulaBound, UserFriction
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.laws.friction_laws import FRICTION_LAWS
from fenics_contact.scene.laws.law_tables import FrictionLawTable

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
