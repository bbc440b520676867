"""A body that is kept between answers: made ready once, condensed once, and found again."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from mpi4py import MPI

from fenics_contact.analyses import registry
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.arrays import Flags
from fenics_contact.common.errors import FenicsContactError, InputError
from fenics_contact.common.timings import Timings
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.evaluate.rows_of_body import RowsOfBody
from fenics_contact.mesh.loading import load_body, require_units
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.massless import ContactMasses, FreeModes
from fenics_contact.problem.moving import moving
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.saved_body import SavedBody
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem, acting_sides
from fenics_contact.solve.condensed.part_factors import KnownFactors
from fenics_contact.solve.free_modes import free_modes
from fenics_contact.solve.load_steps.load_stepper import load_steps_on, stepping_on
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.modal_bulk import ModalBulk


def mesh_of(scene: Scene, comm: MPI.Comm, timings: Timings) -> Body:
    """The mesh that a scene names; collective.

    Raises:
        InputError: It names none, or one that cannot be used.
    """
    if not scene.mesh:
        raise InputError("mesh: the scene names no mesh and no body was passed")
    require_units(scene, comm)
    with timings.phase("mesh"):
        curved = scene.accuracy is not None and scene.discretisation.degree > 1
        return load_body(scene.mesh, scene.dimension, comm, curved=curved, preloads=scene.preload)


class KeptBody:
    """A body with its factorisation, for one problem after the other; collective.

    Attributes:
        discrete: The body made ready.
        condensed: The body condensed, None before a problem needs it.

    Args:
        scene: Any whose body it is.
        body: Its mesh.
        timings: Seconds so far.
        factors: Of the parts of the body before it; those of its own parts are added.
        serves_many: Whether it serves many problems from the first one on; by default it does.
    """

    def __init__(
        self,
        scene: Scene,
        body: Body,
        timings: Timings,
        factors: KnownFactors,
        serves_many: bool = True,
    ) -> None:
        with timings.phase("compile"):
            self.discrete = DiscreteBody(BodyDescription.of(scene), body)
        if serves_many:
            self.serve_many()
        self._factors = factors
        self._earlier = 0
        self._problem: Problem | None = None
        self._modes: FreeModes | None = None
        self._modes_ahead = 0
        self.condensed: CondensedBody | None = None
        self._saved: SavedBody | None = None
        self._system: CondensedSystem | None = None
        self._exact: ExactSolver | None = None

    def take_saved(self, saved: SavedBody) -> None:
        """Have what a file has of the condensed body, for the first problem that it suits."""
        self._saved = saved

    def need_modes(self, number: int) -> None:
        """Find at least this many modes together, once a motion needs some."""
        self._modes_ahead = number

    def serve_many(self) -> None:
        """From now on keep what each problem would work out of the body."""
        self.discrete.serve_many()

    def take_temperatures(self, description: BodyDescription) -> None:
        """Take temperatures that vary in other ways in space, by a solve inside it; collective.

        Args:
            description: Of this body but for these fields.
        """
        self.discrete.take_temperatures(description)
        self._forget_system()
        if self.condensed is not None:
            self.condensed.renew_scalars()

    @property
    def factorisations(self) -> int:
        """How often it was factorised."""
        return self._earlier + (0 if self.condensed is None else self.condensed.factorisations)

    def condense(self, problem: Problem, timings: Timings) -> CondensedBody | None:
        """The body condensed, as a problem needs it; collective.

        Args:
            problem: On this body.
            timings: Seconds so far.

        Returns:
            None where it cannot serve: of a motion of all that a mesh can do, by other masses.
        """
        motion = problem.scene.motion
        if motion is None:
            return self.in_statics(problem, timings)
        if motion.modes is None:
            return None
        assert motion.modes.number != "automatic"
        return self._moving(problem, motion.modes.number, timings)

    def _moving(self, problem: Problem, number: int, timings: Timings) -> CondensedBody:
        """For a motion in modes, of which those that are known serve again; collective."""
        body, inertia = self.in_statics(problem, timings), moving(problem.inertia)

        def find(masses: ContactMasses, held: Flags) -> FreeModes:
            known = self._modes
            if known is None or len(known.squares) - known.rigid < number:
                found = max(number, self._modes_ahead)
                self._modes = known = free_modes(body, masses, held, found)
            return known.first(number)

        with timings.phase("factorise"):
            modes = inertia.modes(find)
            return body.with_bulk(ModalBulk(body, modes, inertia.size))

    def in_statics(self, problem: Problem, timings: Timings) -> CondensedBody:
        """The body condensed, with nothing of masses; collective.

        Again only where a surface is to carry forces that never did before, or where a
        stabilisation holds the body in another way.

        Args:
            problem: On this body.
            timings: Seconds so far.
        """
        self._problem = problem
        sides, before = acting_sides(problem), self.condensed
        if before is not None:
            if before.serves(problem.constrained, sides):
                return before
            sides = self._with_earlier(sides, before)
            self.close()
        schur, saved = None, self._saved
        if saved is not None and saved.suits(self.discrete, problem.constrained, sides):
            sides, schur = saved.sides(self.discrete), partial(saved.schur, self.discrete)
        self.condensed = CondensedBody(
            self.discrete, problem.constrained, sides, timings, schur, self._factors
        )
        if saved is not None and schur is not None:
            saved.give_to(self.condensed)
        self._saved = None
        return self.condensed

    @contextmanager
    def stepping(
        self, scene: Scene, timings: Timings
    ) -> Iterator[tuple[LoadSteps, CondensedSystem]]:
        """The load steps of a scene on the body, none of them taken; collective.

        Args:
            scene: Whose body it is.
            timings: Seconds so far.

        Returns:
            The load steps and their system, while these are in use; what is inside the body is
            found where somebody asks for it.

        Raises:
            InputError: The scene cannot be used, has no equilibrium, or asks for load steps to be
                taken in another way.
        """
        system = self._new_system(scene, timings)
        with stepping_on(system, timings, finds_body=False) as load_steps:
            yield load_steps, system

    @contextmanager
    def stepping_again(
        self, scene: Scene, timings: Timings
    ) -> Iterator[tuple[LoadSteps, CondensedSystem]]:
        """Load steps of one scene after the other, with one problem where it serves; collective.

        Problem and system are kept, and take the values of the next scene, if nothing else differs
        and nobody used the body meanwhile.

        Args:
            scene: Whose body it is.
            timings: Seconds so far.

        Raises:
            InputError: As of ``stepping``.
        """
        try:
            system = self._system = self._system_of(scene, timings)
            load_steps = load_steps_on(system, timings, finds_body=False)
            newton = load_steps.newton
            if newton.exact is not None and self._exact is not None:
                newton.exact = self._exact
            self._exact = newton.exact
            yield load_steps, system
        except BaseException:  # what state it is in nobody knows
            self._forget_system()
            raise

    def _system_of(self, scene: Scene, timings: Timings) -> CondensedSystem:
        """The last one, if it serves a scene, else another one; collective."""
        known = self._system
        if known is not None and self._begins_again(known, scene):
            return known
        self._forget_system()
        return self._new_system(scene, timings)

    def _begins_again(self, system: CondensedSystem, scene: Scene) -> bool:
        """Whether a system has the problem of another scene now; collective."""
        problem = system.problem
        if problem is not self._problem or system.body is not self.condensed:
            return False
        if not problem.begin_again(scene):
            return False
        require_equilibrium(problem)
        system.begin_again()
        if self._exact is not None:
            self._exact.begin_again()
        return not problem.stabilisation

    def _forget_system(self) -> None:
        if self._system is not None:
            self._system.destroy()
        self._system = self._exact = None

    def _new_system(self, scene: Scene, timings: Timings) -> CondensedSystem:
        """The problem of a scene, condensed; collective."""
        own = registry.takes_steps_of(scene)
        if own is not None:
            raise InputError(own.part("table").ONE_BY_ONE)
        problem = Problem(scene, self.discrete, timings, by_points=True)
        require_equilibrium(problem)
        return CondensedSystem(problem, timings, self.in_statics(problem, timings))

    def make_rows(self) -> None:
        """Make those that quick answers of the last problem ask for; collective."""
        if self.condensed is not None and self._problem is not None:
            RowsOfBody(self._problem, self.condensed).make_all()

    def _with_earlier(self, sides: list[ContactSides], before: CondensedBody) -> list[ContactSides]:
        """Surfaces in scene order, with those that were condensed onto before."""
        chosen = {id(one) for one in (*sides, *before.sides)}
        return [one for one in self.discrete.sides if id(one) in chosen]

    def close(self) -> None:
        """Free the factorisation; the next answer makes another one."""
        self._forget_system()
        if self.condensed is not None:
            self._earlier = self.factorisations
            self.condensed.destroy()
            self.condensed = None


logger = logging.getLogger(__name__)


class BodyOfStudy:
    """The last body, and what the next one can take of it.

    Attributes:
        kept: The body, None before there is one.
        factors: Of the parts of the bodies so far.

    Args:
        comm: The ranks that it is on.
        mesh: That of all scenes; None: the one that each names.
    """

    def __init__(self, comm: MPI.Comm, mesh: Body | None) -> None:
        self.kept: KeptBody | None = None
        self._comm, self._mesh, self._own_mesh = comm, mesh, mesh is not None
        self._mesh_of: Sequence[object] = ()
        self.factors = KnownFactors()
        self._before = 0  # factorisations of bodies that are gone

    @property
    def factorisations(self) -> int:
        """How often a body was factorised."""
        return self._before + (0 if self.kept is None else self.kept.factorisations)

    def differences(self, scene: Scene, other: Scene) -> list[str]:
        """Return the names of the parts by which the bodies of two scenes differ."""
        one, another = (BodyDescription.of(each) for each in (scene, other))
        found = list(one.differences_without_temperature_fields(another))
        return found if self._same_mesh(mesh_key(scene), other) else ["mesh", *found]

    def of(self, scene: Scene, timings: Timings) -> KeptBody:
        """Return the body of a scene, built again if the last one was another; collective.

        Args:
            scene: The scene.
            timings: Seconds so far.
        """
        same_mesh = self._same_mesh(self._mesh_of, scene)
        if self.kept is not None:
            description = BodyDescription.of(scene)
            known = self.kept.discrete.description
            other = list(known.differences_without_temperature_fields(description))
            other += [] if same_mesh else ["mesh"]
            if not other:
                return self._at_temperatures(self.kept, description)
            logger.info("the body is made anew: other %s", ", ".join(other))
            self._before += self.kept.factorisations
            self.kept.close()
            self.kept = None
        if self._mesh is None or not same_mesh:
            self._mesh, self._mesh_of = mesh_of(scene, self._comm, timings), mesh_key(scene)
        self.kept = KeptBody(scene, self._mesh, timings, self.factors)
        return self.kept

    def _at_temperatures(self, kept: KeptBody, description: BodyDescription) -> KeptBody:
        """The body with the temperatures of a description; collective."""
        if not kept.discrete.description.differences(description):
            return kept
        try:
            kept.take_temperatures(description)
        except FenicsContactError:  # it has some of both
            self._before += kept.factorisations
            kept.close()
            self.kept = None
            raise
        return kept

    def _same_mesh(self, key: Sequence[object], scene: Scene) -> bool:
        return self._own_mesh or key == mesh_key(scene)

    def close(self) -> None:
        """Free the factorisation; the next answer makes another one."""
        if self.kept is not None:
            self.kept.close()
        self.factors.destroy()


def mesh_key(scene: Scene) -> Sequence[object]:
    """Return the part of a scene that its mesh depends on: files, and cuts for preloads."""
    return scene.mesh, [(p.on, p.axis, p.between) for p in scene.preload if p.between is not None]
