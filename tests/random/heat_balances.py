"""Whether heat balances, by the temperatures of an answer alone.

Heat that flows into the nodes is assembled here from temperatures and conductivities, and what the
scene gives and the results say is held against it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray

from fenics_contact import Result, Run
from fenics_contact.common import form_cache

Array = NDArray[np.float64]
# Of all heat that flows into nodes; of the largest rise.
_HEAT, _RISE = 1e-5, 1e-9
# Of the heat that the temperatures would drive through a body of this size: less is none.
_NEGLIGIBLE = 1e-7


def heat_faults(solved: Run, result: Result) -> Iterator[str]:
    """Find where heat does not balance; collective.

    Args:
        solved: The run, with heat.
        result: What it found.

    Yields:
        Faults in words.
    """
    of = _Heat(solved)
    yield from _given(of)
    yield from _between(of)
    yield from _across(of, result)


class _Heat:
    """Temperatures, and heat into the nodes that comes from elsewhere than from films and fluxes.

    Attributes:
        rise: Temperature less the reference at the nodes (temperature).
        outside: Heat from given temperatures and across contacts at the nodes (power).
        scale: What heat is small against (power).
    """

    def __init__(self, solved: Run) -> None:
        self.scene, problem = solved.scene, solved.problem
        self.spaces, self.comm = problem.spaces, problem.spaces.comm
        self.body, self.time = self.spaces.body, self.scene.load_steps.last
        self.rise = np.array(problem.conduction.rise)
        self.reference = self.scene.material[0].reference_temperature
        self.own = slice(self.spaces.owned_nodes)
        space, self._scalars = self.spaces.scalar_space()
        place = ufl.SpatialCoordinate(self.body.mesh)
        self._weight = 2 * ufl.pi * place[0] if self.scene.kinematics == "axisymmetric" else 1.0
        rise, self._test = fem.Function(space), ufl.TestFunction(space)
        rise.x.array[self._scalars] = self.rise
        gradient = ufl.inner(ufl.grad(rise), ufl.grad(self._test))
        inside = self._at_nodes(self._conductivity() * gradient, self.spaces.bulk)
        given = np.zeros_like(inside)
        for heat in self.scene.heat:
            if heat.flux is not None:
                given += self._on(heat.on, heat.flux * heat.path(self.time))
            if heat.film is not None:
                around = (heat.film.temperature - self.reference) * heat.path(self.time)
                given += self._on(heat.on, heat.film.coefficient * (around - rise))
        self.outside = inside - given
        largest = max(float(np.ptp(self.comm.allgather(_ends(self.rise)))), self.most(self.rise))
        least = max(one.conductivity for one in self.scene.material) * largest
        length = max(self.comm.allgather(np.ptp(self.spaces.coordinates, axis=0).max()))
        least *= length ** (self.scene.dimension - 2) * _NEGLIGIBLE
        self.scale = max(self.sum(np.abs(inside)) + self.sum(np.abs(given)), least)

    def _conductivity(self) -> fem.Function:
        found = fem.Function(fem.functionspace(self.body.mesh, ("DG", 0)))
        for material in self.scene.material:
            cells = slice(None)
            if material.on:
                cells = self.body.entities(self.body.groups[material.on])
            found.x.array[cells] = material.conductivity
        return found

    def _on(self, name: str, inward: ufl.core.expr.Expr | float) -> Array:
        measure = self.spaces.boundary(self.body.groups[name])
        return self._at_nodes(inward * self._test, measure)

    def _at_nodes(self, density: ufl.core.expr.Expr, measure: ufl.Measure) -> Array:
        vector = fem.assemble_vector(form_cache.form(self._weight * density * measure))
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        return np.array(vector.array)[self._scalars]

    def on(self, name: str) -> NDArray[np.bool_]:
        """Whether each node of this rank lies on a boundary."""
        found = np.zeros(len(self.rise), dtype=bool)
        found[self.spaces.nodes(self.body.groups[name])] = True
        return found

    def sum(self, values: Array) -> float:
        """Over the nodes of all ranks."""
        return float(self.comm.allreduce(values[self.own].sum()))

    def most(self, values: Array) -> float:
        """The largest size over the nodes of all ranks."""
        return float(max(self.comm.allgather(np.abs(values[self.own]).max(initial=0.0))))

    @property
    def has_given(self) -> NDArray[np.bool_]:
        """Nodes whose temperature is given."""
        found = np.zeros(len(self.rise), dtype=bool)
        for heat in self.scene.heat:
            if heat.temperature is not None:
                found |= self.on(heat.on)
        return found


def _ends(values: Array) -> tuple[float, float]:
    return float(values.min(initial=0.0)), float(values.max(initial=0.0))


def _given(of: _Heat) -> Iterator[str]:
    """Nodes have the temperatures that the scene gives them, the first one where two meet."""
    done = np.zeros(len(of.rise), dtype=bool)
    for heat in of.scene.heat:
        if heat.temperature is None:
            continue
        expected = (heat.temperature - of.reference) * heat.path(of.time)
        here = of.on(heat.on) & ~done
        done |= here
        off = of.most(np.where(here, of.rise - expected, 0.0))
        if not off <= _RISE * of.most(of.rise):
            yield f"{heat.on}: temperatures are {off} off the given one"


def _between(of: _Heat) -> Iterator[str]:
    """No heat comes from elsewhere at a node that no contact touches and nothing is given at."""
    free = ~of.has_given
    for contact in of.scene.contact:
        if contact.conductance is not None:
            free &= ~of.on(contact.on) & ~of.on(contact.against)
    worst = of.most(np.where(free, of.outside, 0.0))
    if not worst <= _HEAT * of.scale:
        yield f"heat: {worst / of.scale:.1e} of all comes from nowhere"


def _across(of: _Heat, result: Result) -> Iterator[str]:
    """What a contact conducts into one body is what results say, and what the other one loses."""
    for number, contact in enumerate(of.scene.contact):
        if contact.conductance is None:
            continue
        told = result.contacts[number].quantities["heat_flow"]
        others = of.has_given
        for other in (*of.scene.contact[:number], *of.scene.contact[number + 1 :]):
            if other.conductance is not None:
                others |= of.on(other.on) | of.on(other.against)
        for name, sign in ((contact.on, 1), (contact.against, -1)):
            here = of.on(name)
            if of.most((here & others).astype(float)):
                continue  # the nodes there take heat from elsewhere, too
            found = sign * of.sum(np.where(here, of.outside, 0.0))
            if not abs(found - told) <= _HEAT * of.scale:
                yield f"{name}: takes in {found} of the contact, results say {told}"
