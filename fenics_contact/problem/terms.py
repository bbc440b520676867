"""The energy terms of a problem with compiled forms, and reactions where several supports meet.

Reactions where supports meet: the part of each in the force at a dof that several hold. The bulk
needs one force there, while the traction on each support's facets has its part in it. Given to one
support alone it makes the reactions of both wrong by as much as a cell's side carries. So each
takes the part that the cells' stress σ has on its facets, ∫ (σ n)_i φ, and what this leaves is
shared evenly: it is what is not known of the parts.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import compute_midpoints, exterior_facet_indices
from numpy.typing import NDArray

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import AppliedSupport
from fenics_contact.body.transposed_form import ForcesOnState, TransposedForm
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.problem.loads import GivenLoad
from fenics_contact.problem.loads.spring_feet import SpringFoot
from fenics_contact.problem.scalar_unknown import ScalarUnknown


@dataclass(frozen=True, eq=False)
class Term:
    """One energy term: its name, and what compiles its forms where they are not yet."""

    name: str
    compiled: Callable[[], tuple[fem.Form, ...]] = tuple

    @property
    def forms(self) -> tuple[fem.Form, ...]:
        """The forms compiled for it; collective."""
        return self.compiled()

    @property
    def integrals(self) -> list[str]:
        """Kind of integral of each compiled form, such as ``exterior_facet``."""
        return [kind for form in self.forms for kind in compat.integral_types(form)]


def terms_of(
    elastic: ElasticBody,
    feet: Sequence[SpringFoot],
    loads: Sequence[GivenLoad],
    unknowns: Sequence[ScalarUnknown],
    contacts: Sequence[ContactSurface],
) -> list[Term]:
    """One term for each thing the scene names, and no more.

    Args:
        elastic: The bulk.
        feet: Of the springs of elastic supports.
        loads: Those that are not zero.
        unknowns: The scalar unknowns.
        contacts: In scene order.
    """
    terms = [Term(elastic.name, lambda: elastic.forms)]
    terms += [
        Term(f"springs of the support '{foot.label}'", partial(_form_of, foot)) for foot in feet
    ]
    terms += [Term(load.name, partial(_form_of, load)) for load in loads]
    terms += _of_scalars(unknowns, None)
    for contact in contacts:
        law = contact.normal
        if law.loads_at_points:
            terms.append(Term(law.name, partial(_forms_of_loads, law)))
    for contact in contacts:
        terms += [
            Term(contact.name_of(term), partial(getattr, term, "forms"))
            for term in contact.forces.terms
        ]
        terms += _of_scalars(unknowns, contact)
    return terms


def _of_scalars(unknowns: Sequence[ScalarUnknown], contact: ContactSurface | None) -> list[Term]:
    """The terms of forces on scalar unknowns of a contact, or of none."""
    return [Term(one.term) for one in unknowns if one.term and one.contact is contact]


def _form_of(load: GivenLoad | SpringFoot) -> tuple[fem.Form, ...]:
    return (load.form,)


def _forms_of_loads(law: NormalLaw) -> tuple[fem.Form, ...]:
    return tuple(form for form, _ in law.loads)


# Of what the stresses leave: as a part of it is shared, and the parts may be wrong in both ways.
_SAFETY = 2.0
# Of the largest radius, to which the middles of facets are on the axis of revolution.
_ON_THE_AXIS = 1e-9


class SharedReactions:
    """The dofs that facets of several supports share; collective, as all it has.

    A facet that two supports hold along the same axis counts to the first, and so do dofs that one
    of them holds without facets of its own, such as those of a group of cells.

    Args:
        supports: All of a body.
        spaces: The body's.
        elastic: Its stress.
    """

    def __init__(
        self, supports: Sequence[AppliedSupport], spaces: Spaces, elastic: ElasticBody
    ) -> None:
        self._spaces, self._elastic = spaces, elastic
        components = spaces.components
        self._facets = facets = [
            _own_facets(supports, number, spaces) for number in range(len(supports))
        ]
        size = components * len(spaces.coordinates)
        touched = np.zeros((len(supports), size), dtype=bool)
        for number, by_axis in enumerate(facets):
            for axis, found in enumerate(by_axis):
                nodes = fem.locate_dofs_topological(
                    spaces.displacement_space, spaces.body.dimension - 1, found
                )
                touched[number, nodes.astype(np.int64) * components + axis] = True
        shared = touched.sum(axis=0) > 1
        shared[spaces.owned_nodes * components :] = False
        first = np.zeros(size, dtype=np.int64)
        for number in reversed(range(len(supports))):
            first[supports[number].dofs] = number
        self._dofs = np.flatnonzero(shared)
        self._dofs = self._dofs[touched[first[self._dofs], self._dofs]]
        self._holds = touched[:, self._dofs]
        self._moved = fem.Function(spaces.displacement_space)
        self._forms = [
            self._compiled(by_axis) if total(spaces.comm, int(holds.sum())) else None
            for by_axis, holds in zip(facets, self._holds, strict=True)
        ]
        self._axes = self._dofs % components

    def _compiled(self, by_axis: Sequence[NDArray[np.int32]]) -> fem.Form:
        return form_cache.form(self._tractions(by_axis))

    def _tractions(self, by_axis: Sequence[NDArray[np.int32]]) -> ufl.Form:
        """∫ (σ n)_i v_i over a support's facets, along the axes i that it holds."""
        spaces, elastic = self._spaces, self._elastic
        mesh, test = spaces.body.mesh, ufl.TestFunction(spaces.displacement_space)
        normal = ufl.FacetNormal(mesh)
        stress = elastic.nominal_stress(self._moved)
        domains = [
            (axis + 1, compat.boundary_entities(mesh.topology, facets))
            for axis, facets in enumerate(by_axis)
        ]
        rule = {"quadrature_degree": spaces.bulk_degree}
        on = ufl.Measure("ds", mesh, subdomain_data=domains, metadata=rule)
        components = range(spaces.components)
        return sum(
            spaces.weight
            * sum(stress[axis, j] * normal[j] for j in components)
            * test[axis]
            * on(axis + 1)
            for axis in components
        )

    @property
    def are_none(self) -> bool:
        """Whether no rank has such dofs."""
        return all(form is None for form in self._forms)

    def are_shared(self, supports: Collection[int], axis: int | None) -> bool:
        """Whether some supports share dofs along an axis, or any, with others or each other."""
        own = np.isin(np.arange(len(self._holds)), list(supports))
        found = self._holds[own].any(axis=0) & ((self._axes == axis) | (axis is None))
        return bool(total(self._spaces.comm, int(found.sum())) > 0)

    def moved(self, needed: Array, displacement: Array) -> Array:
        """The part of each support's reaction beyond that of dofs which count to the first.

        Args:
            needed: What the bulk needs at each dof of this rank, (dofs,) (force).
            displacement: That needs it, (nodes, components).

        Returns:
            (supports, components) (force).
        """
        return self._summed(self._moved_parts(needed, displacement))

    def moved_along(self, ways: Sequence[Array], needed: Array, displacement: Array) -> Array:
        """The work of the same forces on displacements, such as their moments.

        Args:
            ways: Of each support, those of all ``dofs``, (ways, dofs) each (length).
            needed: As of ``moved``.
            displacement: Likewise.

        Returns:
            (supports, ways) (energy).
        """
        parts = self._moved_parts(needed, displacement)
        works = [way @ part for way, part in zip(ways, parts, strict=True)]
        return np.asarray(total(self._spaces.comm, np.array(works)))

    def _moved_parts(self, needed: Array, displacement: Array) -> Array:
        """Part of each support in the force at each shared dof, (supports, dofs) (force)."""
        parts, left = self._parts(needed, displacement)
        holders = self._holds.sum(axis=0)
        parts = np.where(self._holds, parts + left / np.maximum(holders, 1), 0.0)
        if len(self._dofs):
            first = np.argmax(self._holds, axis=0)
            parts[first, np.arange(len(self._dofs))] -= needed[self._dofs]
        return parts

    @property
    def dofs(self) -> Integers:
        """The dofs that several supports share, of this rank's own, (dofs,)."""
        return self._dofs

    def moved_by(self) -> dict[tuple[int, int], tuple[Array, ForcesOnState]]:
        """Forces on the state whose work is ``moved``, by support and axis.

        Returns:
            As of ``moved_along_by``.
        """
        axes = np.arange(self._spaces.components)
        units = np.where(axes[:, None] == self._axes, 1.0, 0.0)
        if self._spaces.kinematics == "axisymmetric":
            units[0] = 0.0  # radial forces cancel
        return self.moved_along_by([units] * len(self._holds))

    def moved_along_by(
        self, ways: Sequence[Array]
    ) -> dict[tuple[int, int], tuple[Array, ForcesOnState]]:
        """Forces on the state whose work is ``moved_along``, by the numbers of support and way.

        Args:
            ways: As of ``moved_along``.

        Returns:
            Factors of what the bulk needs at each dof of this rank, (dofs,), with what acts on the
            state besides; without those that are 0 on all ranks.
        """
        spaces, count = self._spaces, len(self._holds)
        if not count:
            return {}
        state = self._moved if self._elastic.mixed is None else self._elastic.displacement
        transposed = [
            None
            if form is None
            else TransposedForm(self._tractions(by_axis), spaces, self._elastic, state)
            for by_axis, form in zip(self._facets, self._forms, strict=True)
        ]
        holders = np.maximum(self._holds.sum(axis=0), 1)
        first = np.argmax(self._holds, axis=0)
        found = {}
        for number, place in np.ndindex(count, len(ways[0])):
            way = np.where(self._holds[number], ways[number][place], 0.0)
            if not total(spaces.comm, int(np.count_nonzero(way))):
                continue
            left = way / holders
            factors = np.zeros(spaces.components * len(spaces.coordinates))
            factors[self._dofs] = left - np.where(first == number, way, 0.0)
            parts = []
            for other, form in enumerate(transposed):
                if form is not None:
                    tested = np.zeros(len(factors))
                    own = way if other == number else 0.0
                    tested[self._dofs] = np.where(self._holds[other], own - left, 0.0)
                    parts.append(form.of(tested.reshape(-1, spaces.components)))
            found[number, place] = factors, ForcesOnState.sum(parts)
        return found

    def unknown(self, needed: Array, displacement: Array, supports: Collection[int]) -> float:
        """Unknown part of some supports' reaction in what they share with others (force).

        Args:
            needed: As of ``moved``.
            displacement: That needs it, (nodes, components).
            supports: Their numbers.
        """
        if self.are_none:
            return 0.0
        left, between = self._left_between(needed, displacement, supports)
        unknown = self._summed(np.abs(left[between])[None], between)
        return _SAFETY * float(np.linalg.norm(unknown))

    def unknown_along(
        self, way: Array, needed: Array, displacement: Array, supports: Collection[int]
    ) -> float:
        """Bound of what is not known of the work of reactions on displacements (energy).

        Args:
            way: Displacements of ``dofs``, (ways, dofs) (length).
            needed: As of ``moved``.
            displacement: That needs it, (nodes, components).
            supports: Their numbers.
        """
        if self.are_none:
            return 0.0
        left, between = self._left_between(needed, displacement, supports)
        works = np.abs(way[:, between] * left[between]).sum(axis=1)
        return _SAFETY * float(np.linalg.norm(total(self._spaces.comm, works)))

    def _left_between(
        self, needed: Array, displacement: Array, supports: Collection[int]
    ) -> tuple[Array, Flags]:
        """Forces that stresses leave open at shared dofs (force), and which dofs others share."""
        _, left = self._parts(needed, displacement)
        own = np.isin(np.arange(len(self._holds)), list(supports))
        return left, self._holds[own].any(axis=0) & self._holds[~own].any(axis=0)

    def _parts(self, needed: Array, displacement: Array) -> tuple[Array, Array]:
        """Parts of each support at each shared dof, and what is left of the force there."""
        self._moved.x.array[:] = displacement.reshape(-1)
        parts = np.zeros(self._holds.shape)
        for number, form in enumerate(self._forms):
            if form is not None:
                parts[number] = self._spaces.assemble(form).reshape(-1)[self._dofs]
        parts *= self._holds
        return parts, needed[self._dofs] - parts.sum(axis=0)

    def _summed(self, parts: Array, chosen: Flags | slice = slice(None)) -> Array:
        """Over dofs of all ranks by component, (rows, components); radial ones cancel."""
        axes, components = self._axes[chosen], self._spaces.components
        sums = [np.bincount(axes, row, components) for row in parts]
        summed = np.asarray(total(self._spaces.comm, np.reshape(sums, (len(parts), components))))
        if self._spaces.kinematics == "axisymmetric":
            summed[:, 0] = 0.0
        return summed


