"""From a scene to a result: the data's one-way path, in one place."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable
from functools import partial

from mpi4py import MPI

from fenics_contact.common.errors import NotConvergedError, StoppedError
from fenics_contact.common.failures import failing_together, silently
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.energy_balance import EnergyBalance
from fenics_contact.evaluate.momentum_balance import MovingForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.mesh.loading import require_units
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.existence.condition import FreeMotion, require_equilibrium
from fenics_contact.problem.problem import Problem
from fenics_contact.results.load_history import Announce
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Model
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTasks
from fenics_contact.simulation.end_of_run import AtEnd, EndOfRun, ResultOfRun
from fenics_contact.simulation.modes_of_motion import ChosenModes, choose_modes, modes_ahead
from fenics_contact.simulation.motion_errors import MotionErrors
from fenics_contact.simulation.output.functions import Fields
from fenics_contact.simulation.state_file import SavedRun, StateFile
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.steps_of_run import RunListeners, StepsOfRun, by_default
from fenics_contact.simulation.studies.kept_body import KeptBody, mesh_of
from fenics_contact.simulation.studies.slip_factor_errors import SlipFactorErrors
from fenics_contact.solve.condensed.part_factors import KnownFactors
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.solve.load_steps.load_stepper import begin_motion
from fenics_contact.solve.solver_choice import SolverChoice, choose_solver
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)

_ALONE = "What follows an answer, such as its error bars, was not done to its end."
_INTERRUPTED = (
    "Interrupted after the last load step: what is missing of error bars, and of all else that "
    "follows an answer, was not done; --resume does it."
)


class Run:
    """A scene made ready, then solved; kept for those who want the fields.

    Of many in one process keep results, not runs: each has some forty of MPI's communicators, which
    are given back when nobody refers to it any more.

    Attributes:
        scene: What to solve.
        own_mesh: Whether the mesh is not the one that the scene names.
        problem: The model: spaces, energies, forms.
        free_motion: Rigid motions that the supports leave to friction.
        choice: The solver, and how much memory it is to need.
        end: What is known once the last load step is solved.
        timings: Seconds so far.

    Args:
        scene: What to solve.
        comm: Communicator; collective.
        body: The mesh, if not the one the scene names.
        kept: The body, where it serves several runs, one after the other.
        modes: In which bodies move, where these are known.
        own_mesh: Whether the mesh is not the one that the scene names; by default, if it is given.

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
        self,
        scene: Scene,
        comm: MPI.Comm = MPI.COMM_WORLD,
        body: Body | None = None,
        kept: KeptBody | None = None,
        modes: ChosenModes | None = None,
        own_mesh: bool | None = None,
    ) -> None:
        self._kept, self._modes = kept, modes
        self.scene, self.own_mesh = scene, body is not None if own_mesh is None else own_mesh
        self.end = EndOfRun()
        self._at_end: AtEnd | None = None
        self.timings = Timings()
        with failing_together(comm):
            self._make_ready(scene, comm, body)

    def _make_ready(self, scene: Scene, comm: MPI.Comm, body: Body | None) -> None:
        """Mesh, model and solver; collective."""
        if body is not None:
            require_units(scene, comm)
        self._tasks = AnalysisTasks(scene, comm)
        asks_more = self._tasks.use_body
        moves_in_modes = scene.motion is not None and scene.motion.modes is not None
        # What is asked besides uses the body again, but does not change how the answer is computed.
        takes_all = self._tasks.driver.takes_all
        self._solves_many = self._kept is not None or moves_in_modes or not takes_all
        if self._kept is None and (self._solves_many or (asks_more and scene.accuracy is None)):
            body = body or mesh_of(scene, comm, self.timings)
            factors = KnownFactors()
            self._kept = KeptBody(scene, body, self.timings, factors, self._solves_many)
        if self._kept is None:
            body = body or mesh_of(scene, comm, self.timings)
            self._pose(Problem.on_mesh(scene, body, self.timings))
        else:
            modelled = self._tasks.driver.modelled(scene)
            by_points = self._solves_many or scene.motion is not None
            self._pose(Problem(modelled, self._kept.discrete, self.timings, by_points))
            if not self._solves_many:
                choose_solver(self.problem, is_kept=True)  # refuses what memory will not hold later
        self._tasks.require(self.problem)

    def _pose(self, problem: Problem) -> None:
        """Take a problem to be solved next; collective."""
        self.problem = problem
        if problem.scene.motion is not None:
            self.scene = problem.scene  # with the time step that it has chosen
        with self.timings.phase("solve"):
            self.free_motion: FreeMotion = require_equilibrium(problem)
        self.choice: SolverChoice = choose_solver(problem, self._solves_many)
        forces_of = partial(MovingForces if self.scene.motion else BulkForces, problem)
        driver = self._tasks.driver
        self._history: StepHistory[BulkForces] = driver.history(problem, self.timings, forces_of)

    def _choose_modes(self) -> None:
        """Choose the modes of a motion that is to move in few; collective."""
        motion, kept = self.scene.motion, self._kept
        if self._modes is not None or kept is None or motion is None or motion.modes is None:
            return
        kept.need_modes(modes_ahead(motion.modes))
        self._modes = choose_modes(self.scene, motion.modes, self._again)
        # Anew in any case: what faces what is that of the last problem on the body.
        self._pose(Problem(self._modes.scene, kept.discrete, self.timings, by_points=True))

    def _again(
        self, scene: Scene, body: Body | None = None, slip_near: float | None = None
    ) -> Result:
        """Return the result of a scene like this one, on this body or another; collective."""
        kept = self._kept if body is None else None
        modes = ChosenModes(scene)  # how good they are is not asked again
        run = Run(scene, self.problem.comm, body, kept, modes)
        run.end.slip_near = slip_near
        return run.solve(announce=lambda number, step: None)

    def listen_at_end(self, at_end: AtEnd) -> None:
        """Have a function called at the end of the load steps; collective.

        Args:
            at_end: Gets the load steps, and the errors of cells where these were estimated.
        """
        self._at_end = at_end

    @property
    def solution(self) -> Solution | None:
        """Nodal values of this rank of the last load step that was solved, if any."""
        return self._history.solution

    @property
    def forces(self) -> BulkForces:
        """Nodal forces that the bulk needs in that step."""
        return self._history.forces

    @property
    def fields(self) -> Fields:
        """The last step as functions of dolfinx; collective. ``InputError`` before there is one."""
        return self._history.fields

    @property
    def steps(self) -> list[StepRecord]:
        """Records of the load steps so far."""
        return self._history.steps

    @property
    def energy_balance(self) -> EnergyBalance:
        """Work and energies along them."""
        return self._history.energy_balance

    @property
    def analyses(self) -> AnalysisTasks:
        """Tasks of the scene's analyses in this run, with their results."""
        return self._tasks

    @property
    def model(self) -> Model:
        """``model`` of ``result.json``; collective."""
        return self._result.model

    def contacts(self) -> list[ContactRecord]:
        """``contacts`` of ``result.json``, without quantities."""
        return self._result.contacts()

    @property
    def _result(self) -> ResultOfRun:
        """What puts the result together, of what is known by now."""
        return ResultOfRun(
            scene=self.scene,
            problem=self.problem,
            free_motion=self.free_motion,
            choice=self.choice,
            history=self._history,
            tasks=self._tasks,
            end=self.end,
            modes=self._modes or ChosenModes(self.scene),
            timings=self.timings,
        )

    def solve(
        self,
        state: StateFile | None = None,
        saved: SavedRun | None = None,
        stopped: Callable[[], bool] | None = None,
        announce: Announce | None = None,
        accepted: Callable[[], None] | None = None,
        guess: Unknowns | None = None,
        answered: Callable[[Result], None] | None = None,
    ) -> Result:
        """Solve and evaluate; collective. Failure to converge is a result, too.

        Whatever fails once the last load step is solved, of error bars, derivatives and all else
        that an answer stands without, is said in the result.

        Args:
            state: Where to keep the state of every accepted load step.
            saved: The state of another run, to go on from.
            stopped: Whether this rank was asked to stop; then the last accepted step counts.
            announce: Called with number and record of every accepted step; by default it is
                logged, where there are several.
            accepted: Called when a load step has been added to ``steps``; collective.
            guess: Where the first load step is thought to end.
            answered: Called with the answer alone, before all that follows it; collective.

        Returns:
            What came out, the same on every rank.

        Raises:
            MachineError: The machine failed: memory, a file.
        """
        told = announce or by_default(self.scene)
        calls = (told, accepted, stopped, partial(self._answer_alone, answered), self._at_end)
        listeners = RunListeners(*calls)
        with failing_together(self.problem.comm):
            if state is not None:
                state.make_folder()
            self._choose_modes()
            parts = (self.scene, self._history, self._tasks, self.timings, listeners)
            return self._solve(StepsOfRun(*parts, state, saved, guess), saved)

    def _solve(self, taken: StepsOfRun, saved: SavedRun | None) -> Result:
        """Take the load steps and put the result together; collective."""
        history = self._history
        begin_motion(self.problem, self.timings)
        history.begin([] if saved is None else saved.steps)
        with self.timings.phase("output"):
            self._tasks.begin(self.problem)
        self.end = EndOfRun(slip_near=self.end.slip_near)
        try:
            condense = None if self._kept is None else self._kept.condense
            taken.take(self.problem, self.choice, condense, self.end)
        except NotConvergedError as error:
            return self._result.unconverged(error, taken.tried, taken.spent)
        except StoppedError:
            return self._result.interrupted()
        if self.scene.motion is not None and self.scene.solver.errors == "all":
            self._judge_motion()
        if self.scene.solver.slip_limit == "steps" and self.scene.solver.errors == "all":
            self._judge_slip_factor()
        result = self._result.evaluate()
        if self.end.interrupted:
            words = f"{result.verdict} {_INTERRUPTED}"
            return dataclasses.replace(result, verdict=words, interrupted=True)
        return result if self.scene.accuracy is not None else self.with_all_asked(result)

    def _answer_alone(self, answered: Callable[[Result], None] | None) -> None:
        """Tell the answer before what follows it, if something does; collective."""
        if answered is not None and self._is_judged:
            result = self._result.evaluate()
            answered(dataclasses.replace(result, verdict=f"{result.verdict} {_ALONE}"))

    @property
    def _is_judged(self) -> bool:
        """Whether more than the answer is asked for."""
        return self.scene.solver.errors != "none" or self._tasks.use_body

    def _judge_motion(self) -> None:
        """Estimate the errors of its last step; collective."""
        with self.timings.phase("errors"), silently():
            parts = self.scene, self.problem.spaces, self.contacts(), self.steps[-1]
            self.end.take_budget(self.problem.comm, MotionErrors(*parts, self._again).budget)

    def _judge_slip_factor(self) -> None:
        """Estimate the errors of the factor at which a part slips, if it is known; collective."""
        slip = self.end.slip
        if slip.factor is None or slip.is_bound:
            return
        with self.timings.phase("errors"), silently():
            parts = self.scene, self.problem.spaces, self.contacts(), slip
            found = SlipFactorErrors(*parts, self._again)
            self.end.slip_errors = found.row(self.end.notes)

    def with_all_asked(self, result: Result) -> Result:
        """With what analyses of the scene find once the answer is there, if any; collective.

        Args:
            result: Of this run, that converged.
        """
        return self._tasks.complete(result, self._kept_body, self.timings)

    def _kept_body(self) -> KeptBody:
        """The body for what is asked of the answer; of a run on several meshes one of its own."""
        if self._kept is not None:
            self._kept.serve_many()
            return self._kept
        return KeptBody(self.scene, self.problem.body, Timings(), KnownFactors())
