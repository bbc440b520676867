"""Description of the model in results: its solver, and each contact's sides and parameters."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fenics_contact.common.parallel import smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.normal import law_of
from fenics_contact.problem.existence.condition import FreeMotion
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.table import measured_by
from fenics_contact.results.records.contacts import ContactRecord, LawAnswers, array_record
from fenics_contact.results.records.record import UnitsRecord
from fenics_contact.results.records.run import Model, RigidMotion
from fenics_contact.scene.scene import Scene
from fenics_contact.solve.solver_choice import SolverChoice
from fenics_contact.solve.systems.contact_dofs import dofs_of
from fenics_contact.solve.systems.near_nodes import near_nodes
from fenics_contact.solve.systems.solution import Solution


def words_on_contact_dofs(problem: Problem, choice: SolverChoice) -> list[str]:
    """How many displacements of each contact are condensed onto, where these are many; collective.

    What a large contact costs grows with their square, in memory, and cube.

    Args:
        problem: The model.
        choice: Its solver.
    """
    near = near_nodes(problem)
    if choice.name != "condensed" or not any(near):
        return []
    acting = [contact for contact in problem.contacts if contact.forces.terms]
    every = [len(dofs_of(contact.sides, None)) for contact in acting]
    left = [len(dofs_of(one.sides, which)) for one, which in zip(acting, near, strict=True)]
    found = []
    for contact, all_of, kept in zip(acting, every, left, strict=True):
        if kept:
            share = f"{100 * kept / sum(left):.0f} % of those of all contacts"
            words = f"{kept:,} of {all_of:,} displacements are condensed onto, {share}"
        else:
            gap = smallest(problem.comm, contact.kinematics.gap)
            length = (
                "" if problem.scene.unit_names is None else f" {problem.scene.unit_names.length}"
            )
            words = f"open by {gap:.3g}{length} or more; its {all_of:,} displacements are left out "
            words += "unless it closes"
        found.append(f"Contact '{contact.label}': {words}")
    return found


def model_of(
    problem: Problem, choice: SolverChoice, free: FreeMotion, solution: Solution | None
) -> Model:
    """``model`` of ``result.json``; collective.

    Args:
        problem: The model.
        choice: Its solver.
        free: Rigid motions that the supports leave to friction.
        solution: Of the last load step, if any.
    """
    index_map = problem.spaces.displacement_space.dofmap.index_map
    points = sum(total(problem.comm, int(c.trace.owned.sum())) for c in problem.contacts)
    cells = problem.body.mesh.topology.index_map(problem.body.dimension)
    return Model(
        kinematics=problem.scene.kinematics,
        strains=problem.scene.strains,
        degree=problem.spaces.degree,
        cell=problem.body.mesh.topology.cell_name(),
        bodies=list(problem.spaces.parts.names),
        cells=int(cells.size_global),
        dofs=int(index_map.size_global) * problem.spaces.components,
        contact_points=int(points),
        ranks=problem.comm.size,
        solver=choice.name,
        solver_reason=choice.reason,
        solver_memory_mb=round(choice.memory / 1e6),
        strategy=_strategy_of(problem, solution),
        scalar_unknowns=[unknown.name for unknown in problem.unknowns if not unknown.is_given],
        terms=[term.name for term in problem.terms],
        free_rigid_motions=free.modes,
        rigid_motions=[RigidMotion(**motion) for motion in free.motions],
        stabilised_motions=list(free.stabilised),
        used_share_of_limit_load=free.used_share,
        symmetry=_symmetry_of(problem),
        time_step=problem.inertia.size,
        free_modes=_free_modes(problem),
        bulk_factorisations=None if solution is None else solution.factorisations,
    )


def _symmetry_of(problem: Problem) -> str:
    """Part of the whole that is modelled, in words."""
    cut, planes = problem.discrete.cut, problem.discrete.held
    if cut is None:
        return planes.symmetry
    return f"{cut.words}; {planes.symmetry}" if planes.planes else cut.words


def _free_modes(problem: Problem) -> int | None:
    """Return the number of modes in which bodies move, once it is known; else None."""
    modes = problem.scene.motion and problem.scene.motion.modes
    return modes.number if modes and isinstance(modes.number, int) else None


def _strategy_of(problem: Problem, solution: Solution | None) -> str:
    """How friction and pressure are brought together, or were."""
    if not problem.elastic.is_linear:
        return f"finite strains: {solution.strategy if solution else 'nested loops'}"
    if problem.coulomb:
        chosen = problem.scene.solver.strategy
        return f"Coulomb friction: {solution.strategy if solution else chosen}"
    if any(contact.is_one_sided for contact in problem.contacts):
        return "frictionless contact: one Newton solve with a line search on the energy"
    if problem.frictional:
        return "prescribed pressure: one Newton solve, no outer loop"
    return "linear: one Newton step"


def units_of(scene: Scene, quantities: Iterable[str]) -> UnitsRecord | None:
    """``units`` of ``result.json``; None where the scene has none.

    Args:
        scene: What was solved.
        quantities: Names of those that the run has.
    """
    names = scene.unit_names
    if names is None:
        return None
    measured = {name: names.of(measured_by(name)) for name in quantities}
    return UnitsRecord(
        length=names.length,
        force=names.force,
        stress=names.stress,
        energy=names.energy,
        per_unit_thickness=names.per_unit_thickness,
        quantities={name: unit for name, unit in measured.items() if unit},
        temperature=names.temperature,
    )


def record_of(contact: ContactSurface) -> ContactRecord:
    """A contact as ``result.json`` has it, before anything is known of its answer.

    Of two bodies it says whose points carry it, what stands opposite, and why it is so.
    """
    sides, law = contact.sides, law_of(contact.contact)
    of_two = sides.opposite is not None
    return ContactRecord(
        name=contact.label,
        contact=contact.contact.kind,
        law=contact.friction.kind,
        answers=LawAnswers(
            pressure_is_given=law.pressure_is_known,
            is_rigid=law.has_penalty,
            carries_shear=contact.can_shear,
        ),
        slave=sides.slave if of_two else None,
        master=sides.master if of_two else None,
        slave_reason=sides.why if of_two else None,
        parameters=_parameters_of(contact),
        arrays=[array_record(array) for array in contact.own_arrays],
        quantities={},
    )


def regularisation_of(contact: ContactSurface) -> float | None:
    """The ε of a load step; None where it follows from pressures to come, or there is none."""
    if contact.friction.stores_energy:
        return None  # it is no regularisation, and stands under its own name
    is_open = (
        contact.found is None
        and contact.is_coulomb
        and not contact.friction.regularisation.is_known
    )
    return None if is_open else contact.regularisation_parameter


def _parameters_of(contact: ContactSurface) -> dict[str, Any]:
    """A contact's parameters as used; what varies in space is said so."""
    said = contact.contact
    given: dict[str, Any] = {**contact.parameters}
    given["friction_coefficient"] = said.friction_coefficient
    if said.friction_law is not None and not said.friction_law.is_proportional:
        given["friction_law"] = said.friction_law.shown
    used = {
        "regularisation_parameter": regularisation_of(contact),
        "penalty_parameter": contact.penalty_parameter if contact.has_penalty else None,
        "force": contact.force,
        "interference": contact.kinematics.interference or None,
        **{name: "varies" if callable(value) else value for name, value in given.items()},
    }
    return {name: value for name, value in used.items() if value is not None}