def _own_facets(
    supports: Sequence[AppliedSupport], number: int, spaces: Spaces
) -> list[NDArray[np.int32]]:
    """Facets that a support holds along each axis, and none before it does."""
    found = []
    for axis in range(spaces.components):
        facets = _facets(supports[number], axis, spaces)
        for before in supports[:number]:
            facets = np.setdiff1d(facets, _facets(before, axis, spaces))
        found.append(facets.astype(np.int32))
    return found


def _facets(support: AppliedSupport, axis: int, spaces: Spaces) -> NDArray[np.int32]:
    """This rank's facets of a support on the body's surface, none if it does not hold that axis.

    Without those on the axis of revolution, which have no area.
    """
    mesh, dimension = spaces.body.mesh, spaces.body.dimension
    group = spaces.body.find(support.on)
    held = total(spaces.comm, int((support.dofs % spaces.components == axis).sum())) > 0
    if group is None or group.dimension != dimension - 1 or not held:
        return np.zeros(0, dtype=np.int32)
    mesh.topology.create_connectivity(dimension - 1, dimension)
    facets = np.intersect1d(spaces.body.entities(group), exterior_facet_indices(mesh.topology))
    if spaces.kinematics == "axisymmetric":
        radii = compute_midpoints(mesh, dimension - 1, facets.astype(np.int32))[:, 0]
        facets = facets[radii > _ON_THE_AXIS * largest(spaces.comm, spaces.coordinates[:, 0])]
    return facets.astype(np.int32)
