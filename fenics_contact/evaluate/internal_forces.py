"""Internal forces of an answer, against which contacts, loads and supports are measured.

By nodal values of the whole body (``nodal_forces``), or by what its contacts and its supports tell
alone (``condensed_forces``).

Contact pressure as a function on the surface: from the points, and from the reactions. That from
the reactions is independent of penalty and quadrature: the function whose nodal forces ∫ p N_i are
those that the bulk needs at the nodes (K u − f along the normal).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.noise import carries_more_than
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import BodyScalar, ScalarState
from fenics_contact.solve.systems.solution import Solution


def pressure_of_facets(contact: ContactSurface, state: ContactState) -> Array:
    """Pressure at the points as a function of the facets' space, (points,) (stress); collective.

    Quadratic triangles have more points than nodes: a part of the pressures that penalties make
    there gives no force at any node, and depends on where kinks between facets and the edge of
    contact happen to lie. The nearest function of the facets' space has the same forces without
    that part; it may be a little below 0 beside the edge. Where all points are nodes, and where the
    stiffness is that of a foundation, the pressure is that of the points.

    Args:
        contact: The contact.
        state: What happens at its points.
    """
    if contact.trace.nodal or not contact.has_penalty:
        return state.contact_pressure
    every = np.ones(len(contact.trace.weights), dtype=bool)
    return contact.trace.fitted(state.contact_pressure, every)


def pressure_of_facets_transposed(contact: ContactSurface, values: Array) -> Array:
    """Values times the transposed matrix of ``pressure_of_facets``, (points,); collective.

    It is a projection in the least squares of the points' weights.

    Args:
        contact: The contact.
        values: At the points, 0 but where this rank counts them, (points,).
    """
    trace = contact.trace
    if trace.nodal or not contact.has_penalty:
        return values
    shared, count = values / trace.weights, len(trace.nodes)
    shared[:count] = trace.surface.of_owners(trace.at_all_nodes(shared[:count]))[trace.numbers]
    every = np.ones(len(values), dtype=bool)
    return np.where(trace.owned, trace.weights * trace.fitted(shared, every), 0.0)


def reaction_pressure(contact: ContactSurface, needed: Array) -> Array:
    """Pressure at all nodes of a contact's surface, (nodes,) (stress); collective.

    Args:
        contact: The contact.
        needed: Forces that the bulk needs from it at its nodes, (nodes, components) (force).
    """
    normals = contact.trace.normals[: len(contact.nodes)]
    forces = np.zeros((len(contact.trace.all_nodes), 1))
    forces[contact.trace.numbers, 0] = -np.einsum("ij,ij->i", needed, normals)
    return traction_of(contact.trace.surface, forces)[:, 0]


def traction_of(surface: SurfaceSpace, forces: Array) -> Array:
    """Tractions t with ∫ t N_i = f_i for nodal forces on a surface, (nodes, columns); collective.

    Args:
        surface: The surface.
        forces: At all of its nodes, (nodes, columns) (force).
    """
    entries = surface.gathered_scalars(forces)
    # The same on all ranks, though their round-off may not be.
    found = from_root(surface.comm, surface.mass_factor.solve(entries))
    return surface.scattered_scalars(found)


@dataclass(frozen=True, eq=False)
class Balances:
    """Loads, reactions and contact forces in each connected part of a body, of all ranks.

    Attributes:
        resultants: Their sums, (parts, 3) (force).
        moments: Their moments about the part's centre over its size, likewise.
        carried: Sums of the sizes of their components, (parts,) (force).
    """

    resultants: Array
    moments: Array
    carried: Array


@dataclass(frozen=True)
class ScalarBalance:
    """Force on a scalar of the body.

    Attributes:
        scalar: Which one.
        asked: By the scene (force).
        found: That the body and the springs at it need (force).
        size: Of the part of the body (force).
    """

    scalar: BodyScalar
    asked: float
    found: float
    size: float


class InternalForces(ABC):
    """Internal forces of an answer, against the forces of loads and contacts.

    Attributes:
        problem: The model.
        solution: Its solution.
        load: The loads, (nodes, components) (force).
        contacts: Forces of all contacts on the body, likewise.
        across_cut: Forces across the cut faces of a sector, likewise; 0 without any.
        tells_inside: Whether displacements inside the body are known.
        rests: Whether nothing has inertia, so that loads, contacts and supports are in balance.
    """

    tells_inside: ClassVar[bool]
    rests: ClassVar[bool] = True

    def __init__(self, problem: Problem, solution: Solution) -> None:
        self.problem, self.solution = problem, solution
        self.load = problem.load
        self._given = solution.contact_force
        self.contacts = np.zeros_like(problem.load)
        for contact, force in zip(problem.contacts, self._given, strict=True):
            self.contacts += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
        self.across_cut = np.zeros_like(problem.load)
        self._pressures: dict[int, Array] = {}
        self._carries: dict[int, bool] = {}

    @property
    @abstractmethod
    def unbalanced(self) -> Array:
        """Forces that the bulk needs less loads and contacts, (nodes, components) (force).

        Where supports hold, reactions, or 0 where these are not known node by node.
        """

    @property
    @abstractmethod
    def displacement(self) -> Array:
        """Displacement of contacts and of held dofs at least, (nodes, components) (length)."""

    def scalar_balances(self) -> list[ScalarBalance]:
        """Balance of each of the body's scalars; collective."""
        problem, states = self.problem, self.scalar_states()
        rows = zip(problem.body_scalars, states, problem.pull_of_joints(states), strict=True)
        return [
            ScalarBalance(one, one.force, state.force + float(pull), abs(state.force))
            for one, state, pull in rows
        ]

    @property
    def left_open(self) -> float:
        """Work that stops between coupled faces leave open in a step (energy)."""
        return 0.0

    @property
    @abstractmethod
    def imbalance(self) -> float:
        """Force that may be out of balance: the imbalance accepted, or round-off (force)."""

    @property
    @abstractmethod
    def strain_energy(self) -> float:
        """½ a(e, e) of the elastic strain e: beyond what is free of stress (energy)."""

    @property
    def spring_energy(self) -> float:
        """In the springs of elastic supports (energy)."""
        return 0.0

    @property
    @abstractmethod
    def of_supports(self) -> Array:
        """Resultant of each applied support, (supports, components) (force).

        Where two meet, each has its part of what is needed there (``shared_reactions``).
        """

    @property
    @abstractmethod
    def moments_of_supports(self) -> Array:
        """Moment of the same forces of each, (supports, rotations) (force times length).

        About ``support_moments.centres`` of the problem: of the three axes in space, of one in the
        plane, of none in axisymmetric models.
        """

    @property
    @abstractmethod
    def of_all_supports(self) -> Array:
        """Resultant of all of them, (components,) (force)."""

    @property
    @abstractmethod
    def given_work(self) -> float:
        """Work of loads and reactions on the displacement, u · (f + r) (energy)."""

    @abstractmethod
    def at_points(self) -> dict[str, list[float]]:
        """The displacement at the scene's points, by quantity."""

    @abstractmethod
    def balances(self) -> Balances:
        """Resultants and moments that add up to zero in every connected part of the body."""

    @abstractmethod
    def at_stabilised(self) -> Array:
        """Reactions at dofs that a stabilisation holds, of this rank at least, (dofs,) (force)."""

    @abstractmethod
    def of_stress(self, number: int) -> Array:
        """∫ σ n over the slave surface of a contact, by its number, (components,) (force)."""

    @abstractmethod
    def scalar_states(self) -> tuple[ScalarState, ...]:
        """The body's scalars, with the forces on them that follow from the displacement."""

    @abstractmethod
    def works_since(self, before: InternalForces | None) -> tuple[float, float]:
        """Works of loads and reactions since another answer, by the trapezoidal rule (energy).

        Args:
            before: The other answer, of the same kind; None for the body at rest.
        """

    def acting(self, nodal: Array) -> Integers:
        """The nodes of this rank's own at which something is not 0.

        Args:
            nodal: (nodes, components).
        """
        owned, components = self.problem.spaces.owned_nodes, nodal.shape[1]
        return np.unique(np.flatnonzero(nodal[:owned]) // components)

    def at_contact(self, number: int) -> Array:
        """Forces that the bulk needs from a contact at its nodes, (nodes, components) (force).

        K u − f, less what other contacts give to a shared node.
        """
        return self.unbalanced[self.problem.contacts[number].nodes] + self._given[number]

    def _reactions_at(self, number: int) -> Array | float:
        """Reactions across a contact's surface at its nodes that ``unbalanced`` has not (force)."""
        return 0.0

    def _summed(self, values: Array) -> float:
        """Sum over the nodes of all ranks; collective."""
        owned = self.problem.spaces.owned_nodes
        return float(total(self.problem.comm, np.sum(values[:owned])))

    def pressure(self, number: int) -> Array:
        """``reaction_pressure`` of a contact, at all nodes of its surface (stress)."""
        if number not in self._pressures:
            forces = self.at_contact(number) + self._reactions_at(number)
            self._pressures[number] = reaction_pressure(self.problem.contacts[number], forces)
        return self._pressures[number]

    def carries(self, number: int) -> bool:
        """Whether a contact carries more than what solver and round-off leave."""
        if number not in self._carries:
            contact = self.problem.contacts[number]
            self._carries[number] = carries_more_than(contact, self.imbalance)
        return self._carries[number]


def own_dofs(problem: Problem) -> list[Integers]:
    """Dofs of each applied support that none before it holds (local, owned and ghost)."""
    counted = np.zeros(problem.load.size, dtype=bool)
    found = []
    for support in problem.applied_supports:
        found.append(support.dofs[~counted[support.dofs]])
        counted[found[-1]] = True
    return found
