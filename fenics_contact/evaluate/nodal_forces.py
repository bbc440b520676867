"""Nodal forces that the bulk needs, each worked out once for a solution."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import ufl

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, in_3d
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.contact_quantities import resultant
from fenics_contact.evaluate.internal_forces import Balances, InternalForces, own_dofs
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarState
from fenics_contact.solve.systems.solution import Solution


def stress_on(spaces: Spaces, elastic: ElasticBody, group: Group) -> ufl.Form:
    """∫ σ n · v over a group of facets, in UFL: over a constant v, a resultant (force)."""
    size, test = spaces.components, ufl.TestFunction(spaces.displacement_space)
    stress, normal = elastic.nominal_stress(), ufl.FacetNormal(spaces.body.mesh)
    traction = [sum(stress[i, j] * normal[j] for j in range(size)) for i in range(size)]
    measure = spaces.boundary(group)
    return spaces.weight * ufl.dot(ufl.as_vector(traction), test) * measure


class BulkForces(InternalForces):
    """Internal forces from nodal values of the whole body; collective, as all."""

    tells_inside = True

    def __init__(self, problem: Problem, solution: Solution) -> None:
        super().__init__(problem, solution)
        self._unbalanced = solution.internal_force - problem.load - self.contacts
        if problem.discrete.cut is not None:
            self.across_cut = problem.discrete.cut.forces(self._unbalanced)
            self._unbalanced = self._unbalanced - self.across_cut
        self.load = problem.load - problem.feet.load
        #: Forces of the springs of each elastic support on the body, (nodes, components).
        self.of_springs = [foot.forces(solution.displacement) for foot in problem.feet]
        self._feet = [foot.displacement for foot in problem.feet]
        #: Forces of points on faces that they are coupled with and that stay elastic, by number of
        #: the applied support, (nodes, components) each.
        self.of_points = problem.forces_of_points(solution.scalars)

    @property
    def unbalanced(self) -> Array:
        """Forces that the bulk needs less loads and contacts, (nodes, components) (force).

        Less those across the cut of a sector, too: where a node follows from one of the other face,
        what is left is at that one.
        """
        return self._unbalanced

    @property
    def displacement(self) -> Array:
        """Displacement of all nodes, (nodes, components) (length)."""
        return self.solution.displacement

    @cached_property
    def reactions(self) -> Array:
        """Reactions of supports at the nodes, (nodes, components) (force).

        0 at free dofs where no springs act, and no coupling.
        """
        every = [self._rigid_reactions, *self.of_springs, *self.of_points.values()]
        return np.asarray(np.add.reduce(every))

    @property
    def _rigid_reactions(self) -> Array:
        """Reactions where supports hold dofs, (nodes, components) (force)."""
        return np.where(self.problem.free, 0.0, self.unbalanced)

    @cached_property
    def imbalance(self) -> float:
        """Force that may be out of balance: the imbalance accepted, or round-off (force).

        Inside the body the condensed solver measures none. What is left there counts as far as
        round-off of K u may make it, so that a state out of balance is none.
        """
        problem, solution = self.problem, self.solution
        inside = self.unbalanced.copy().reshape(-1)
        inside[problem.constrained] = 0.0
        owned = problem.spaces.owned_nodes * problem.spaces.components
        left = float(total(problem.comm, np.abs(inside[:owned]).sum()))
        return max(solution.imbalance_limit, min(left, solution.bulk_round_off))

    @cached_property
    def strain_energy(self) -> float:
        """½ a(e, e) of the elastic strain e: beyond what is free of stress (energy).

        In finite strains ∫ Ψ(F).
        """
        solution, elastic = self.solution, self.problem.elastic
        if isinstance(elastic, HyperelasticBody):
            return elastic.energy_at(solution.displacement)
        product = self._summed(solution.displacement * solution.internal_force)
        for foot in self.problem.feet:  # K has their springs, too
            pull = foot.springs.pull(solution.displacement)
            product -= self._summed(solution.displacement * pull)
        return 0.5 * (product + solution.work_on_scalars)

    @property
    def spring_energy(self) -> float:
        """In the springs of elastic supports, and between coupled faces."""
        at_feet = sum(foot.energy(self.displacement) for foot in self.problem.feet)
        return at_feet + self._energy_of_joints

    @property
    def _scalars(self) -> Array:
        """Values of the body's scalars (length)."""
        return np.array([state.value for state in self.solution.scalars], dtype=np.float64)

    @property
    def _energy_of_joints(self) -> float:
        """Elastic energy of the springs between coupled faces (energy)."""
        return self.problem.elastic.joints.energy(self._scalars)

    @property
    def _pull_of_joints(self) -> Array:
        """Forces of springs between coupled faces on these (force)."""
        return self.problem.pull_of_joints(self.solution.scalars)

    @cached_property
    def of_supports(self) -> Array:
        """Resultant of each applied support, (supports, components) (force)."""
        problem, needed = self.problem, self.unbalanced.reshape(-1)
        spaces = problem.spaces
        owned = spaces.owned_nodes * spaces.components
        rows = problem.shared_reactions.moved(needed, self.solution.displacement)
        for row, dofs in zip(rows, own_dofs(problem), strict=True):
            mine = dofs[dofs < owned]
            by_node = np.zeros((len(mine), spaces.components))
            by_node[np.arange(len(mine)), mine % spaces.components] = needed[mine]
            row += resultant(spaces, by_node)
        own = slice(spaces.owned_nodes)
        for foot, force in zip(problem.feet, self.of_springs, strict=True):
            rows[foot.springs.support] += resultant(spaces, force[own])
        for number, force in self.of_points.items():
            rows[number] += resultant(spaces, force[own])
        return rows

    @cached_property
    def moments_of_supports(self) -> Array:
        """Moment of each applied support, (supports, rotations) (force times length)."""
        problem, needed = self.problem, self.unbalanced.reshape(-1)
        turned, shared = problem.support_moments.of_unit_rotations, problem.shared_reactions
        owned = problem.spaces.owned_nodes * problem.spaces.components
        every = [dofs[dofs < owned] for dofs in own_dofs(problem)]
        works = [turned(number, dofs) @ needed[dofs] for number, dofs in enumerate(every)]
        ways = [turned(number, shared.dofs) for number in range(len(every))]
        found: Array = total(problem.comm, np.array(works))
        found += shared.moved_along(ways, needed, self.solution.displacement)
        springs = zip(problem.feet, self.of_springs, strict=True)
        spread = [(foot.springs.support, force) for foot, force in springs]
        for number, force in (*spread, *self.of_points.items()):
            way = turned(number, np.arange(owned))
            found[number] += total(problem.comm, way @ force.reshape(-1)[:owned])
        return found + 0.0  # no −0

    @property
    def of_all_supports(self) -> Array:
        """Resultant of all supports, without couplings, (components,) (force)."""
        spaces, couplings = self.problem.spaces, self.problem.couplings
        found = resultant(spaces, self.reactions[: spaces.owned_nodes])
        return found - self.of_supports[couplings].sum(axis=0) if couplings.size else found

    @property
    def given_work(self) -> float:
        """Work of loads and reactions on the displacement; of springs on that of their foot.

        What springs between coupled faces take of that of couplings is given, too.
        """
        given = self._summed(self.displacement * (self.load + self._rigid_reactions))
        given += float(self._scalars @ self._pull_of_joints)
        at_feet = zip(self._feet, self.of_springs, strict=True)
        return given + sum(self._summed(moved * force) for moved, force in at_feet)

    def at_points(self) -> dict[str, list[float]]:
        """The displacement at the scene's points, by quantity."""
        return self.problem.points.quantities(self.displacement)

    def balances(self) -> Balances:
        """Resultants and moments that add up to zero in every connected part of the body.

        The reactions come from the bulk, which balances itself, so whatever a wrong solution leaves
        on free nodes shows here.
        """
        spaces = self.problem.spaces
        parts, owned = spaces.parts, spaces.owned_nodes
        applied = (self.load + self.reactions + self.contacts + self.across_cut)[:owned]
        forces = np.zeros((owned, 3))
        forces[:, : spaces.components] = applied
        arms = parts.arms[:owned]
        if not self.problem.elastic.is_linear:  # forces balance where they act now
            arms = arms + in_3d(self.displacement[:owned])
        moments = np.cross(arms, forces) / parts.sizes[parts.of_node[:owned], None]
        sums = parts.sums(np.hstack([forces, moments, np.abs(applied).sum(axis=1)[:, None]]))
        return Balances(sums[:, :3], sums[:, 3:6], sums[:, 6])

    def at_stabilised(self) -> Array:
        """Reactions at dofs that a stabilisation holds (force)."""
        held = [support.dofs for support in self.problem.stabilisation]
        return self.unbalanced.reshape(-1)[np.concatenate(held)]

    def of_stress(self, number: int) -> Array:
        """∫ σ n over the slave surface of a contact, by its number (force)."""
        spaces = self.problem.spaces
        group = self.problem.contacts[number].sides.group
        form = form_cache.form(stress_on(spaces, self.problem.elastic, group))
        owned = spaces.assemble(form)[: spaces.owned_nodes]
        return np.asarray(total(spaces.comm, owned.sum(axis=0)))

    def scalar_states(self) -> tuple[ScalarState, ...]:
        """The body's scalars, with the forces on them that follow from the displacement."""
        return self.problem.scalar_states(self.displacement)

    def works_since(self, before: InternalForces | None) -> tuple[float, float]:
        """Works of loads and reactions since another answer, by the trapezoidal rule (energy).

        Those of springs act at their foot.
        """
        pulls, feet = self.of_springs, self._feet
        loads, reactions, moved = self.load, self._rigid_reactions, self.displacement
        if before is not None:
            assert isinstance(before, BulkForces)
            loads, reactions = before.load + loads, before._rigid_reactions + reactions
            moved = moved - before.displacement
            pulls = [one + other for one, other in zip(before.of_springs, pulls, strict=True)]
            feet = [other - one for one, other in zip(before._feet, feet, strict=True)]
        works = [self._summed(pull * foot) for pull, foot in zip(pulls, feet, strict=True)]
        stored = self._energy_of_joints - (before._energy_of_joints if before is not None else 0.0)
        works.append(2 * stored)
        held = self._summed(reactions * moved) + sum(works)
        return 0.5 * self._summed(loads * moved), 0.5 * held
