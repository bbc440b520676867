"""The error of the temperature in every cell, where conduction finds it.

From local problems as for displacements (``local_problems``): the error e of a cell K solves,
among the bubbles w of one degree more, ∫ k ∇e·∇w = −∫ k ∇T·∇w + ∫_∂K q w. There the flux q is the
mean of the two cells at a facet, what acts on the boundary, and of the cell itself where the
temperature is given. Across contacts it is the flux whose heat at the nodes is that of the contact,
through films h (T∞ − T), which the error changes as well: there the left side has ∫ h e w.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray
from ufl.core.expr import Expr

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.evaluate.internal_forces import traction_of
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.conduction.conduction import Conduction
from fenics_contact.problem.curved_sides import CurvedSides, sampled
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import MAX_TEMPERATURE, TEMPERATURE_OF_POINTS
from fenics_contact.trust.error_estimates.mesh.bubbles import bubble_element

# What one degree more adds to the integrands over the body's own.
_MORE = 2


@dataclass(frozen=True, eq=False)
class _Surface:
    """A surface through which heat crosses a contact.

    Attributes:
        number: Of the contact.
        trace: On the surface.
        work: Of its flux on the bubbles.
        crossing: The same on the errors.
    """

    number: int
    trace: Trace
    work: fem.Form
    crossing: fem.Form


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
        self._squared_by_block = np.zeros(self._cells)
        self._residual = form_cache.form(self._work(self.rise, self.rise, self._test, self._test))
        self._films = [
            form_cache.form(-film.coefficient * self._on(film.on, self.rise * self._test))
            for film in bodies.films
        ]
        self._flows = [
            (form_cache.form(self._on(flow.on, flow.inward * self._test)), flow.path)
            for flow in bodies.flows
        ]
        self._surfaces = [
            _Surface(
                problem.contacts.index(one.contact),
                trace,
                form_cache.form(self._on(trace.group, self._flux * self._test)),
                form_cache.form(self._on(trace.group, self._flux * self.error)),
            )
            for one in conduction.contacts
            for trace in (one.contact.trace, one.contact.sides.opposite)
            if trace is not None
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
        across = conduction.across(states)
        for surface in self._surfaces:
            self._set_flux(surface.trace, across[surface.number])
            right += self._assembled(surface.work)
        self._found = np.linalg.solve(self._stiffness, right[:, :, None])[:, :, 0]
        self._squared_by_block = np.einsum("ci,ci->c", self._found, right)
        self.take_signs(None)

    @property
    def squared(self) -> Array:
        """∫ k |∇e|² and ∫ h e² of films, of own cells, (cells,) (power·temperature)."""
        return np.asarray(self._squared_by_block[self._blocks])

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
        return np.asarray(np.add.reduce([bodies.nodal(form) for form in self._response]))

    def of_temperatures(self) -> dict[str, float]:
        """Return errors of temperatures besides those of nodes; collective.

        By quantity: at the scene's points the size of e, and of the highest temperature by how much
        T + e is higher within cells than T is at the nodes.
        """
        points, scene = self._problem.points, self._problem.scene
        at_points = zip(scene.point, points.of_scalar(self.error), strict=True)
        found = {
            f"{TEMPERATURE_OF_POINTS}{point.name}": abs(float(error)) for point, error in at_points
        }
        mesh, degree = self._spaces.body.mesh, self._spaces.degree
        finer = fem.functionspace(mesh, ("DG", 2 * degree))
        parts = [fem.Function(finer), fem.Function(finer)]
        for part, values in zip(parts, (self.rise, self.error), strict=True):
            part.interpolate(values)
        within = largest(self._spaces.comm, parts[0].x.array + parts[1].x.array)
        at_nodes = largest(self._spaces.comm, self.rise.x.array)
        return found | {MAX_TEMPERATURE: max(within - at_nodes, 0.0)}

    def across(self, states: Sequence[ContactState]) -> dict[int, float]:
        """Heat that errors of temperature within cells carry across contacts; collective.

        Args:
            states: Of all contacts.

        Returns:
            By the contact's number, the size of it (power).
        """
        found = dict.fromkeys((surface.number for surface in self._surfaces), 0.0)
        by_steps = self._conduction.by_unit_steps(states)
        for surface in self._surfaces:
            self._set_flux(surface.trace, by_steps[surface.number])
            own = float(np.real(fem.assemble_scalar(surface.crossing)))
            found[surface.number] += float(total(self._spaces.comm, own))
        return {number: abs(heat) for number, heat in found.items()}

    def _set_flux(self, trace: Trace, heat: Array) -> None:
        """Take a flux whose heat at the nodes of a surface is given, of all nodes; collective."""
        surface, bodies = trace.surface, self._conduction.bodies
        nodal = heat[bodies.numbers[surface.body_nodes]]
        flux = surface.on_body(traction_of(surface, nodal[:, None]))
        self._flux.x.array[bodies.scalar_of_node] = flux[:, 0]

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
            entries = fem.assemble_matrix(form_cache.form(form)).to_scipy().tocoo()
            cells, rows = np.divmod(entries.row, self._count)
            found[cells, rows, entries.col % self._count] += entries.data
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
        """Forms of the heat that errors of temperature within cells bring to the nodes.

        On contacts the flux of the errors is taken for that of the cell.
        """
        bodies = self._conduction.bodies
        work = [self._work(test, self.error, test, self.error)]
        normal = ufl.FacetNormal(self._spaces.body.mesh)
        flux = bodies.conductivity * ufl.dot(ufl.grad(test), normal)
        work += [self._on(one.trace.group, flux * self.error) for one in self._surfaces]
        work += [-film.coefficient * self._on(film.on, self.error * test) for film in bodies.films]
        return [form_cache.form(one) for one in work]

    def _held(self) -> NDArray[np.int32]:
        """(cell, local facet) where the temperature is given, and of the cut of a sector."""
        spaces, sector = self._spaces, self._problem.scene.cyclic_symmetry
        groups = [one.on for one in self._conduction.bodies.given]
        names = [] if sector is None else [sector.on, sector.against]
        groups += [spaces.body.boundary(name, "cyclic_symmetry") for name in names]
        none = np.zeros((0, 2), dtype=np.int32)
        facets = np.concatenate([none, *(spaces.facets(group) for group in groups)])
        return np.unique(facets, axis=0).astype(np.int32).reshape(-1)

    def _assembled(self, form: fem.Form) -> Array:
        """A linear form on the bubbles of this rank's cells, (cells, dofs); collective."""
        vector = fem.assemble_vector(form)
        vector.scatter_reverse(la.InsertMode.add)
        return np.array(vector.array[: self._cells * self._count]).reshape(self._cells, -1)


