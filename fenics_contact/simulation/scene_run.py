"""From a scene to a result: the data's one-way path, in one place."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable
from functools import cached_property
from typing import Any

from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.errors import InputError, NotConvergedError, StoppedError
from fenics_contact.common.failures import failing_together
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.energy_balance import EnergyBook
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import (
    contact_points,
    contact_quantities,
    global_quantities,
    support_reactions,
)
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.existence.condition import FreeMotion, require_equilibrium
from fenics_contact.problem.problem import Problem
from fenics_contact.results.load_history import Announce, step_line
from fenics_contact.results.records.contacts import ContactRecord, StepContact
from fenics_contact.results.records.model import Model, RigidMotion, Seconds
from fenics_contact.results.records.steps import Largest, StepRecord
from fenics_contact.results.result import Check, Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation import verdict
from fenics_contact.simulation.description import (
    record_of,
    regularisation_of,
    strategy_of,
)
from fenics_contact.simulation.restart.state_file import SavedRun, StateFile
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.load_steps import LoadSteps, solve
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import SolverChoice, choose_solver
from fenics_contact.trust.checks.run_checks import run_checks
from fenics_contact.trust.error_estimates.budget import ErrorBudget, error_budget
from fenics_contact.trust.linear_theory.linear_range import LinearRange, linear_range
from fenics_contact.trust.uniqueness.other_answers import OtherAnswers, look_around

logger = logging.getLogger(__name__)


class Run:
    """A scene made ready, then solved; kept for those who want the fields.

    Of many in one process keep results, not runs: each has some forty of MPI's communicators, which
    are given back when nobody refers to it any more.

    Attributes:
        scene: What to solve.
        own_mesh: Whether the mesh was passed, in place of the one that the scene names.
        problem: The model: spaces, energies, forms.
        free_motion: Rigid motions that the supports leave to friction.
        choice: The solver, and how much memory it is to need.
        solution: Nodal values of this rank of the last load step that was solved, or None.
        forces: Nodal forces that the bulk needs in the last step that was solved.
        steps: What came out of the load steps so far, as in ``result.json``.
        book: Work and energies along them.
        others: What is known of other answers of the last step.
        budget: Estimated errors of its quantities.
        last: What a further step would start from, once all are solved.
        timings: Seconds so far.

    Args:
        scene: What to solve.
        comm: Communicator; collective.
        body: The mesh, if not the one the scene names.

    Raises:
        InputError: The scene or its mesh cannot be used, or has no equilibrium.
        MachineError: It will not fit into the machine's memory.

    Friction carries what pulls a block, and the floor what presses it, 10 on a length of 2:

    >>> from fenics_contact import load_scene, main
    >>> main(["new", "own", "--quiet"])  # writes own.toml and own.geo
    0
    >>> prepared = Run(load_scene("own.toml"))
    >>> prepared.model["kinematics"], prepared.model["dofs"]
    ('plane strain', 1122)
    >>> found = prepared.solve().quantities
    >>> abs(found["normal_force"] - 20) < 1e-8, abs(found["friction_force"][0] + 3) < 1e-8
    (True, True)
    """

    def __init__(
        self, scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None
    ) -> None:
        self.scene, self.own_mesh = scene, body is not None
        self.solution: Solution | None = None
        self.last: Unknowns | None = None
        self.others = OtherAnswers()
        self.budget = ErrorBudget()
        self.steps: list[StepRecord] = []
        self._announce: Announce = _log_step
        self.timings = Timings()
        with failing_together(comm):
            self._make_ready(scene, comm, body)

    def _make_ready(self, scene: Scene, comm: MPI.Comm, body: Body | None) -> None:
        """Mesh, model and solver; collective."""
        if body is None:
            if not scene.mesh:
                raise InputError("mesh: the scene names no mesh and no body was passed")
            with self.timings.phase("mesh"):
                curved = scene.accuracy is not None and scene.discretisation.degree > 1
                body = load_body(scene.mesh, scene.dimension, comm, curved=curved)
        self.problem = Problem.on_mesh(scene, body, self.timings)
        with self.timings.phase("solve"):
            self.free_motion: FreeMotion = require_equilibrium(self.problem)
        self.choice: SolverChoice = choose_solver(self.problem)

    @property
    def model(self) -> Model:
        """``model`` of ``result.json``; collective."""
        problem = self.problem
        index_map = problem.spaces.displacement_space.dofmap.index_map
        points = sum(total(problem.comm, int(c.trace.owned.sum())) for c in problem.contacts)
        cells = problem.body.mesh.topology.index_map(problem.body.dimension)
        return Model(
            kinematics=self.scene.kinematics,
            degree=problem.spaces.degree,
            cell=problem.body.mesh.topology.cell_name(),
            bodies=list(problem.spaces.parts.names),
            cells=int(cells.size_global),
            dofs=int(index_map.size_global) * problem.spaces.components,
            contact_points=int(points),
            ranks=problem.comm.size,
            solver=self.choice.name,
            solver_reason=self.choice.reason,
            solver_memory_mb=round(self.choice.memory / 1e6),
            strategy=strategy_of(problem, self.solution),
            scalar_unknowns=[unknown.name for unknown in problem.unknowns],
            terms=[term.name for term in problem.terms],
            free_rigid_motions=self.free_motion.modes,
            rigid_motions=[RigidMotion(**motion) for motion in self.free_motion.motions],
            stabilised_motions=list(self.free_motion.stabilised),
            used_share_of_limit_load=self.free_motion.used_share,
            symmetry=problem.discrete.held.symmetry,
            bulk_factorisations=None if self.solution is None else self.solution.factorisations,
        )

    def solve(
        self,
        state: StateFile | None = None,
        saved: SavedRun | None = None,
        stopped: Callable[[], bool] | None = None,
        announce: Announce | None = None,
        accepted: Callable[[], None] | None = None,
        guess: Unknowns | None = None,
    ) -> Result:
        """Solve and evaluate; collective. Failure to converge is a result, too.

        Args:
            state: Where to keep the state of every accepted load step.
            saved: The state of another run, to go on from.
            stopped: Whether this rank was asked to stop; then the last accepted step counts.
            announce: Called with number and record of every accepted step; by default it is
                logged, where there are several.
            accepted: Called when a load step has been added to ``steps``; collective.
            guess: Where the first load step is thought to end.

        Returns:
            What came out, the same on every rank.

        Raises:
            MachineError: The machine failed: memory, a file.
        """
        with failing_together(self.problem.comm):
            return self._solve(state, saved, stopped, announce, accepted, guess)

    def _solve(
        self,
        state: StateFile | None,
        saved: SavedRun | None,
        stopped: Callable[[], bool] | None,
        announce: Announce | None,
        accepted: Callable[[], None] | None,
        guess: Unknowns | None,
    ) -> Result:
        """As ``solve``."""
        if state is not None:
            state.make_folder()
        self.solution = None
        self.steps = [] if saved is None else list(saved.steps)
        self.book = EnergyBook(self.problem)
        self.others = OtherAnswers()
        self.budget = ErrorBudget()
        self._checks: dict[str, Check] = {}
        self._announce = announce or (_log_step if self.scene.steps.several else _say_nothing)

        begun: list[LoadSteps] = []  # not the run's own: it refers to it, and would not be freed

        def begin(load_steps: LoadSteps) -> None:
            begun.append(load_steps)
            load_steps.guess = guess
            if saved is not None:
                self._measure(load_steps.resume(saved.last, saved.pace, saved.forces))
                self.book.resume(saved.energy, self.forces, self._reactions)

        def record(time: float, solution: Solution) -> None:
            self._record(time, solution)
            if accepted is not None:
                accepted()

        def keep(load_steps: LoadSteps) -> None:
            if state is not None:
                with self.timings.phase("output"):
                    state.save(load_steps, self.steps, self.book.sums)

        def end(load_steps: LoadSteps) -> None:
            self.last = None if load_steps.last is None else load_steps.last.unknowns
            self._checks = self._run_checks()  # before other answers move the contacts about
            with self.timings.phase("output"):
                self.others = look_around(load_steps)
            with self.timings.phase("errors"):
                self.budget = error_budget(load_steps, self.steps)

        try:
            solve(self.problem, self.timings, record, self.choice, begin, keep, stopped, end)
        except NotConvergedError as error:
            return self._unconverged(error, begun[0].tried)
        except StoppedError:
            return self._interrupted()
        return self._evaluate()

    def _measure(self, solution: Solution) -> dict[str, Any]:
        """Forces and quantities of a load step, before slip is counted anew."""
        self.solution = solution
        with self.timings.phase("output"):
            self.forces = BulkForces(self.problem, solution)
            self._reactions, self._supports = support_reactions(self.forces)
            self._by_contact = [
                contact_quantities(self.problem, solution, number)
                for number in range(len(self.problem.contacts))
            ]
            return global_quantities(self.forces, self._reactions, self._by_contact)

    def _record(self, time: float, solution: Solution) -> None:
        """Keep what came out of a load step."""
        quantities = self._measure(solution)
        self.book.count(self.forces, self._reactions)
        quantities |= self.book.quantities(quantities)
        with self.timings.phase("output"):
            linear_range = self._linear_range.of(solution)
        self.steps.append(
            StepRecord(
                load_factor=time,
                newton_iterations=solution.newton_iterations,
                outer_iterations=solution.outer_iterations,
                outer_contraction=solution.contraction,
                attempts=list(solution.attempts),
                residual_history=list(solution.residual_history),
                imbalance_limit=solution.imbalance_limit,
                quantities=quantities,
                contacts=[
                    StepContact(
                        name=contact.label,
                        regularisation_parameter=regularisation_of(contact),
                        quantities=found,
                    )
                    for contact, found in zip(self.problem.contacts, self._by_contact, strict=True)
                ],
                supports=self._supports,
                linear_range={what: Largest(**row) for what, row in linear_range.items()},
            )
        )
        self._announce(len(self.steps), self.steps[-1])

    @cached_property
    def _linear_range(self) -> LinearRange:
        """Strains and rotations of its load steps; collective, where it is first asked for."""
        return LinearRange(self.problem)

    def contacts(self, quantities: list[dict[str, Any]] | None = None) -> list[ContactRecord]:
        """``contacts`` of ``result.json``.

        Args:
            quantities: Those of each contact, once there are any.
        """
        quantities = quantities or [{} for _ in self.problem.contacts]
        return [
            dataclasses.replace(
                record_of(contact),
                uniqueness_limit=self.others.limit(contact.label),
                quantities=found,
                errors=self.budget.of_contact(number),
            )
            for number, (contact, found) in enumerate(
                zip(self.problem.contacts, quantities, strict=True)
            )
        ]

    def _run_checks(self) -> dict[str, Check]:
        """Of the last load step; collective."""
        with self.timings.phase("output"):
            checks = run_checks(self.forces, self._reactions, len(self.steps))
            balance = self.book.check(self.steps[-1].quantities)
            checks |= {} if balance is None else {"energy_balance": balance}
            small = linear_range(self.steps)
            checks |= {} if small is None else {"linear_range": small}
        return checks

    def _evaluate(self) -> Result:
        """Of the last load step; collective."""
        problem, solution = self.problem, self.solution
        assert solution is not None
        with self.timings.phase("output"):
            quantities = self.steps[-1].quantities
            checks = self._checks or self._run_checks()
            points = contact_points(problem, solution)
        return Result(
            title=self.scene.title,
            converged=True,
            verdict=(
                verdict.of_checks(checks)
                + verdict.untouched(problem, solution)
                + verdict.facets_too_straight(problem, solution)
                + verdict.slid_far(self.steps)
                + verdict.beyond_linear_theory(self.steps)
                + verdict.coarse_path(self.book.open_share)
                + verdict.loop_expands(solution)
                + self.others.words()
            ),
            model=self.model,
            contacts=self.contacts(self._by_contact),
            supports=self.budget.of_supports(self._supports),
            reactions=self.budget.of_reactions(self._supports),
            quantities=quantities,
            steps=self.steps,
            checks=checks,
            branches=self.others.branches,
            errors=self.budget.quantities,
            error_notes=self.budget.notes,
            timings=Seconds(**self.timings.summary(problem.comm)),
            versions=compat.versions(),
            points=points,
        )

    def _stopped_short(self, words: str, steps: list[StepRecord]) -> Result:
        """What there is of a history that did not reach its end; collective.

        Args:
            words: Why it did not.
            steps: Those accepted, and the one that was not.
        """
        if self.solution is not None:
            reached = self.steps[-1].load_factor
            words += (
                f" Results are those of the last load step that was done, at time {reached:g} of "
                f"{self.scene.steps.last:g}; --resume goes on from there."
            )
            return dataclasses.replace(
                self._evaluate(), converged=False, verdict=words, steps=steps
            )
        return Result(
            title=self.scene.title,
            converged=False,
            verdict=words,
            model=self.model,
            contacts=self.contacts(),
            supports=[],
            quantities={},
            steps=steps,
            checks={},
            timings=Seconds(**self.timings.summary(self.problem.comm)),
            versions=compat.versions(),
        )

    def _unconverged(self, error: NotConvergedError, tried: float) -> Result:
        """The last step that converged, if any, and the history of the one that did not."""
        step = StepRecord(
            load_factor=tried,
            newton_iterations=max(len(error.residual_history) - 1, 0),
            outer_iterations=0,
            attempts=list(error.attempts),
            residual_history=list(error.residual_history),
            quantities={},
        )
        if self.solution is None:
            return self._stopped_short(f"No answer: {_ended(error)}", [step])
        words = f"No answer at time {tried:g}: {_ended(error)} {self._advice(tried)}"
        return self._stopped_short(words, [*self.steps, step])

    def _advice(self, tried: float) -> str:
        """Which load steps may do better than one that was tried, in words."""
        steps = self.scene.steps
        if not steps.automatic:
            return "Or try more load steps, or steps.automatic = true."
        if tried - self.steps[-1].load_factor > 1.5 * steps.smallest_size:  # cut no further
            return "A larger load step ended in the same way."
        return "Or try a smaller steps.smallest."

    def _interrupted(self) -> Result:
        words = "Interrupted" + ("." if self.solution else " before any load step was done.")
        return dataclasses.replace(self._stopped_short(words, self.steps), interrupted=True)


def _ended(error: NotConvergedError) -> str:
    """What it says, as a sentence."""
    return str(error) + ("" if str(error).endswith(("?", ".")) else ".")


def _log_step(number: int, step: StepRecord) -> None:
    logger.info(step_line(number, step))


def _say_nothing(number: int, step: StepRecord) -> None:
    """Of a run of a single step, its result says it all."""
