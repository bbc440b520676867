"""Parts of a body and its loads that a mesh misses, as forces and energies.

That is what lies between facets and the curves that they stand for, and what functions that loads
are given by are between nodes.

A body with straight cells lacks its own weight there, stiffness, and length of sides that loads
act on. Where the curve lies outside of facets by d, ½ a(v, v) lacks ½ ∫ d σ(v) : e(v) on them,
but for higher order. Where a side is held, displacements vanish on the curve and not on facets:
that is so much less, not more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.mesh.missed_pressure import (
    MissedPressure,
    missed_pressure,
)


@dataclass(frozen=True)
class MissedForces:
    """Forces of the missed parts, and their work on a solution.

    Attributes:
        nodal: All forces, (nodes, components) (force).
        elastic: Work of those by missed stiffness on the displacement (energy).
        loads: Work of those by missed loads on it (energy).
    """

    nodal: Array
    elastic: float
    loads: float


class MissedBody:
    """Parts of a body and its loads that the mesh misses; collective.

    The outer boundary of a half-space is none of a body's: it moves as the far field does there.

    Args:
        problem: The model.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        outer = problem.scene.half_space
        names = () if outer is None else outer.on
        groups = [problem.body.group(name, "half_space.on") for name in names]
        self._sides = CurvedSides(problem.spaces, groups)

    @property
    def is_none(self) -> bool:
        """Whether nothing is missed."""
        problem = self._problem
        functions = not all(load.acting.is_constant for load in problem.loads)
        functions |= any(callable(contact.pressure) for contact in problem.scene.contact)
        return self._sides.offset is None and not functions

    def forces(self, solution: Solution, time: float) -> MissedForces:
        """Forces that move a solution as what is missed does; collective.

        Args:
            solution: Of the problem, which is in its state.
            time: Its pseudo-time.
        """
        spaces, moved = self._problem.spaces, solution.displacement
        loads = np.zeros_like(moved)
        for load in self._problem.loads:
            loads += load.path(time) * self._of_load(load.acting)
        for number in range(len(self._problem.contacts)):
            pressure = self.of_pressure(number, time)
            loads += 0.0 if pressure is None else pressure.nodal
        elastic = np.zeros_like(moved) if self._sides.offset is None else self._elastic()
        owned = slice(0, spaces.owned_nodes)
        works = [np.sum((moved * found)[owned]) for found in (elastic, loads)]
        done = total(self._problem.comm, np.array(works))
        return MissedForces(elastic + loads, float(done[0]), float(done[1]))

    def _of_load(self, load: ActingLoad) -> Array:
        """Nodal forces of a load missed, where its path is 1."""
        spaces = self._problem.spaces
        test = ufl.TestFunction(spaces.displacement_space)
        found = np.zeros_like(self._problem.load)
        if not load.is_constant:
            for sign, whole in ((1.0, load.as_given()), (-1.0, load)):
                found += sign * spaces.assemble(form_cache.form(whole.work(test)))
        if self._sides.offset is not None:
            found += spaces.assemble(form_cache.form(load.missed_work(test, self._sides)))
        return found

    def of_pressure(self, number: int, time: float) -> MissedPressure | None:
        """Return the missed part of a contact's given pressure; None for nothing; collective."""
        return missed_pressure(self._problem.contacts[number], self._sides, time)

    def longer(self, number: int) -> float:
        """How far a contact's surface is from what its points stand for, over this; collective.

        By what cells miss of a curve, and by what the rule of the points misses of curved cells:
        Simpson's rule of a parabola through three points of a circle falls short by as much as this
        parabola does, so that counts twice.
        """
        spaces, sides = self._problem.spaces, self._sides
        if sides.offset is None and spaces.geometry_order == 1:
            return 0.0
        trace = self._problem.contacts[number].trace
        parts = [spaces.weight * spaces.boundary(trace.group)]
        if sides.offset is not None:
            within = sides.measure(sides.within(trace.group))
            parts.append(spaces.weight * sides.stretch * within)
        found = [float(fem.assemble_scalar(form_cache.form(part))) for part in parts]
        whole, *more = total(self._problem.comm, np.array(found))
        missed = 2 * abs(whole - trace.area) + abs(sum(more))
        return float(missed / trace.area)

    def _elastic(self) -> Array:
        """Nodal forces of the stiffness missed, in the state of the solution."""
        problem, sides = self._problem, self._sides
        spaces, elastic = problem.spaces, problem.elastic
        test = ufl.TestFunction(spaces.displacement_space)
        density = spaces.weight * sides.offset
        density *= ufl.inner(elastic.stress(), elastic.strain(test))
        held = sides.held(problem.free) | self._glued()
        of_held, of_others = (
            spaces.assemble(form_cache.form(density * sides.measure(chosen)))
            for chosen in (held, ~held)
        )
        return of_held - of_others

    def _glued(self) -> Flags:
        """Return for each facet whether it is glued to an obstacle."""
        found = np.zeros(len(self._sides.facets), dtype=bool)
        for contact in self._problem.contacts:
            if contact.normal.sticks and contact.contact.obstacle is not None:
                found |= self._sides.within(contact.trace.group)
        return found
