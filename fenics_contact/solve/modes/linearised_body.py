"""Small changes about a state: K with the tangents of all contacts, by the kept factorisation."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem


class LinearisedBody:
    """A body by the tangents that its contacts have; collective, as all its methods.

    Args:
        system: In the state.
        body: Its body.
    """

    def __init__(self, system: CondensedSystem, body: CondensedBody) -> None:
        self._system, self._body = system, body
        system.linearise(system.state)

    def solve(self, nodal: Array) -> Array:
        """Change of the displacement by small forces.

        Args:
            nodal: At the nodes of this rank, (nodes, components) (force).

        Returns:
            Likewise (length); 0 where supports hold.
        """
        system, body = self._system, self._body
        load = body.stiffness.load(nodal, np.zeros_like(nodal), body.held)
        condensed = body.bulk.condense(load)
        on_scalars = body.scalars.from_loads(load, np.zeros_like(load))
        at_contacts, scalars = system.change(condensed, on_scalars)
        for value, one in zip(scalars, body.scalars.loads, strict=True):
            load += value * one
        return body.stiffness.at_nodes(body.bulk.expand(load, at_contacts))
