"""Slaves that follow masters which are slaves of other contacts, as in a seat or behind a plate.

The factor of the zone has K_c of every slave as if its master were held. Where the master is in the
zone itself, moving it alone would open the contact against 1/ε₁. So it carries its slaves with it:
with u = w + P u' in the zone, K_c acts on w alone, and the factor stays as sparse as it is. What it
then lacks is the stiffness of the slave's own body against being carried, which is none of 1/ε₁.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.iterative.contact_matrix import ContactMatrix
from fenics_contact.solve.iterative.contact_zone import slave_nodes


@dataclass(frozen=True, eq=False)
class _Links:
    """Links from contacts to those whose masters carry their slaves.

    Attributes:
        order: Numbers of the contacts whose slaves are carried, those first that carry others.
        refusal: Why that is not possible for all of them, empty where it is.
    """

    order: tuple[int, ...]
    refusal: str


class CarriedSlaves:
    """u = T y of displacements in the zone; collective, as all it has.

    Args:
        problem: The problem.
        contacts: Their tangents.
    """

    def __init__(self, problem: Problem, contacts: ContactMatrix) -> None:
        self._pairs = [contacts.pair_dofs(number) for number in _links(problem).order]

    @property
    def are_any(self) -> bool:
        """Whether T is not 1."""
        return bool(self._pairs)

    def carry(self, displacement: Array, inside: Flags) -> Array:
        """T y.

        Args:
            displacement: y of this rank's own dofs, 0 outside the zone.
            inside: Which of these are in the zone.
        """
        found = displacement.copy()
        for pair in self._pairs:
            _, opposite = pair.motions(found)
            found += np.where(inside, pair.on_body(opposite, None), 0.0)
        return found

    def collect(self, forces: Array, inside: Flags) -> Array:
        """Tᵀ f: forces on slaves also move what carries them.

        Args:
            forces: On this rank's own dofs, 0 outside the zone.
            inside: Which of these are in the zone.
        """
        found = forces.copy()
        for pair in reversed(self._pairs):
            given, _ = pair.motions(found)
            found += np.where(inside, pair.on_body(None, pair.handed_over(given)), 0.0)
        return found


def cannot_be_carried(problem: Problem) -> str:
    """Why the iterative solver is not for the contacts of a problem, empty if it is; collective."""
    return _links(problem).refusal


def _links(problem: Problem) -> _Links:
    """Links between contacts, by nodes that are free; collective."""
    contacts = {number: c for number, c in enumerate(problem.contacts) if c.forces.terms}
    slaves = {number: slave_nodes(contact) for number, contact in contacts.items()}
    masters = {
        number: contact.kinematics.pairing.faced_masters()
        for number, contact in contacts.items()
        if contact.kinematics.pairing is not None
    }
    owned = problem.spaces.owned_nodes
    free = problem.free.any(axis=1) if problem.free.ndim > 1 else problem.free

    def meet(one: Flags, other: Flags) -> bool:
        return bool(total(problem.comm, int((one & other & free)[:owned].sum())) > 0)

    carriers = {
        number: [other for other in contacts if other != number and meet(slaves[other], nodes)]
        for number, nodes in masters.items()
    }
    carried = [number for number, found in carriers.items() if found]
    order: list[int] = []
    while more := [
        number
        for number in carried
        if number not in order
        and all(other in order or other not in carried for other in carriers[number])
    ]:
        order += more
    ring = [number for number in carried if number not in order]
    twice = [
        number
        for number in order
        if any(other != number and meet(slaves[other], slaves[number]) for other in contacts)
    ]
    if ring:
        return _Links(tuple(order), _named(problem, ring, "are each other's masters in a ring"))
    if twice:
        words = "have slaves that other contacts share, and masters that are slaves themselves"
        return _Links(tuple(order), _named(problem, twice, words))
    return _Links(tuple(order), "")


def _named(problem: Problem, numbers: Sequence[int], words: str) -> str:
    names = ", ".join(f"'{problem.contacts[number].label}'" for number in numbers)
    return f"surfaces of the contacts {names} {words}"
