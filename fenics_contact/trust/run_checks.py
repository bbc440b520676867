"""Checks of the physics on every run.

None asks a contact law for its own forces: the forces compared come from the bulk,
as nodal reactions (K u − f) or as boundary stress, so a wrong solution fails.

Some judge a solution whatever the laws of its contacts are. The others judge laws: each law of a
contact claims those that judge it, by their names in ``OF_LAWS``, and they see the contacts of
these laws alone. A new check is a line there, and its words in ``results/check_messages.py``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

from mpi4py import MPI

from fenics_contact.common.failures import attempt
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.convergence.unseen import unseen_contact
from fenics_contact.trust.cut_check import cyclic_symmetry
from fenics_contact.trust.finite.branch_checks import stable_equilibrium, volume_ratio
from fenics_contact.trust.friction_checks import (
    ComparedFriction,
    compared_friction,
    dissipation,
    friction_cone,
    friction_law,
    outer_loop,
    slip_limit,
)
from fenics_contact.trust.heat_checks import heat_balance
from fenics_contact.trust.normal_checks import (
    ComparedPressures,
    compared_pressures,
    complementarity,
    contact_law,
    penetration,
    penetration_depth,
    pressure_recovery,
    stick_creep,
    tension,
)
from fenics_contact.trust.resultant_checks import (
    action_and_reaction,
    boundary_stress,
    couplings,
    equilibrium,
    point_supports,
    preloads,
    resultant,
    stabilisation,
)


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution with the quantities that its checks compare.

    Attributes:
        forces: That the bulk needs.
        steps: Load steps taken.
    """

    forces: InternalForces
    steps: int

    @cached_property
    def friction(self) -> list[ComparedFriction]:
        """Compared quantities of contacts with friction; collective."""
        return compared_friction(self.forces)

    @cached_property
    def pressures(self) -> list[ComparedPressures]:
        """Compared quantities of contacts that push; collective."""
        return compared_pressures(self.forces)


class Claimed:
    """The part of a solution for a check of laws: the contacts whose laws claim it.

    Args:
        name: Of the check.
        solved: The solution.

    Attributes:
        forces: That the bulk needs.
        steps: Load steps taken.
        numbers: Of these contacts, in scene order.
    """

    def __init__(self, name: str, solved: Solved) -> None:
        self._name, self._solved = name, solved
        self.forces, self.steps = solved.forces, solved.steps
        contacts = enumerate(solved.forces.problem.contacts)
        self.numbers = [number for number, contact in contacts if name in contact.checks]

    @property
    def friction(self) -> list[ComparedFriction]:
        """Compared quantities of its contacts with friction; collective."""
        found = self._solved.friction if self.numbers else []
        return [compared for compared in found if self._name in compared.contact.checks]

    @property
    def pressures(self) -> list[ComparedPressures]:
        """Compared quantities of its contacts that push; collective."""
        found = self._solved.pressures if self.numbers else []
        return [compared for compared in found if self._name in compared.contact.checks]


# In the order of results and reports. First those that no law is asked for.
OF_EVERY_SOLUTION: Mapping[str, Callable[[Solved], Check | None]] = {
    "equilibrium": lambda solved: equilibrium(solved.forces),
    "resultant": lambda solved: resultant(solved.forces),
    "stabilisation": lambda solved: stabilisation(solved.forces),
    "point_support": lambda solved: point_supports(solved.forces),
    "preload": lambda solved: preloads(solved.forces),
    "coupling": lambda solved: couplings(solved.forces),
    "cyclic_symmetry": lambda solved: cyclic_symmetry(solved.forces),
    "action_and_reaction": lambda solved: action_and_reaction(solved.forces),
    "boundary_stress": lambda solved: boundary_stress(solved.forces),
    "unseen_contact": lambda solved: unseen_contact(solved.forces),
    "heat_balance": lambda solved: heat_balance(solved.forces),
    "slip_limit": lambda solved: slip_limit(solved.forces),
    "volume_ratio": lambda solved: volume_ratio(solved.forces),
    "stable_equilibrium": lambda solved: stable_equilibrium(solved.forces),
}
# Then those that laws claim.
OF_LAWS: Mapping[str, Callable[[Claimed], Check | None]] = {
    "friction_cone": lambda of: friction_cone(of.friction),
    "friction_law": lambda of: friction_law(of.friction),
    "outer_loop": lambda of: outer_loop(of.forces, of.numbers),
    "dissipation": lambda of: dissipation(of.friction),
    "stick_creep": lambda of: stick_creep(of.friction, of.steps),
    "contact_law": lambda of: contact_law(of.pressures),
    "complementarity": lambda of: complementarity(of.pressures),
    "tension": lambda of: tension(of.pressures),
    "penetration": lambda of: penetration(of.forces, of.pressures),
    "penetration_depth": lambda of: penetration_depth(of.forces, of.pressures, of.numbers),
    "pressure_recovery": lambda of: pressure_recovery(of.forces, of.pressures),
}


def run_checks(forces: InternalForces, steps: int = 1) -> dict[str, Check]:
    """All checks that the scene's terms call for; collective.

    A check that finds nothing to compare, such as friction where supports hold every
    contact point, is left out: it would pass whatever the solution.

    Raises:
        ValueError: A law claims a check that there is not.
    """
    found = all_checks(forces, steps)
    return {name: check for name, check in found.items() if check is not None}


def all_checks(forces: InternalForces, steps: int) -> dict[str, Check | None]:
    """Return all checks by name, None for those that find nothing to compare; collective."""
    for contact in forces.problem.contacts:
        unknown = sorted({*contact.checks} - {*OF_LAWS})
        if unknown:
            raise ValueError(f"a law of '{contact.label}' claims checks that are none: {unknown}")
    comm, solved = forces.problem.comm, Solved(forces, steps)
    every = {name: made(comm, partial(of, solved)) for name, of in OF_EVERY_SOLUTION.items()}
    for name, check in OF_LAWS.items():
        every[name] = made(comm, partial(check, Claimed(name, solved)))
    return every


def made(comm: MPI.Comm, check: Callable[[], Check | None]) -> Check | None:
    """A check; one that fails to be made is one that fails; collective."""
    notes: list[str] = []
    found = attempt(comm, "", check, None, notes)
    if not notes:
        return found
    why = notes[0].removeprefix(": ").removesuffix(".")
    return Check(value=math.nan, limit=0.0, unmade=why)
