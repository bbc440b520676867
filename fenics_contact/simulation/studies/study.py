"""One scene asked again and again: what the answers share is made once and kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from fenics_contact.body.description import BodyDescription
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import failing_together
from fenics_contact.common.timings import Timings
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.sensitivities.derivatives import Derivatives
from fenics_contact.simulation.sensitivities.scene_values import refuse_accuracy, with_changes
from fenics_contact.simulation.studies.kept_body import BodyOfStudy, KeptBody
from fenics_contact.simulation.studies.quick_answers import Answer, QuickAnswers
from fenics_contact.simulation.studies.saved_body import SavedBody, save_body, text_of
from fenics_contact.simulation.studies.solved_derivatives import solved_derivatives
from fenics_contact.simulation.studies.solved_history import History, solved_history

if TYPE_CHECKING:
    from fenics_contact import Exploration, Objective
    from fenics_contact.analyses.vibration.vibration import Vibration
    from fenics_contact.analyses.wear_cycles.table import CycleJump
    from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle

# Other values of a scene's keys; a whole scene; or nothing.
Changes = Mapping[str, Any] | Scene | None


class Study:
    """A scene whose answers are asked for under many conditions; on any number of ranks.

    The mesh, the stiffness, its factorisation and what is left of it at the contacts are made when
    the first answer needs them, and kept. Coefficients and laws of contacts, obstacles, loads,
    values of supports, preloads, load steps and the solver's settings may change from one answer to
    the next at little cost. Where something changes that the stiffness depends on, such as a
    material or the mesh, the body is made anew, and a line in the log says so.

    Attributes:
        scene: As it is without changes.
        comm: The ranks that it is on.
        run: The last answer's run, with its fields; None before there is one.
        factorisations: How often a body was factorised.

    Args:
        scene: What to solve.
        comm: Communicator; collective.
        body: The mesh, if not the one the scene names.

    Raises:
        InputError: The scene asks for an accuracy, for which every answer needs its own mesh.

    A block that is pressed and pulled, on floors of different roughness; equilibrium says what
    the floor has to carry:

    >>> from fenics_contact import load_scene, main
    >>> main(["new", "own", "--quiet"])  # writes own.toml and own.geo
    0
    >>> study = Study(load_scene("own.toml"))
    >>> found = [study.solve({"contact.0.friction_coefficient": c}) for c in (0.5, 0.4)]
    >>> [abs(each.quantities["friction_force"][0] + 3) < 1e-8 for each in found]
    [True, True]
    >>> study.factorisations
    1
    """

    def __init__(
        self, scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None
    ) -> None:
        refuse_accuracy(scene)
        self.scene, self.comm = scene, comm
        self.run: Run | None = None
        self._body = BodyOfStudy(comm, body)
        self._quick: QuickAnswers | None = None

    @classmethod
    def load(
        cls,
        file: str | Path,
        scene: Scene | None = None,
        comm: MPI.Comm = MPI.COMM_WORLD,
        body: Body | None = None,
    ) -> Study:
        """A study whose body was condensed before; collective, on any number of ranks.

        The body is factorised again only when a field inside of it is asked for.

        Args:
            file: As ``save`` wrote it.
            scene: What to solve, by default the scene that was saved; of it, only what is no part
                of the body may be another.
            comm: Communicator.
            body: The mesh, if not the one the scene names.

        Raises:
            InputError: The file is damaged, of another version, or of another body.
        """
        path = Path(file)
        with failing_together(comm):
            saved = SavedBody(comm, path)
            if scene is None and not saved.scene:
                raise InputError(
                    f"{path}: its scene has what no file can have, such as functions: give it as "
                    "scene"
                )
            study = cls(scene or scene_of_text(saved.scene, path), comm, body)
            kept = study._body_of(study.scene)
            saved.require_fit(kept.discrete.description, kept.discrete.spaces.body)
            kept.take_saved(saved)
        return study

    def save(self, file: str | Path) -> None:
        """Write the condensed body to a file, for ``load``; collective.

        Args:
            file: Where to; what is there is replaced.

        Raises:
            InputError: Nothing was solved yet, or a stabilisation holds the body.
            MachineError: The file could not be written; what was there stays.
        """
        path, kept = Path(file), self._body.kept
        if kept is None or kept.condensed is None:
            raise InputError(f"{path}: solve before saving: no body is condensed yet")
        described = BodyDescription.of(self.scene)
        if not kept.discrete.description.differences_without_temperature_fields(described):
            self._body_of(self.scene)  # with its own temperatures
        with failing_together(self.comm):
            kept.make_rows()
            save_body(path, kept.condensed, text_of(self.scene))

    @property
    def factorisations(self) -> int:
        """How often a body was factorised."""
        return self._body.factorisations

    def changed(self, changes: Changes = None) -> Scene:
        """The scene with other values.

        Args:
            changes: Key → value; keys as of ``--set``, such as ``contact.0.friction_coefficient``.
                Or the whole scene.

        Raises:
            InputError: A key is none of the scene, or the scene cannot have such a value.
        """
        found = changes if isinstance(changes, Scene) else with_changes(self.scene, changes or {})
        refuse_accuracy(found)
        return found

    def other_parts(self, changes: Mapping[str, Any]) -> list[str]:
        """Return the parts of the body that other values change, so that it is built again.

        Args:
            changes: As of ``changed``.
        """
        return self._body.differences(self.scene, self.changed(changes))

    def solve(self, changes: Changes = None) -> Result:
        """Solve and evaluate the scene with other values; collective.

        Args:
            changes: Key → value; keys as of ``--set``, such as ``contact.0.friction_coefficient``.
                Or the whole scene, as it is to be solved.

        Returns:
            What ``fenics_contact.run`` of the changed scene gives.

        Raises:
            InputError: A key is none of the scene, or the scene cannot have such a value, or has no
                equilibrium with it.
            MachineError: The machine failed: memory, a file.
        """
        run = self.prepare(changes)
        result = run.solve()
        self.run = run
        return result

    def quantities(
        self,
        changes: Changes = None,
        follow: bool = False,
        checks: bool = True,
    ) -> Answer:
        """Solve the scene with other values, for its numbers alone; collective.

        Without fields and error bars, and mostly from the last answer on: the quickest way to many
        answers. Where more than one answer may be, it begins as a separate run does.

        Args:
            changes: As of ``solve``.
            follow: Begin at the last answer in any case, and follow its branch.
            checks: Check the physics as far as that takes no field.

        Raises:
            InputError: As of ``solve``.
            MachineError: Likewise.
        """
        scene = self.changed(changes)
        with failing_together(self.comm):
            kept = self._body_of(scene)
            if self._quick is None:
                self._quick = QuickAnswers(kept)
            return self._quick.answer(scene, follow, checks)

    def displacement(self) -> Array:
        """Displacement in the last quick answer, by one back-substitution; collective.

        Returns:
            At the nodes of this rank, (nodes, components), in the order of a run's fields (length).

        Raises:
            InputError: There is no quick answer yet.
        """
        find = None if self._quick is None else self._quick.find_body
        if find is None:
            raise InputError("displacement: ask for quantities first: there is no quick answer yet")
        return find().displacement

    def explore(
        self,
        vary: Sequence[str] | Mapping[str, tuple[float, float]] = (),
        host: str = "127.0.0.1",
        port: int = 0,
    ) -> Exploration:
        """A page on which numbers of the scene are moved, and its answer follows; on one rank.

        A notebook shows it where it is the last value of a cell. Elsewhere its ``serve`` answers
        until Ctrl-C.

        Args:
            vary: What is moved: key → (low, high), or ``KEY=LOW:HIGH`` each; by default numbers of
                contacts, loads, preloads and supports.
            host: Address to listen at.
            port: Port, 0 for a free one.

        Raises:
            InputError: There are several ranks; a key or a range is none; nothing can listen there.
        """
        from fenics_contact import Exploration

        return Exploration(self, vary, host, port, in_frames=True)

    def derivatives(
        self,
        of: Sequence[str],
        by: Sequence[str] | None = None,
        changes: Mapping[str, Any] | None = None,
    ) -> Derivatives:
        """Exact derivatives of the discrete answer, by its adjoint; collective.

        Of the answer of a separate run, with automatic ε and ε₁, load steps, and what faces what
        of two bodies held. From cell to cell of the edge of contact, or of stick, they jump by some
        per cent: a finer mesh makes these jumps smaller.

        Args:
            of: Names of quantities: ``normal_force``, ``NAME.quantity``, components as
                ``friction_force_x``.
            by: Keys of numbers of the scene, as of ``solve``; None for all that have a derivative.
            changes: As of ``solve``: of the answer, not of what it is differentiated by.

        Returns:
            Quantity → key → derivative (unit of the quantity over that of the number).

        Raises:
            InputError: A quantity or a key has no derivative; or as of ``solve``.
            NotConvergedError: There is no answer.
            MachineError: As of ``solve``.
        """
        scene = self.changed(changes)
        with failing_together(self.comm):
            return solved_derivatives(self._body_of(scene), scene, of, by).slopes

    def objective(
        self, of: str, by: Sequence[str], changes: Mapping[str, Any] | None = None
    ) -> Objective:
        """A quantity as a function of numbers, with its gradient, for optimisers of SciPy.

        It takes the numbers and returns the quantity and its exact derivatives, as
        ``scipy.optimize.minimize(objective, start, jac=True)`` wants them.

        Args:
            of: Name of the quantity, as of ``derivatives``.
            by: Keys of the numbers.
            changes: As of ``solve``: of all answers.
        """
        from fenics_contact import Objective

        return Objective(self, of, by, changes)

    def history(
        self,
        of: Sequence[str],
        by: Sequence[str],
        changes: Changes = None,
        is_judged: bool = False,
        is_whole: bool = True,
    ) -> History:
        """All load steps of the scene with other values, and their exact derivatives; collective.

        Args:
            of: Names of quantities, as of ``derivatives``.
            by: Keys of numbers of the scene.
            changes: As of ``solve``.
            is_judged: Check the physics at the end, and estimate what the mesh, ε₁ and ε change of
                the quantities.
            is_whole: Differentiate all load steps, not the last one alone.

        Raises:
            InputError: As of ``derivatives``.
            NotConvergedError: There is no answer.
            MachineError: As of ``solve``.
        """
        scene = self.changed(changes)
        with failing_together(self.comm):
            return solved_history(self._body_of(scene), scene, of, by, is_judged, is_whole)

    def wear_cycles(
        self,
        begin: float | None = None,
        cycles: int | None = None,
        jumps: CycleJump | None = None,
        changes: Mapping[str, Any] | Scene | None = None,
        folder: str | Path | None = None,
    ) -> Iterator[WearCycle]:
        """Wear over many cycles of loads, most of which are passed over; collective.

        They are those of the scene's ``cycles``. Where it has none, its load steps lead to the
        begin of a cycle, and through it once.

        Args:
            begin: Pseudo-time at which the cycle begins, the end of a load step, with the loads of
                the last one; by default that of ``cycles``.
            cycles: How many there are; by default as many as ``cycles`` has.
            jumps: How far cycles may be passed over; by default as ``cycles`` says, or else as far
                as pressures change by 20 % and depths are off by 1 %.
            changes: As of ``solve``.
            folder: Where to write ``wear.csv``, a row a cycle, and ``wear_profiles.csv``, with the
                contact points of each; whatever ends the run, what was computed is there.

        Returns:
            Each cycle that is computed, when it is; the last one is among them.

        Raises:
            InputError: As of ``solve``; or no contact wears, or the cycle is none.
            NotConvergedError: A load step of a cycle.
            MachineError: A file could not be written.
        """
        from fenics_contact.analyses.wear_cycles.table import CycleJump
        from fenics_contact.analyses.wear_cycles.wear_cycle import WornFiles, one_cycle
        from fenics_contact.analyses.wear_cycles.wear_cycles import WearCycles

        scene = self.changed(changes)
        with failing_together(self.comm):
            said = None if scene.cycles is None else scene.cycles.jumps
            once, begin, cycles = one_cycle(scene, begin, cycles)
            with self._body_of(once).stepping(once, Timings()) as (load_steps, _):
                cycling = WearCycles(load_steps, begin, jumps or said or CycleJump())
                files = None if folder is None else WornFiles(self.comm, Path(folder))
                for cycle in cycling.run(cycles):
                    if files is not None:
                        files.add(cycle)
                    yield cycle

    worn = wear_cycles  # its earlier name, which scripts of users have

    def vibration(self, changes: Mapping[str, Any] | Scene | None = None) -> Vibration:
        """Modes about the last state of the scene, and what joints damp of them; collective.

        As the scene asks for them by ``modes`` and ``damping``.

        Args:
            changes: As of ``solve``.

        Raises:
            InputError: As of ``solve``; or it asks for no modes, or for more than there are.
            NotConvergedError: There is no state to vibrate about, or its modes were not found.
            MachineError: As of ``solve``.
        """
        from fenics_contact.analyses.vibration.vibration import vibration_of

        scene = self.changed(changes)
        with failing_together(self.comm):
            return vibration_of(self._body_of(scene), scene)

    def forget_answer(self) -> None:
        """Begin the next quick answer as a separate run does, not at the last one."""
        self._quick = None

    def prepare(self, changes: Changes = None) -> Run:
        """The run of the scene with other values, to be solved before any other; collective.

        Args:
            changes: As of ``solve``.

        Raises:
            InputError: As of ``solve``.
        """
        scene = self.changed(changes)
        with failing_together(self.comm):
            kept = self._body_of(scene)
        return Run(scene, self.comm, kept=kept)

    def _body_of(self, scene: Scene) -> KeptBody:
        """Return the body of a scene; answers of another one are forgotten; collective."""
        before, found = self._body.kept, self._body.of(scene, Timings())
        if found is not before:
            self._quick = self.run = None
        return found

    def close(self) -> None:
        """Free the factorisation; the next answer makes another one."""
        self._body.close()
