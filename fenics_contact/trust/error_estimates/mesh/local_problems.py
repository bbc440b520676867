"""The error of every cell, from local problems with the fluxes of its neighbours.

R. E. Bank and A. Weiser, Some a posteriori error estimators for elliptic partial differential
equations, Math. Comp. 44 (1985) 283-301: the error e of a cell K solves, among the bubbles w of
one degree more, a_K(e, w) = (f, w)_K - a_K(u, w) + ∫_∂K t·w, where t is the mean of the tractions
of the two cells at a facet, and on the boundary what acts on it. Under contacts that is the
traction whose nodal forces are those of the contact, on springs k (ū - u), which the error
stretches as well: there a_K has ∫ k e w. Where the mean stress is an unknown of its
own, it has an error of its own in every cell, too (``mean_stress_errors``). Where conduction finds
temperatures, u expands by these with their errors (``heat_problems``), which are found first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.fem import Form as CompiledForm
from numpy.typing import NDArray
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.body.springs import Springs
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.evaluate.internal_forces import traction_of
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.error_estimates.mesh.bubbles import MeanStressErrors, bubble_space
from fenics_contact.trust.error_estimates.mesh.heat_problems import HeatErrors

# What one degree more adds to the integrands over the body's own: where products of displacements
# count. Stresses of bubbles on triangles and tetrahedra are of the degree of the body's
# displacements, for whose products its own rule is.
_MORE = 2
# Cells whose matrices are sorted together.
_AT_ONCE = 1000
# Waves along the axes, much shorter than cells are: their signs are as if drawn.
_WAVES = (71234.567, 53219.871, 61731.319)


@dataclass(frozen=True, eq=False)
class ForcesOfErrors:
    """Forces that move a solution as its errors do.

    Attributes:
        nodal: At the nodes, (nodes, components) (force).
        on_scalars: What the errors add to forces on the body's scalars, (body_scalars,) (force).
        on_springs: The part of ``nodal`` that each of ``Problem.feet`` exerts, likewise.
        heat: Heat that moves temperatures as their errors do, at the nodes of all ranks, (nodes,)
            (power); None where none are found.
    """

    nodal: Array
    on_scalars: Array
    on_springs: list[Array]
    heat: Array | None = None


class LocalErrors:
    """Local problems of a body; what is compiled and assembled serves any solution.

    Args:
        problem: The model.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        spaces = problem.spaces
        self._space = bubble_space(spaces)
        self._cells = spaces.body.mesh.topology.index_map(spaces.body.dimension).size_local
        self._rule = _rule(spaces, _MORE)
        self._heat = None
        if problem.conduction is not None:
            self._heat = HeatErrors(problem, problem.conduction)
        is_richer = compat.is_tensor_cell(spaces.body.mesh) or self._heat is not None
        self._rule_of_stress = _rule(spaces, _MORE if is_richer else 0)
        self._error = fem.Function(self._space)
        self._test = ufl.TestFunction(self._space)
        dofs = self._space.dofmap.list[: self._cells]
        self._blocks = dofs[:, 0] // dofs.shape[1]  # of every cell
        self._mean_stress: MeanStressErrors | None = None
        self._springs = [(foot, *self._on_springs(foot.springs)) for foot in problem.feet]
        self._stiffness = self._stiffnesses()
        if problem.elastic.mixed is not None:
            self._mean_stress = MeanStressErrors(problem, self._test, self._rule, self._blocks)
            self._stiffness = self._mean_stress.coupled(self._stiffness)
        self._squared_by_block = np.zeros(self._cells)
        self._held = _held_facets(problem)
        self._traction = fem.Function(spaces.displacement_space)
        elastic = problem.elastic
        stress, beyond = elastic.stress(), self._stress_of_heat()
        whole = stress if beyond is None else stress + beyond
        self._residual = self._compile(whole, elastic.strain(self._test), self._test)
        test = ufl.TestFunction(spaces.displacement_space)
        self._response = self._compile(
            elastic.displacement_stress(test),
            elastic.strain(test),
            self._error,
            self._error_stress(),
        )
        self._expansion = self._response_of_heat(test, beyond)
        error_stress = self._error_stress() if beyond is None else self._error_stress() + beyond
        on_scalars = [scalar.force_of(error_stress) for scalar in problem.body_scalars]
        self._on_scalars = [None if one is None else form_cache.form(one) for one in on_scalars]
        self._work = [self._work_on(trace) for _, trace in self._traces()]
        self._response_on_contacts = self._contact_response(test)
        self._response_on_springs = [
            form_cache.form(
                -springs.work(test, self._error, springs.measure(spaces.bulk_degree + _MORE))
            )
            for springs in elastic.springs
        ]
        self._loads = [
            (form_cache.form(load.acting.work(self._test)), load.path) for load in problem.loads
        ]
        spread = [scalar.work_on(self._test) for scalar in problem.body_scalars]
        self._by_scalars = [form_cache.form(one) for one in spread if one is not None]

    def solve(self, forces: BulkForces, time: float) -> None:
        """Find the errors of a solution, in whose state the problem is; collective."""
        if self._heat is not None:
            self._heat.solve(forces.solution.states)
        right = self._assembled(self._residual)
        acting = self._problem.scene.path_time(time)
        for form, path in self._loads:
            right += path(acting) * self._assembled(form)
        for form in self._by_scalars:
            right += self._assembled(form)
        for foot, stretch, form in self._springs:
            moved = self._problem.displacement.x.array.reshape(foot.displacement.shape)
            stretch.x.array[:] = (foot.displacement - moved).reshape(-1)
            right += self._assembled(form)
        for (contact, trace), form in zip(self._traces(), self._work, strict=True):
            self._set_traction(trace, _nodal_forces(forces, contact, trace))
            right += self._assembled(form)
        if self._mean_stress is not None:
            right = self._mean_stress.with_volumes(right)
        found = np.linalg.solve(self._stiffness, right[:, :, None])[:, :, 0]
        self._squared_by_block = np.einsum("ci,ci->c", found, right)
        if self._mean_stress is not None:
            self._squared_by_block = self._mean_stress.energies(found, right)
        self._found = found
        self._set_error(np.ones(self._cells))

    def squared_of(
        self, virtual: Array, forces: Array, loaded: float, stretch: Array | None = None
    ) -> Array:
        """a_K(e, e) of the errors of a virtual displacement, of own cells, (cells,); collective.

        Args:
            virtual: At the nodes, (nodes, components), such as that of an adjoint.
            forces: That hold it where contacts are, at the nodes, likewise.
            loaded: How often the loads of the scene act on it, at their full size.
            stretch: By what springs are stretched, if not by the virtual displacement.
        """
        stretch = virtual if stretch is None else stretch
        self._virtual.x.array[:] = virtual.reshape(-1)
        right = self._assembled(self._virtual_residual)
        for form, _ in self._loads:
            right += loaded * self._assembled(form)
        for _, stretched, form in self._springs:
            stretched.x.array[:] = -stretch.reshape(-1)
            right += self._assembled(form)
        for (_, trace), form in zip(self._traces(), self._work, strict=True):
            self._set_traction(trace, forces[trace.surface.body_nodes])
            right += self._assembled(form)
        found = np.linalg.solve(self._stiffness, right[:, :, None])[:, :, 0]
        return np.asarray(np.einsum("ci,ci->c", found, right)[self._blocks])

    @cached_property
    def _virtual(self) -> fem.Function:
        return fem.Function(self._problem.spaces.displacement_space)

    @cached_property
    def _virtual_residual(self) -> CompiledForm:
        elastic = self._problem.elastic
        stress = elastic.displacement_stress(self._virtual)
        return self._compile(stress, elastic.strain(self._test), self._test)

    @property
    def squared(self) -> Array:
        """a_K(e, e) of this rank's own cells, (cells,) (energy)."""
        return np.asarray(self._squared_by_block[self._blocks])

    @property
    def squared_of_heat(self) -> Array | None:
        """``HeatErrors.squared`` of own cells, (cells,); None where temperatures are given."""
        return None if self._heat is None else self._heat.squared

    @property
    def total(self) -> float:
        """Energy norm of the error of the whole body (√energy); collective."""
        return float(np.sqrt(total(self._problem.comm, self.squared.sum())))

    def at_points(self) -> dict[str, float]:
        """Return errors of displacements at the scene's points, besides those of nodes; collective.

        The length of e there, by quantity. With those of temperatures where conduction finds them.
        """
        found = self._problem.points.of_function(self._error)
        lengths = {name: float(np.linalg.norm(error)) for name, error in found.items()}
        return lengths if self._heat is None else lengths | self._heat.of_temperatures()

    def forces(self, draw: int | None = None) -> ForcesOfErrors:
        """Nodal forces that move the solution as its errors do, (nodes, components); collective.

        The Galerkin solution of the space with the bubbles, in which these are condensed: they
        take −Σ_K a_K(e, B_K v) of the stiffness, B_K v being the bubbles that follow from v.

        Args:
            draw: Number of a draw of signs by which the cells' errors are multiplied: what they do
                is then that of errors of their size, though as they are they may cancel.

        Returns:
            Those forces, with the parts of them that scalars and springs exert.
        """
        spaces = self._problem.spaces
        if draw is not None:
            self._set_error(self._signs(draw))
        heat = None if self._heat is None else self._heat.heat()
        on_springs = [spaces.assemble(form) for form in self._response_on_springs]
        every = (self._response, self._response_on_contacts, *self._expansion)
        found = np.add.reduce([*(spaces.assemble(form) for form in every), *on_springs])
        forms = self._on_scalars
        own = [0.0 if form is None else fem.assemble_scalar(form) for form in forms]
        on_scalars = np.asarray(total(self._problem.comm, np.array(own, dtype=np.float64)))
        self._set_error(np.ones(self._cells))
        return ForcesOfErrors(found, on_scalars, on_springs, heat)

    def _stress_of_heat(self) -> Expr | None:
        """Stress by what of temperatures no displacement of the elements follows, (3, 3), in UFL.

        That of their errors, and of what a projection leaves of them; None without any.
        """
        if self._heat is None:
            return None
        return self._problem.elastic.heat_stress(self._heat.rise + self._heat.error)

    def _response_of_heat(self, test: Expr, beyond: Expr | None) -> list[CompiledForm]:
        """Work of that stress on test functions of displacements, with the sign of a force."""
        if beyond is None:
            return []
        spaces = self._problem.spaces
        measure = ufl.dx(spaces.body.mesh, metadata=self._rule_of_stress)
        strain = self._problem.elastic.strain(test)
        return [form_cache.form(-spaces.weight * ufl.inner(beyond, strain) * measure)]

    @cached_property
    def _energies_of_heat(self) -> list[CompiledForm]:
        """Strain energy beyond that of the answer, by what temperatures have beyond its own."""
        beyond = self._stress_of_heat()
        if beyond is None:
            return []
        elastic, spaces = self._problem.elastic, self._problem.spaces
        assert self._heat is not None
        strain = elastic.heat_strain(self._heat.rise + self._heat.error)
        density = -ufl.inner(elastic.stress() + 0.5 * beyond, strain)
        measure = ufl.dx(spaces.body.mesh, metadata=self._rule_of_stress)
        return [form_cache.form(spaces.weight * density * measure)]

    def energy_of_heat(self) -> float:
        """Strain energy that temperatures have beyond the answer's where it stands; collective."""
        own = sum(fem.assemble_scalar(form) for form in self._energies_of_heat)
        return float(total(self._problem.comm, float(own)))

    def heat_across(self, states: Sequence[ContactState]) -> dict[int, float]:
        """Heat that errors of temperature within cells carry across contacts; collective.

        Args:
            states: Of all contacts.

        Returns:
            By the contact's number, the size of it (power).
        """
        return {} if self._heat is None else self._heat.across(states)

    def _error_stress(self) -> Expr:
        """Return the stress of the errors in UFL, (3, 3)."""
        found = self._problem.elastic.displacement_stress(self._error)
        return found if self._mean_stress is None else found + self._mean_stress.error

    def _signs(self, draw: int) -> Array:
        """1 or −1 for every block of dofs, at random: by the places of cells, on whichever rank."""
        mesh = self._problem.spaces.body.mesh
        middles = mesh.geometry.x[compat.geometry_nodes(mesh)[: self._cells]].mean(axis=1)
        size = largest(self._problem.comm, np.abs(mesh.geometry.x)) or 1.0
        waves = np.sin(middles / size @ np.array(_WAVES) * (1 + draw))
        signs = np.empty(self._cells)
        signs[self._blocks] = np.where(waves < 0, -1.0, 1.0)
        return signs

    def _set_error(self, factors: Array) -> None:
        """Multiply the errors of the blocks of dofs, and of the temperatures of their cells."""
        if self._heat is not None:
            self._heat.take_signs(factors[self._blocks])
        scaled = factors[:, None] * self._found
        if self._mean_stress is not None:
            scaled = self._mean_stress.without(scaled)
        self._error.x.array[: scaled.size] = scaled.reshape(-1)
        self._error.x.scatter_forward()

    def _compile(
        self, stress: Expr, strain: Expr, tested: Expr, within: Expr | None = None
    ) -> CompiledForm:
        """−∫ σ : e and tractions on a displacement: means between cells, own ones where held.

        Args:
            stress: σ on facets.
            strain: e.
            tested: The displacement.
            within: σ inside cells, if another one.
        """
        spaces = self._problem.spaces
        mesh = spaces.body.mesh
        inside = spaces.weight * (stress if within is None else within)
        stress = spaces.weight * stress
        between = ufl.dot(self._cut(ufl.avg(stress), "+"), ufl.jump(tested))
        rule = self._rule_of_stress
        held = ufl.Measure("ds", mesh, subdomain_data=[(1, self._held)], metadata=rule)
        return form_cache.form(
            -ufl.inner(inside, strain) * ufl.dx(mesh, metadata=rule)
            + between * ufl.dS(mesh, metadata=rule)
            + ufl.dot(self._cut(stress), tested) * held(1)
        )

    def _on_springs(self, springs: Springs) -> tuple[fem.Function, CompiledForm]:
        """A stretch of springs, and the work on bubbles of the forces that it makes."""
        stretch = fem.Function(self._problem.spaces.displacement_space)
        measure = springs.measure(self._problem.spaces.bulk_degree + _MORE)
        return stretch, form_cache.form(springs.work(stretch, self._test, measure))

    def _work_on(self, trace: Trace) -> CompiledForm:
        """Work of a contact's traction on bubbles, on one of its surfaces."""
        spaces = self._problem.spaces
        measure = spaces.boundary(trace.group, self._rule)
        return form_cache.form(spaces.weight * ufl.dot(self._traction, self._test) * measure)

    def _contact_response(self, test: Expr) -> CompiledForm:
        """Work of a test function's traction on the errors, on all surfaces in contact.

        It is taken for that of the cell itself, and once where several contacts share facets.
        """
        spaces, elastic = self._problem.spaces, self._problem.elastic
        tags = {tag for _, trace in self._traces() for tag in trace.group.tags}
        group = Group(spaces.body.dimension - 1, tuple(sorted(tags)))
        stress = spaces.weight * elastic.displacement_stress(test)
        measure = spaces.boundary(group, self._rule_of_stress)
        return form_cache.form(ufl.dot(self._cut(stress), self._error) * measure)

    def _cut(self, stress: Expr, side: str = "") -> Expr:
        """Tractions of a stress, with the components that displacements have."""
        components = self._problem.spaces.components
        normal = ufl.FacetNormal(self._problem.spaces.body.mesh)
        normal = normal(side) if side else normal
        return ufl.as_vector(
            [sum(stress[i, j] * normal[j] for j in range(components)) for i in range(components)]
        )

    def _stiffnesses(self) -> Array:
        """Return the stiffness of every cell of this rank, (cells, dofs, dofs)."""
        spaces, elastic = self._problem.spaces, self._problem.elastic
        trial = ufl.TrialFunction(self._space)
        stress = spaces.weight * elastic.displacement_stress(trial)
        measure = ufl.dx(spaces.body.mesh, metadata=self._rule_of_stress)
        work = ufl.inner(stress, elastic.strain(self._test)) * measure
        for springs in elastic.springs:
            on = springs.measure(spaces.bulk_degree + _MORE)
            work += springs.work(trial, self._test, on)
        form = form_cache.form(work)
        count, size = self._space.dofmap.list.shape[1], self._space.dofmap.index_map_bs
        blocks = fem.assemble_matrix(form).to_scipy().data
        blocks = blocks.reshape(-1, count, count, size, size)[: self._cells]
        for begin in range(0, self._cells, _AT_ONCE):  # in place: memory that is new is slow
            part = slice(begin, begin + _AT_ONCE)
            blocks[part] = blocks[part].transpose(0, 1, 3, 2, 4).reshape(blocks[part].shape)
        return np.asarray(blocks.reshape(self._cells, count * size, count * size))

    def _assembled(self, form: CompiledForm) -> Array:
        """A linear form on the bubbles of this rank's cells, (cells, dofs); collective."""
        vector = fem.assemble_vector(form)
        vector.scatter_reverse(la.InsertMode.add)
        size = self._space.dofmap.list.shape[1] * self._space.dofmap.index_map_bs
        return np.array(vector.array[: self._cells * size]).reshape(self._cells, size)

    def _traces(self) -> list[tuple[ContactSurface, Trace]]:
        """All surfaces in contact, of two bodies both."""
        return [
            (contact, trace)
            for contact in self._problem.contacts
            for trace in (contact.trace, contact.sides.opposite)
            if trace is not None
        ]

    def _set_traction(self, trace: Trace, nodal: Array) -> None:
        traction = trace.surface.on_body(traction_of(trace.surface, nodal))
        self._traction.x.array[:] = traction.reshape(-1)


