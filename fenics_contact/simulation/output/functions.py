"""An answer as functions of dolfinx: what runs write for ParaView, for those who write Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from dolfinx.fem import Function

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.evaluate.stress_at_places import NodalStress
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.solution import Solution


@dataclass(frozen=True, eq=False)
class ContactFields:
    """Fields of one contact, on a mesh of its facets: ``pressure.function_space.mesh``.

    That is the surface of which ``contact.csv`` has the points: `on`, or of two bodies the one
    that the program chose as the slave. A rank without facets of it has functions without values.
    All are Lagrange functions of the displacement's degree.

    Attributes:
        pressure: On the body, ≥ 0 where it pushes (stress).
        friction: Friction traction on the body, a vector (stress).
        slip: Against what stands opposite, since the start, a vector (length).
        gap: > 0 where open; not a number where nothing stands opposite (length).
    """

    pressure: Function
    friction: Function
    slip: Function
    gap: Function


@dataclass(frozen=True, eq=False)
class Fields:
    """A load step as functions of dolfinx, copies that no later step changes.

    Attributes:
        displacement: Of the body, a vector (length).
        stress: Cauchy's, a 3 × 3 tensor also of plane models, averaged over the cells that share a
            node (stress).
        contacts: Those of each contact, by its name, in scene order.
    """

    displacement: Function
    stress: Function
    contacts: Mapping[str, ContactFields]


def fields_of(problem: Problem, solution: Solution) -> Fields:
    """A load step as functions; collective.

    Args:
        problem: The model, in the state of that step.
        solution: Of that step.
    """
    space = problem.spaces.displacement_space
    displacement = Function(space, name="displacement")
    displacement.x.array[:] = solution.displacement.reshape(-1)
    pairs = zip(problem.contacts, solution.states, strict=True)
    return Fields(
        displacement,
        _stress(problem),
        {contact.label: _of_contact(contact, state) for contact, state in pairs},
    )


def _stress(problem: Problem) -> Function:
    """Return the stress of the problem's present displacement (stress)."""
    spaces = problem.spaces
    space = fem.functionspace(spaces.body.mesh, ("Lagrange", spaces.degree, (3, 3)))
    node_of = np.empty(len(spaces.coordinates), dtype=np.int64)
    node_of[space.dofmap.list] = spaces.displacement_space.dofmap.list
    stress = Function(space, name="stress")
    stress.x.array[:] = NodalStress(problem).at_nodes()[node_of].reshape(-1)
    return stress


def _of_contact(contact: ContactSurface, state: ContactState) -> ContactFields:
    trace = contact.trace
    gap = np.where(np.isfinite(state.gap), state.gap, np.nan)
    return ContactFields(
        pressure=_scalar(trace, state.contact_pressure, "contact_pressure"),
        friction=_vector(trace, state.friction_traction, "friction_traction"),
        slip=_vector(trace, state.slip, "slip"),
        gap=_scalar(trace, gap, "gap"),
    )


def _scalar(trace: Trace, values: Array, name: str) -> Function:
    """Scalars at the points, as a function on the surface."""
    return trace.surface.scalar_function(trace.at_every_node(values), name)


def _vector(trace: Trace, values: Array, name: str) -> Function:
    """Vectors along the surface at the points, likewise; 0 on the axis of revolution."""
    return trace.surface.vector_function(trace.at_all_nodes(values[: len(trace.nodes)]), name)