def missed_heat(problem: Problem, sides: CurvedSides) -> Array | None:
    """Heat at the nodes that a mesh with straight sides and nodal fluxes leaves out; collective.

    What lies between facets and the curves that they stand for conducts, too, and functions that
    fluxes are given by are interpolated between nodes. As forces do of ``MissedBody``.

    Args:
        problem: The model.
        sides: Of its bodies.

    Returns:
        (nodes,) (power); None where no heat flows.
    """
    conduction = problem.conduction
    if conduction is None:
        return None
    spaces, bodies, forms = problem.spaces, conduction.bodies, list[ufl.Form]()
    test, rise = ufl.TestFunction(bodies.space), fem.Function(bodies.space)
    rise.x.array[bodies.scalar_of_node] = conduction.rise
    if sides.offset is not None:
        density = spaces.weight * sides.offset * bodies.conductivity
        density *= ufl.inner(ufl.grad(rise), ufl.grad(test))
        held = np.zeros(len(sides.facets), dtype=bool)
        for given in bodies.given:
            held |= sides.within(given.on)
        forms += [density * sides.measure(held), -density * sides.measure(~held)]
        for film in bodies.films:
            lost = spaces.weight * film.coefficient * sides.stretch * rise * test
            forms.append(-lost * sides.measure(sides.within(film.on)))
    for flow in bodies.flows:
        factor, key = flow.path(conduction.time), "heat.flux"
        if callable(flow.given):
            more = sampled(spaces, (flow.given,), flow.on, key) - flow.inward
            forms.append(factor * spaces.weight * more * test * spaces.boundary(flow.on))
        if sides.offset is not None:
            more = spaces.weight * flow.inward * sides.stretch * test
            forms.append(factor * more * sides.measure(sides.within(flow.on)))
    nodal = [bodies.nodal(form_cache.form(form)) for form in forms]
    return np.asarray(np.add.reduce([np.zeros(bodies.count), *nodal]))