def _rule(spaces: Spaces, more: int) -> dict[str, int]:
    """A quadrature of higher degree than the body's."""
    return {"quadrature_degree": spaces.bulk_degree + more}


def _nodal_forces(forces: BulkForces, contact: ContactSurface, trace: Trace) -> Array:
    """Return the forces of a contact on one of its surfaces, at its nodes (force); collective."""
    problem = forces.problem
    number = problem.contacts.index(contact)
    at_nodes = contact.trace.at_all_nodes(forces.solution.contact_force[number])
    whole = contact.kinematics.on_body(at_nodes)
    if contact.normal.loads:
        whole = whole + problem.pressure_load
    return whole[trace.surface.body_nodes]


def _held_facets(problem: Problem) -> NDArray[np.int32]:
    """(cell, local facet) where supports act, or faces are rigid: the traction is the cell's own.

    Without those on the axis of revolution, which have no area.
    """
    scene, spaces = problem.scene, problem.spaces
    names = [support.on for support in scene.support if not support.is_elastic]
    names += [coupling.on for coupling in scene.coupling if coupling.is_rigid]
    names += list(scene.symmetry)
    names += [] if scene.half_space is None else list(scene.half_space.on)
    sector = scene.cyclic_symmetry
    names += [] if sector is None else [sector.on, sector.against]
    groups = [spaces.body.group(name, "support") for name in names]
    parts = [spaces.facets(g) for g in groups if g.dimension == spaces.body.dimension - 1]
    facets = np.unique(np.concatenate([np.zeros((0, 2), dtype=np.int32), *parts]), axis=0)
    if spaces.kinematics == "axisymmetric":
        facets = facets[_off_the_axis(problem, facets)]
    return facets.astype(np.int32).reshape(-1)


def _off_the_axis(problem: Problem, facets: NDArray[np.int32]) -> Flags:
    dofmap = problem.spaces.displacement_space.dofmap
    radii = problem.spaces.coordinates[:, 0]
    nodes = [
        dofmap.list[cell, dofmap.dof_layout.entity_closure_dofs(1, facet)] for cell, facet in facets
    ]
    extent = np.abs(problem.spaces.body.mesh.geometry.x[:, 0]).max(initial=0.0)
    return np.array([radii[n].max() > 1e-9 * extent for n in nodes], dtype=bool)
