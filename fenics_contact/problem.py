"""The discrete problem: one energy term for each thing the scene names, and no more.

I_ε(v) = ½ a(v, v) − f(v) + Σ j_ε(v) (paper, (2.1), (2.7)): every form comes from
its energy by UFL's derivative, and is compiled once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact import compat
from fenics_contact.bulk import ElasticBody
from fenics_contact.contact import ContactSurface
from fenics_contact.errors import InputError
from fenics_contact.mesh import Body, Group
from fenics_contact.parallel import largest, raise_together
from fenics_contact.scene import AXES, Load, Scene, Value
from fenics_contact.spaces import Spaces
from fenics_contact.timings import Timings


@dataclass(frozen=True, eq=False)
class Term:
    """One energy term: what it is called and the forms compiled for it."""

    name: str
    forms: tuple[Any, ...]

    @property
    def integrals(self) -> list[str]:
        """Kind of integral of each compiled form, such as ``exterior_facet``."""
        return [kind for form in self.forms for kind in compat.integral_types(form)]


@dataclass(frozen=True, eq=False)
class AppliedSupport:
    """A support as degrees of freedom.

    Attributes:
        on: Name of the group.
        dofs: Local indices (owned and ghost) into the flat displacement array.
        values: Prescribed displacement of each (length).
    """

    on: str
    dofs: NDArray[np.int64]
    values: NDArray[np.float64]


class Problem:
    """Spaces, supports, energies and compiled forms of a scene on a body.

    Attributes:
        displacement: The unknown, a dolfinx function.
        supports: In scene order.
        contacts: In scene order.
        terms: The energy terms modelled.
        elastic: ½ a(·, ·): law, compiled forms, stress.
        load: Nodal loads with the prescribed contact pressures, (nodes, components).
    """

    def __init__(self, scene: Scene, body: Body, timings: Timings | None = None) -> None:
        timings = timings or Timings()
        self.scene = scene
        self.body = body
        self.comm = body.mesh.comm
        with timings.phase("compile"):
            self.spaces = Spaces(scene, body)
            self.displacement = fem.Function(self.spaces.displacement_space, name="displacement")
            self.supports = [
                self._support(number, support.on) for number, support in enumerate(scene.support)
            ]
            self.constrained, self.prescribed = self._constraints()
            self._refuse_overlaps()
            self.elastic = ElasticBody(scene, self.spaces, self.displacement)
            self.contacts = [
                ContactSurface(
                    contact,
                    f"contact[{number}]",
                    self.spaces,
                    self.displacement,
                    self.elastic.reference_modulus,
                )
                for number, contact in enumerate(scene.contact)
            ]
            self._refuse_held_contacts()
            self.terms = self._terms()
        with timings.phase("assemble"):
            self.load = self._assemble_load()

    @property
    def frictional(self) -> list[ContactSurface]:
        """The contacts that have a friction term."""
        return [contact for contact in self.contacts if contact.friction is not None]

    def is_loaded(self, group: Group) -> bool:
        """Whether a load acts on some of the facets of a group."""
        loaded = [self.body.find(load.on) for load in self.scene.load if load.body_force is None]
        return any(other and set(group.tags) & set(other.tags) for other in loaded)

    def _support(self, number: int, on: str) -> AppliedSupport:
        key = f"support[{number}]"
        nodes = self.spaces.nodes(self.body.group(on, f"{key}.on"))
        dofs, values = [], []
        for axis, value in self.scene.support[number].displacement.items():
            dofs.append(nodes.astype(np.int64) * self.spaces.components + AXES.index(axis))
            values.append(self.spaces.evaluate(value, nodes, f"{key}.displacement.{axis}"))
        return AppliedSupport(on, np.concatenate(dofs), np.concatenate(values))

    def _constraints(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """All constrained dofs, each once, with their values."""
        owner: dict[int, tuple[float, str]] = {}
        error = None
        every = [np.zeros(0), *(support.values for support in self.supports)]
        size = largest(self.comm, np.abs(np.concatenate(every)))
        for support in self.supports:
            for dof, value in zip(support.dofs.tolist(), support.values.tolist(), strict=True):
                first, on = owner.setdefault(dof, (value, support.on))
                if abs(first - value) > 1e-12 * size:
                    axis = AXES[dof % self.spaces.components]
                    error = InputError(
                        f"support on '{support.on}': displacement.{axis} = {value:g}, but the "
                        f"support on '{on}' prescribes {first:g} at a point of both"
                    )
        raise_together(self.comm, error)
        dofs = np.array(sorted(owner), dtype=np.int64)
        return dofs, np.array([owner[dof][0] for dof in dofs.tolist()])

    def _refuse_overlaps(self) -> None:
        """Contacts may not share facets with supports or other contacts (Γ_C ∩ Γ_D = ∅)."""
        taken: dict[int, str] = {}
        for number, support in enumerate(self.scene.support):
            group = self.body.group(support.on, f"support[{number}].on")
            if group.dimension == self.body.dimension - 1:
                taken |= dict.fromkeys(group.tags, f"the support on '{support.on}'")
        for number, contact in enumerate(self.scene.contact):
            group = self.body.boundary(contact.on, f"contact[{number}].on")
            for tag in group.tags:
                if tag in taken:
                    raise InputError(
                        f"contact[{number}].on = '{contact.on}': shares boundary with "
                        f"{taken[tag]}; a contact surface must be free of both"
                    )
            taken |= dict.fromkeys(group.tags, f"the contact '{contact.label}'")

    def _refuse_held_contacts(self) -> None:
        """Friction on a surface that supports hold everywhere does nothing: surely a slip."""
        for number, contact in enumerate(self.contacts):
            _, movable = contact.free_along_surface(self.constrained)
            free = contact.owned_nodes & movable
            if contact.friction is not None and self.comm.allreduce(int(free.sum())) == 0:
                raise InputError(
                    f"contact[{number}].on = '{contact.contact.on}': supports hold every point of "
                    "it along the surface, so nothing can slip"
                )

    def _terms(self) -> list[Term]:
        terms = [Term(self.elastic.name, self.elastic.forms)]
        for number, load in enumerate(self.scene.load):
            terms += self._load_term(number, load)
        for contact in self.contacts:
            if contact.pressure_load is not None:
                terms.append(Term(f"contact pressure on {contact.label}", (contact.pressure_load,)))
        for contact in self.frictional:
            assert contact.friction is not None
            forms = (contact.friction.residual, contact.friction.tangent)
            terms.append(Term(f"regularised friction on {contact.label}", forms))
        return terms

    def _load_term(self, number: int, load: Load) -> list[Term]:
        """The term of a load, with its linear form; none where the load is zero."""
        spaces = self.spaces
        kind, values = _kind_and_values(load)
        key = f"load[{number}]"
        if kind == "body_force":
            group = self.body.group(load.on, f"{key}.on")
            if group.dimension != self.body.dimension:
                raise InputError(f"{key}.on = '{load.on}': a body_force needs a part of the body")
            measure = spaces.part(group)
        else:
            group = self.body.boundary(load.on, f"{key}.on")
            measure = spaces.boundary(group)
        nodes = spaces.nodes(group)
        nodal = np.stack(
            [spaces.evaluate(v, nodes, f"{key}.{kind}[{i}]") for i, v in enumerate(values)], axis=1
        )
        if self.comm.allreduce(int(np.count_nonzero(nodal))) == 0:
            return []
        test = ufl.TestFunction(spaces.displacement_space)
        if kind == "pressure":
            pressure = spaces.coefficient(nodal[:, 0], nodes)
            work = -pressure * ufl.dot(ufl.FacetNormal(self.body.mesh), test)
        else:
            work = ufl.dot(spaces.coefficient(nodal, nodes), test)
        name = f"{kind.replace('_', ' ')} on {load.on}"
        return [Term(name, (fem.form(spaces.weight * work * measure),))]

    def _assemble_load(self) -> NDArray[np.float64]:
        load = np.zeros((len(self.spaces.coordinates), self.spaces.components))
        for term in self.terms:
            if len(term.forms) == 1 and term.forms[0].rank == 1:
                load += self.spaces.assemble(term.forms[0])
        return load


def _kind_and_values(load: Load) -> tuple[str, tuple[Value, ...]]:
    """Which of the three kinds a load is, and its components."""
    if load.traction is not None:
        return "traction", load.traction
    if load.pressure is not None:
        return "pressure", (load.pressure,)
    assert load.body_force is not None  # the scene has made sure of one
    return "body_force", load.body_force
