"""Solutions on each rank: the contacts' state, and the body's answer when it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.state import ContactState
from fenics_contact.problem.scalar_unknown import ScalarState
from fenics_contact.results.records.steps import CycleEnd


@dataclass(frozen=True, eq=False)
class BodyAnswer:
    """Nodal values of this rank, each of shape (nodes, components), ghosts included.

    Attributes:
        displacement: u (length).
        internal_force: K u, from the bulk alone (force).
        round_off: Largest that round-off may leave of the balance inside the body; 0 where the
            imbalance has it already (force).
        mean_stress: At its dofs of this rank, of nearly incompressible bodies; else empty (stress).
    """

    displacement: Array
    internal_force: Array
    round_off: float = 0.0
    mean_stress: Array = field(default_factory=lambda: np.zeros(0))


# Gives it; collective.
FindBody = Callable[[], BodyAnswer]


class LazyDisplacement:
    """Finds the answer when it is asked for first, and then forgets what finds it.

    Args:
        find: Collective. It also sets the problem's functions to the answer.
    """

    def __init__(self, find: FindBody) -> None:
        self._find: FindBody | None = find
        self._found: BodyAnswer | None = None

    def __call__(self) -> BodyAnswer:
        """The answer; collective."""
        if self._find is not None:
            self._found, self._find = self._find(), None
        assert self._found is not None
        return self._found


@dataclass(frozen=True, eq=False)
class Solution:
    """Nodal values of this rank, each of shape (nodes, components), ghosts included.

    Attributes:
        find_body: Gives what is inside the body; collective.
        normal_force: Force on the body across each contact, from penalty or foundation, at
            its nodes; one array a contact, without prescribed pressures, which are loads
            (force). Where bonded it is the whole force.
        friction_force: Force of the friction law on the body, likewise (force).
        friction_bound: That friction was solved with, at the points of each contact (stress).
        states: What happens at the points of each contact.
        residual_history: Force imbalance before every Newton step and at the end (force).
        newton_iterations: Newton steps taken since the load step before, also by tries that were
            rejected.
        outer_iterations: Passes of the loop on the contact pressure, 0 without one.
        strategy: How friction and pressure were brought together, in words.
        factorisations: How often the bulk was factorised so far.
        contraction: Of the loop on the contact pressure, by which a pass multiplies
            differences, estimated; None where there were not two passes.
        attempts: Strategies that did not converge before, each with what happened.
        imbalance_limit: The imbalance that was accepted as converged (force).
        scalars: Force on each of the body's scalars, and its value, the same on every rank.
        cycle: What the cycle of loads that ends with it has brought, if one does.
        unstable_motions: In finite strains, how many motions grow by themselves; None where that
            is not known.
    """

    find_body: FindBody
    normal_force: list[Array]
    friction_force: list[Array]
    friction_bound: list[Array]
    states: list[ContactState]
    residual_history: tuple[float, ...]
    newton_iterations: int
    outer_iterations: int
    strategy: str
    imbalance_limit: float
    factorisations: int
    contraction: float | None = None
    attempts: tuple[str, ...] = ()
    scalars: tuple[ScalarState, ...] = ()
    cycle: CycleEnd | None = None
    unstable_motions: int | None = None

    @property
    def displacement(self) -> Array:
        """Displacement (length); collective."""
        return self.find_body().displacement

    @property
    def internal_force(self) -> Array:
        """Forces K u, from the bulk alone (force); collective."""
        return self.find_body().internal_force

    @property
    def mean_stress(self) -> Array:
        """Mean stress of nearly incompressible bodies; else empty (stress); collective."""
        return self.find_body().mean_stress

    @property
    def work_on_scalars(self) -> float:
        """∑ N q of the forces N on the body's scalars q: twice their part of the strain energy.

        Without those whose work is that of nodal forces.
        """
        return float(sum(state.force * state.value for state in self.scalars if state.works))

    @property
    def bulk_round_off(self) -> float:
        """Largest that round-off may leave of the balance inside the body (force); collective."""
        return self.find_body().round_off

    @property
    def contact_force(self) -> list[Array]:
        """Both forces of each contact together (force)."""
        return [a + b for a, b in zip(self.normal_force, self.friction_force, strict=True)]
