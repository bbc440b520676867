"""A body about a state in which all its contacts stick: K with their tangents."""

from __future__ import annotations

from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.modes.linearised_body import LinearisedBody


class StuckBody(LinearisedBody):
    """Small changes about a state, at the begin of a load step; collective, as all its methods.

    Points that carry pressure are held by the stiffness of contact, and of friction before anything
    slips. Those that carry none are free.

    Args:
        system: In the state, of which friction counts slip from there on.
        body: Its body.
    """

    def __init__(self, system: CondensedSystem, body: CondensedBody) -> None:
        system.problem.stick_all()
        super().__init__(system, body)
