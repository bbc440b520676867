"""Fields for ParaView: nodal functions from a solution."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from dolfinx import fem, io, la

from fenics_contact import compat
from fenics_contact.contact import OPEN, STICK
from fenics_contact.problem import Problem
from fenics_contact.reaction_pressure import reaction_pressure
from fenics_contact.solution import Solution

# Values of the field `status`.
NO_CONTACT, FIELD_OPEN, FIELD_STICK, FIELD_SLIP = -1.0, 0.0, 1.0, 2.0


def write_fields(problem: Problem, solution: Solution, folder: Path) -> None:
    """Write ``fields.pvd`` and its pieces; collective.

    Point data: displacement, stress (3 × 3), contact_pressure, friction_traction, status
    (−1 off the contacts, 0 OPEN, 1 STICK, 2 SLIP) and, where a contact is not prescribed,
    reaction_pressure, which knows nothing of the penalty.
    """
    functions = [
        problem.displacement,
        nodal_stress(problem),
        *_contact_functions(problem, solution),
        *_reaction_pressure(problem, solution),
    ]
    with io.VTKFile(problem.comm, folder / "fields.pvd", "w") as file:
        file.write_function(functions, 0.0)


def nodal_stress(problem: Problem) -> Any:
    """Cauchy stress at the nodes, averaged over the cells that share them, (3, 3)."""
    mesh, spaces = problem.body.mesh, problem.spaces
    space = fem.functionspace(mesh, ("Lagrange", spaces.degree, (3, 3)))
    points = compat.interpolation_points(space.element)
    if spaces.kinematics == "axisymmetric":
        # u_r / r has no value on the axis itself: look from a millionth inside.
        points = points + 1e-6 * (points.mean(axis=0) - points)
    cells = np.arange(mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32)
    expression = fem.Expression(problem.elastic.stress(), points)
    values = expression.eval(mesh, cells).reshape(len(cells), len(points), 9)
    stress, count = fem.Function(space, name="stress"), fem.Function(space)
    nodes = space.dofmap.list[cells]
    np.add.at(stress.x.array.reshape(-1, 9), nodes, values)
    np.add.at(count.x.array.reshape(-1, 9), nodes, 1.0)
    for function in (stress, count):
        function.x.scatter_reverse(la.InsertMode.add)
        function.x.scatter_forward()
    stress.x.array[:] /= np.maximum(count.x.array, 1.0)
    return stress


def _contact_functions(problem: Problem, solution: Solution) -> list[Any]:
    """Contact pressure, friction traction and status at the nodes, as functions on the body.

    At a node of two contacts the later one's values stand.
    """
    spaces = problem.spaces
    none = np.zeros(0, dtype=np.int32)
    pressure = spaces.nodal_function("contact_pressure", np.zeros(0), none)
    state = spaces.nodal_function("status", np.zeros(0), none, NO_CONTACT)
    traction = spaces.vector_function("friction_traction", np.zeros((0, spaces.components)), none)
    for contact, at_points in zip(problem.contacts, solution.states, strict=True):
        nodes, at_nodes = contact.nodes, slice(0, len(contact.nodes))
        spaces.set_nodal(pressure, at_points.contact_pressure[at_nodes], nodes)
        found = at_points.status[at_nodes]
        values = np.select([found == OPEN, found == STICK], [FIELD_OPEN, FIELD_STICK], FIELD_SLIP)
        spaces.set_nodal(state, values, nodes)
        tractions = at_points.friction_traction[at_nodes]
        traction.x.array.reshape(-1, spaces.components)[nodes] = tractions
    return [pressure, traction, state]


def _reaction_pressure(problem: Problem, solution: Solution) -> list[Any]:
    """Pressure from the bulk's nodal forces on the contacts that push, if there are any."""
    pushing = [i for i, contact in enumerate(problem.contacts) if contact.normal is not None]
    if not pushing:
        return []
    spaces = problem.spaces
    nodal = sum(
        problem.contacts[number].trace.surface.on_body(reaction_pressure(problem, solution, number))
        for number in pushing
    )
    every = np.arange(len(spaces.coordinates), dtype=np.int32)
    return [spaces.nodal_function("reaction_pressure", np.asarray(nodal), every)]
