"""The error of the temperature in every cell, where conduction finds it.

From local problems as for displacements (``local_problems``): the error e of a cell K solves,
among the bubbles w of one degree more, ∫ k ∇e·∇w = −∫ k ∇T·∇w + ∫_∂K q w. There the flux q is the
mean of the two cells at a facet, what acts on the boundary, and of the cell itself where the
temperature is given. Across contacts it is the flux whose heat at the nodes is that of the contact,
through films h (T∞ − T), which the error changes as well: there the left side has ∫ h e w.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray
from ufl.core.expr import Expr

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.evaluate.internal_forces import traction_of
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.conduction.conduction import Conduction
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.error_estimates.mesh.bubbles import bubble_element

# What one degree more adds to the integrands over the body's own.
_MORE = 2


class HeatErrors:
    """Local problems of conduction; what is compiled and assembled serves any temperatures.

    Attributes:
        error: Of the temperature, 0 at the nodes (temperature).
        rise: Temperature less the reference, as it was found (temperature).

    Args:
        problem: The model.
        conduction: In it.
    """

    def __init__(self, problem: Problem, conduction: Conduction) -> None:
        self._spaces, self._conduction, self._problem = problem.spaces, conduction, problem
        mesh, bodies = problem.spaces.body.mesh, conduction.bodies
        space = fem.functionspace(mesh, bubble_element(problem.spaces))
        self._cells = mesh.topology.index_map(mesh.topology.dim).size_local
        self._count = space.dofmap.list.shape[1]
        self._blocks = space.dofmap.list[: self._cells, 0] // self._count  # of every cell
        self.error, self.rise = fem.Function(space), fem.Function(bodies.space)
        self._flux = fem.Function(bodies.space)
        self._rule = {"quadrature_degree": problem.spaces.bulk_degree + _MORE}
        self._test = ufl.TestFunction(space)
        self._stiffness = self._stiffnesses(ufl.TrialFunction(space))
        self._found = np.zeros((self._cells, self._count))
        self._residual = form_cache.form(self._work(self.rise, self.rise, self._test, self._test))
        self._films = [
            form_cache.form(-film.coefficient * self._on(film.on, self.rise * self._test))
            for film in bodies.films
        ]
        self._flows = [
            (form_cache.form(self._on(flow.on, flow.inward * self._test)), flow.path)
            for flow in bodies.flows
        ]
        self._contacts = [
            (trace, form_cache.form(self._on(trace.group, self._flux * self._test)))
            for one in conduction.contacts
            for trace in _traces(one.contact.trace, one.contact.sides.opposite)
        ]
        self._response = self._response_of(ufl.TestFunction(bodies.space))

    def solve(self, states: Sequence[ContactState]) -> None:
        """Find the errors of the present temperatures; collective.

        Args:
            states: Of all contacts.
        """
        conduction = self._conduction
        bodies = conduction.bodies
        self.rise.x.array[bodies.scalar_of_node] = conduction.rise
        right = self._assembled(self._residual)
        for form in self._films:
            right += self._assembled(form)
        for form, path in self._flows:
            right += path(conduction.time) * self._assembled(form)
        for (trace, form), heat in zip(self._contacts, self._across(states), strict=True):
            self._set_flux(trace, heat)
            right += self._assembled(form)
        self._found = np.linalg.solve(self._stiffness, right[:, :, None])[:, :, 0]
        self.take_signs(None)

    def take_signs(self, signs: Array | None) -> None:
        """Give the errors of cells random signs; collective.

        Args:
            signs: Of this rank's own cells, (cells,); None for the errors as they are.
        """
        found = self._found
        if signs is not None:
            ordered = np.empty(self._cells)
            ordered[self._blocks] = signs
            found = ordered[:, None] * found
        self.error.x.array[: found.size] = found.reshape(-1)
        self.error.x.scatter_forward()

    def heat(self) -> Array:
        """Heat that moves the temperatures at the nodes as the errors do; collective.

        As forces do of ``LocalErrors``, of all ranks, (nodes,) (power).
        """
        bodies = self._conduction.bodies
        return np.add.reduce([bodies.nodal(form) for form in self._response])

    def at_points(self) -> dict[str, float]:
        """Errors of temperatures at the scene's points, besides those of nodes; collective."""
        found = self._problem.points.of_function(self.error)
        return {name: float(np.linalg.norm(error)) for name, error in found.items()}

    def _across(self, states: Sequence[ContactState]) -> list[Array]:
        """Heat into the nodes of this rank, for each surface of ``_contacts``; collective."""
        numbers, found = self._conduction.bodies.numbers, []
        for contact, heat in self._conduction.across(states):
            sides = _traces(contact.trace, contact.sides.opposite)
            found += [heat[numbers]] * len(sides)
        return found

    def _set_flux(self, trace: Trace, heat: Array) -> None:
        surface = trace.surface
        flux = surface.on_body(traction_of(surface, heat[surface.body_nodes, None]))
        self._flux.x.array[self._conduction.bodies.scalar_of_node] = flux[:, 0]

    def _stiffnesses(self, trial: Expr) -> Array:
        """Matrix of every cell of this rank, (cells, dofs, dofs)."""
        bodies, mesh = self._conduction.bodies, self._spaces.body.mesh
        weighted = self._spaces.weight * bodies.conductivity
        work = weighted * ufl.inner(ufl.grad(trial), ufl.grad(self._test))
        forms = [work * ufl.dx(mesh, metadata=self._rule)]
        for film in bodies.films:
            forms.append(film.coefficient * self._on(film.on, trial * self._test))
        found = np.zeros((self._cells, self._count, self._count))
        for form in forms:
            data = fem.assemble_matrix(form_cache.form(form)).to_scipy().data
            found += data.reshape(-1, self._count, self._count)[: self._cells]
        return found

    def _on(self, group: Group, integrand: Expr) -> ufl.Form:
        """Integral over a boundary, weighted."""
        spaces = self._spaces
        found: ufl.Form = spaces.weight * integrand * spaces.boundary(group, self._rule)
        return found

    def _work(self, rise: Expr, within: Expr, against: Expr, tested: Expr) -> ufl.Form:
        """−∫ k ∇T·∇w and fluxes on w: means between cells, own ones where T is given.

        Args:
            rise: T on facets.
            within: T inside cells.
            against: w inside cells.
            tested: w on facets.
        """
        spaces, mesh = self._spaces, self._spaces.body.mesh
        normal = ufl.FacetNormal(mesh)
        weighted = spaces.weight * self._conduction.bodies.conductivity
        flux, rule = weighted * ufl.grad(rise), self._rule
        measure = ufl.Measure("ds", mesh, subdomain_data=[(1, self._held())], metadata=rule)
        between = ufl.dot(ufl.avg(flux), normal("+")) * ufl.jump(tested)
        return (
            -weighted * ufl.inner(ufl.grad(within), ufl.grad(against)) * ufl.dx(mesh, metadata=rule)
            + between * ufl.dS(mesh, metadata=rule)
            + ufl.dot(flux, normal) * tested * measure(1)
        )

    def _response_of(self, test: Expr) -> list[fem.Form]:
        """What the errors do to the nodes; on contacts their flux is taken for the cell's own."""
        bodies = self._conduction.bodies
        work = [self._work(test, self.error, test, self.error)]
        normal = ufl.FacetNormal(self._spaces.body.mesh)
        flux = bodies.conductivity * ufl.dot(ufl.grad(test), normal)
        work += [self._on(trace.group, flux * self.error) for trace, _ in self._contacts]
        work += [-film.coefficient * self._on(film.on, self.error * test) for film in bodies.films]
        return [form_cache.form(one) for one in work]

    def _held(self) -> NDArray[np.int32]:
        """(cell, local facet) where the temperature is given."""
        none = np.zeros((0, 2), dtype=np.int32)
        given = self._conduction.bodies.given
        facets = np.concatenate([none, *(self._spaces.facets(one.on) for one in given)])
        return np.unique(facets, axis=0).astype(np.int32).reshape(-1)

    def _assembled(self, form: fem.Form) -> Array:
        """A linear form on the bubbles of this rank's cells, (cells, dofs); collective."""
        vector = fem.assemble_vector(form)
        vector.scatter_reverse(la.InsertMode.add)
        return np.array(vector.array[: self._cells * self._count]).reshape(self._cells, -1)


def _traces(*found: Trace | None) -> list[Trace]:
    return [one for one in found if one is not None]
