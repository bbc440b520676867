"""The laws along a contact: frictionless, static, incremental, stick.

The paper's (1.6) and (2.6) to (2.8). A new law is a class and a line in ``LAWS``.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.rules import friction_rule
from fenics_contact.contact.laws.friction.slip_laws import Frictionless, Incremental, Static, Stick
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite

LAWS: tuple[type[FrictionLaw], ...] = (
    Frictionless,
    Static,
    Incremental,
)


def friction_law(site: LawSite, normal: NormalLaw) -> FrictionLaw:
    """The law along a contact that the scene names; collective.

    Where the coefficient, or a pressure that is given, is 0 everywhere, there is no friction.

    Args:
        site: Where it acts.
        normal: The law across the contact.

    Raises:
        InputError: A coefficient is negative; on every rank.
    """
    rule, comm = friction_rule(site, normal), site.trace.spaces.comm
    if normal.sticks:
        return Stick(site, normal, rule)
    named = next(law for law in LAWS if law.kind == site.contact.law)
    if not normal.pressure_is_known:
        is_smooth = largest(comm, rule.largest_coefficient) == 0
        return (Frictionless if is_smooth else named)(site, normal, rule)
    pressure = normal.pressure(np.zeros_like(site.trace.normals))
    is_smooth = largest(comm, rule.at(pressure)) == 0
    return (Frictionless if is_smooth else named)(site, normal, rule)
