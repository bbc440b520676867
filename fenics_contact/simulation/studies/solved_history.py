"""The load steps of an answer with the derivatives of each, and the errors known of each.

A quantity of a load step depends on the steps before by the slip that they left. All quantities of
all steps go back together, so that each step's tangent is made once. Errors change quantities as
loads do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import GivenChange
from fenics_contact.evaluate.condensed_forces import CondensedForces
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.adjoints import adjoint_of
from fenics_contact.simulation.sensitivities.derivatives import (
    QuantityGradient,
    of_step_before,
    require_adjoint,
    that_count,
)
from fenics_contact.simulation.sensitivities.gradients import gradient_of
from fenics_contact.simulation.sensitivities.quantity_gradients import StateGradient
from fenics_contact.simulation.sensitivities.scene_changes import Change, SceneChanges
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors

# What is changed in a load step, by a name; called when the problem is in its state.
ChangesAt = Callable[[AcceptedStep], Mapping[str, Change]]


def history_slopes(
    load_steps: LoadSteps,
    system: CondensedSystem,
    steps: Sequence[AcceptedStep],
    of: Sequence[str],
    changes_at: ChangesAt,
    is_whole: bool = True,
) -> list[dict[str, Array]]:
    """Derivatives of quantities at load steps; collective.

    Args:
        load_steps: That were taken; they are at their last step again afterwards.
        system: That has solved them.
        steps: All of them.
        of: Names of quantities.
        changes_at: What is differentiated by, the same names in every step.
        is_whole: Whether those of all load steps are found, or of the last one alone.

    Returns:
        Of each step, or of the last one: name of the change → derivative of each quantity,
        (quantities,).

    Raises:
        InputError: A quantity has no derivative, or the history has none.
    """
    problem, last = system.problem, steps[-1]
    require_adjoint(problem)
    follows = len(that_count(problem, steps)) > 1
    found: dict[AcceptedStep, dict[str, Array]] = {}
    going_back: dict[tuple[AcceptedStep, int], StateGradient] = {}
    for step in reversed(steps):
        if step is not last and not (is_whole or follows):
            break
        load_steps.go_back_to(step)
        changes = changes_at(step)
        if is_whole or step is last:
            found[step] = {name: np.zeros(len(of)) for name in changes}
            for place, name in enumerate(of):
                going_back[step, place] = gradient_of(problem, step.solution, name)
        adjoint = adjoint_of(load_steps)
        for (one, place), state in going_back.items():
            gradient = QuantityGradient(adjoint, step, state)
            for name, change in changes.items():
                found[one][name][place] += gradient.along(change)
            going_back[one, place] = of_step_before(problem, gradient)
        if not follows:
            going_back.clear()
    load_steps.go_back_to(last)
    return [found[step] for step in steps if step in found]


# Signs of the cells' errors: as they are, and drawn, lest they seem to cancel.
_DRAWS = (None, 0, 1)


@dataclass(frozen=True, eq=False)
class History:
    """Load steps of an answer, and what moves their quantities.

    Attributes:
        steps: What came out of each.
        slopes: Key of the scene → derivatives, (steps, quantities); where only
            the last step was differentiated, of that.
        errors: Source → what it is estimated to change of the quantities, with its sign, of one
            draw of signs or several: (draws, steps, quantities). Sources are ``mesh``, ``penalty``
            and ``regularisation``; one that was not estimated is missing.
        checks: Of the physics at the last step; empty where they were not asked for.
    """

    steps: Sequence[StepRecord]
    slopes: Mapping[str, Array]
    errors: Mapping[str, Array] = field(default_factory=dict)
    checks: Mapping[str, Check] = field(default_factory=dict)


def solved_history(
    kept: KeptBody,
    scene: Scene,
    of: Sequence[str],
    by: Sequence[str],
    is_judged: bool,
    is_whole: bool,
) -> History:
    """Solve a scene as a separate run does, and differentiate its load steps; collective.

    Args:
        kept: The body of the scene.
        scene: The scene.
        of: Names of quantities.
        by: Keys of the scene.
        is_judged: Whether to check the physics, and to estimate errors.
        is_whole: Whether all load steps are differentiated, or the last one alone.

    Raises:
        InputError: A quantity or a key has no derivative, or the scene has no equilibrium.
        NotConvergedError: There is no answer.
    """
    timings = Timings()
    with kept.stepping(scene, timings) as (load_steps, system):
        problem = system.problem
        records = StepHistory(problem, timings, partial(CondensedForces.of, system))
        records.begin([])
        taken = _RecordedSteps(records)
        load_steps.solve(taken)
        checks = records.checks() if is_judged else {}
        errors = _Errors(problem) if is_judged else None
        changes = partial(_changes, problem, by, errors)
        found = history_slopes(load_steps, system, taken.steps, of, changes, is_whole)
        return History(
            records.steps,
            {key: np.array([row[key] for row in found]) for key in by},
            {} if errors is None else errors.along(found),
            checks,
        )


class _RecordedSteps(StepListener):
    """Records load steps, and keeps them to be differentiated.

    Attributes:
        steps: All of them.
    """

    def __init__(self, records: StepHistory[InternalForces]) -> None:
        self._records = records
        self.steps: list[AcceptedStep] = []

    def accepted(self, step: AcceptedStep) -> None:
        """Record a load step, and keep it; collective."""
        self._records.add(step.time, step.solution)
        self.steps.append(step)


def _changes(
    problem: Problem, by: Sequence[str], errors: _Errors | None, step: AcceptedStep
) -> dict[str, Change]:
    """In the state of a load step; collective."""
    of_scene = SceneChanges(problem, step.unknowns.time)
    found = {key: of_scene.by(key) for key in by}
    return found if errors is None else found | errors.at(step)


class _Errors:
    """Estimated errors of each load step, as changes of its data.

    Args:
        problem: The model.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._local = None if problem.elastic.mixed is not None else LocalErrors(problem)
        self._names: dict[str, list[str]] = {}

    def at(self, step: AcceptedStep) -> dict[str, Change]:
        """Return the errors in the state of a load step, by source; collective."""
        found: dict[str, Change] = {}
        contacts = list(enumerate(self._problem.contacts))
        if any(contact.has_penalty for _, contact in contacts):
            found["errors penalty"] = Change(
                contacts={n: _without_penalty(one) for n, one in contacts if one.has_penalty}
            )
            self._names["penalty"] = ["errors penalty"]
        if any(one.friction.regularisation.is_numerical for _, one in contacts):
            found["errors regularisation"] = Change(
                contacts={
                    n: _without_regularisation(one)
                    for n, one in contacts
                    if one.friction.regularisation.is_numerical
                }
            )
            self._names["regularisation"] = ["errors regularisation"]
        if self._local is not None:
            of_mesh = dict(self._of_mesh(self._local, step))
            self._names["mesh"] = list(of_mesh)
            found |= of_mesh
        return found

    def _of_mesh(self, local: LocalErrors, step: AcceptedStep) -> Iterator[tuple[str, Change]]:
        """Forces that move the answer as the cells' errors do; collective."""
        problem = self._problem
        local.solve(BulkForces(problem, step.solution), step.unknowns.time)
        for draw in _DRAWS:
            forces = local.forces(draw)
            scalars = {
                problem.unknowns.index(scalar): -float(more)
                for scalar, more in zip(problem.body_scalars, forces.on_scalars, strict=True)
            }
            load = np.add.reduce([forces.nodal, *(-one for one in forces.on_springs)])
            springs = {n: partial(_always, one) for n, one in enumerate(forces.on_springs)}
            yield f"errors mesh {draw}", Change(load=load, scalars=scalars, springs=springs)

    def along(self, found: Sequence[Mapping[str, Array]]) -> dict[str, Array]:
        """Return the change of quantities by each source, (draws, steps, quantities).

        Args:
            found: Of each step, by the names of ``at``.
        """
        return {
            source: np.array([[row[name] for row in found] for name in names])
            for source, names in self._names.items()
        }


def _always(forces: Array, displacement: Array) -> Array:
    """Forces of springs that do not follow the displacement."""
    return forces


def _without_penalty(contact: ContactSurface) -> GivenChange:
    """To first order what an ε₁ of 0 changes."""
    of_unit = contact.normal.field_slopes("penalty_parameter", 1.0)
    return GivenChange(
        across={name: -contact.penalty_parameter * slope for name, slope in of_unit.items()}
    )


def _without_regularisation(contact: ContactSurface) -> GivenChange:
    """Return the change of a contact's data when ε goes to 0."""
    of_unit = contact.friction.field_slopes("regularisation_parameter", 1.0)
    return GivenChange(
        along={name: -contact.regularisation_parameter * slope for name, slope in of_unit.items()}
    )
