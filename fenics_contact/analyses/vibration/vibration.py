"""Modes that a scene asks for, and what joints damp of them as they are driven to and fro."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from fenics_contact.analyses.vibration.eigenmodes import Mode, mode_records, stuck_modes
from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.analyses.vibration.table import Damping
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.loads.disturbance import Drive
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.condensed.schur import Functional
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.cycle_watch import change_to_come
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.step_control import PaceOfCycles
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Vibration:
    """How a body vibrates about the last state of a scene.

    Attributes:
        modes: Of small amplitude, as ``result.json`` has them.
        shapes: With their displacements.
        damping: What joints damp of those that were driven.
        notes: Sentences on what was not to be had.
    """

    modes: Sequence[ModeRecord]
    shapes: Sequence[Mode]
    damping: Sequence[DampingRecord] = ()
    notes: Sequence[str] = field(default_factory=list)


def vibration_of(kept: KeptBody, scene: Scene) -> Vibration:
    """Solve a scene, find its modes, and drive those that it says; collective.

    Args:
        kept: Its body.
        scene: One that asks for modes.

    Raises:
        InputError: It asks for none, or for more than there are; or it has no equilibrium.
        NotConvergedError: There is no state to vibrate about, or its modes were not found.
    """
    if scene.modes is None:
        raise InputError("modes: the scene asks for none; say how many by [modes]")
    others = damping_scenes(scene)
    if not others:
        return _vibration(kept, scene)
    found = _vibration(kept, replace(scene, damping=None))
    rows: list[DampingRecord] = []
    notes: list[str] = []
    for values, other in others:
        words = ", ".join(f"{key} = {value:g}" for key, value in values.items())
        one = _vibration(kept, other)
        rows += [replace(row, by=values) for row in one.damping]
        notes += [f"With {words}: {note}" for note in one.notes]
    return replace(found, damping=rows, notes=notes)


def damping_scenes(scene: Scene) -> list[tuple[dict[str, float], Scene]]:
    """Return the scene with each combination of the values that damping is asked for ``by``.

    Returns:
        Values by their keys, with the scene that has them; none where it asks for no others.

    Raises:
        InputError: A key is none of the scene, or the scene cannot have such a value.
    """
    asked = scene.damping
    if asked is None or not asked.by:
        return []
    alone = replace(scene, damping=replace(asked, by={}))
    found = []
    for values in product(*asked.by.values()):
        named = dict(zip(asked.by, values, strict=True))
        try:
            other = with_changes(alone, named)
        except InputError as error:
            raise InputError(f"damping.by: {error}") from None
        if BodyDescription.of(other).differences(BodyDescription.of(scene)):
            raise InputError(
                f"damping.by: {', '.join(asked.by)}: would change what the body is; vary those of "
                "contacts, loads, preloads or supports"
            )
        found.append((named, other))
    return found


def _vibration(kept: KeptBody, scene: Scene) -> Vibration:
    """Return the vibration of a scene with one set of values; collective."""
    assert scene.modes is not None
    timings = Timings()
    with kept.stepping(scene, timings) as (load_steps, system):
        load_steps.solve()
        begin = load_steps.last
        assert begin is not None
        load_steps.go_on_from(begin, begin.unknowns.time)
        shapes = stuck_modes(system, system.body, scene.modes.number)
        load_steps.go_on_from(begin, begin.unknowns.time)
        found, notes = _damped(load_steps, system, begin, shapes)
        return Vibration(mode_records(shapes), shapes, found, [*_of_sectors(scene), *notes])


def _of_sectors(scene: Scene) -> list[str]:
    """Return a sentence that says which modes of the ring a sector has; none for a whole body."""
    sector = scene.cyclic_symmetry
    if sector is None:
        return []
    return [
        f"The modes are those in which all {sector.sectors} sectors move alike (harmonic 0); the "
        "ring has others."
    ]


def _damped(
    load_steps: LoadSteps,
    system: CondensedSystem,
    begin: AcceptedStep,
    shapes: Sequence[Mode],
) -> tuple[list[DampingRecord], list[str]]:
    """Each mode at all amplitudes, and why not."""
    asked = system.problem.scene.damping
    rows: list[DampingRecord] = []
    notes: list[str] = []
    for number in () if asked is None else asked.modes:
        assert asked is not None
        driven = DrivenMode(load_steps, system, begin, shapes[number - 1], number, asked)
        for amplitude in asked.amplitudes:
            try:
                rows.append(driven.driven(float(amplitude)))
            except NotConvergedError as error:
                notes.append(
                    f"Mode {number} was not driven to {amplitude:g}, nor beyond: {error} "
                    "Where its joints slide through, no forces hold it there: drive it less far."
                )
                logger.warning("%s", notes[-1])
                break
            logger.info(
                "  mode %d at %g: frequency %.6g, damping ratio %.3g",
                number,
                rows[-1].amplitude,
                rows[-1].natural_frequency,
                rows[-1].damping_ratio,
            )
    return rows, notes


# Pseudo-time of a cycle.
_PERIOD = 4.0
# Of the tolerance: a change in a cycle that need not become less.
_CREEPS = 0.05
# Cycles that tell whether it has settled, and a loss over the work that is none.
_FEWEST, _NO_LOSS = 3, 1e-5


class DrivenMode(StepListener):
    """Forces ω² a M φ, a from 0 up, then to and fro; collective, as all its methods.

    Args:
        load_steps: Those that have led to the state about which it vibrates.
        system: Their unknowns.
        begin: The load step about which it vibrates.
        mode: The mode.
        number: Of the mode.
        asked: Of the scene.
    """

    def __init__(
        self,
        load_steps: LoadSteps,
        system: CondensedSystem,
        begin: AcceptedStep,
        mode: Mode,
        number: int,
        asked: Damping,
    ) -> None:
        self._problem, self._system, self._begin = system.problem, system, begin
        self._mode, self._number, self._asked = mode, number, asked
        self._load_steps, body = load_steps, system.body
        share = body.stiffness.share
        (self._row,) = body.rows.maker.make([Functional(forces=share(mode.forces))])
        self._of_drive = self._work_of(share(mode.forces))
        forces = system.problem.elastic.scalar_forces
        self._of_scalars = np.array(
            [self._work_of(share(one.nodal, one.on_mean_stress)) for one in forces]
        )
        self._at_rest: tuple[Array, Array] = np.zeros(0), np.zeros(0)

    def _work_of(self, share: Array) -> float:
        return float(total(self._problem.comm, float(self._row.of_forces @ share)))

    def driven(self, amplitude: float) -> DampingRecord:
        """The loop of an amplitude.

        Args:
            amplitude: Largest displacement if nothing slips (length).

        Raises:
            NotConvergedError: A load step, as where joints slide through.
        """
        problem, begin, asked = self._problem, self._begin, self._asked
        rest = begin.unknowns.time
        self._force = self._mode.circular_frequency**2 * amplitude
        first = rest + 0.25 * _PERIOD
        cycles = Cycles(
            begin=first, end=first + _PERIOD, number=asked.cycles, tolerance=asked.tolerance
        )
        problem.drive = Drive(self._force * self._mode.forces, rest, _to_and_fro)
        try:
            self._load_steps.go_to_and_fro(begin, cycles, asked.increments)
            self._at_rest = self._system.position(), self._scalars()
            self._loop: list[tuple[float, float]] = []
            self._lost: list[Array] = []
            self._load_steps.solve(self)
            assert self._load_steps.last is not None
            return self._record(amplitude, self._load_steps.last.solution)
        finally:
            problem.drive = None
            self._load_steps.go_on_from(begin, rest)

    def _scalars(self) -> Array:
        return self._problem.of_body_scalars(self._system.scalar_values(self._system.state))

    def accepted(self, step: AcceptedStep) -> None:
        """Follow the loop of the driven mode by a load step; collective."""
        share = _to_and_fro(step.time - self._begin.unknowns.time)
        position, scalars = self._at_rest
        moved = float(self._row.of_contacts @ (self._system.position() - position))
        moved -= share * self._force * self._of_drive
        moved += float(self._of_scalars @ (self._scalars() - scalars))
        self._loop.append((share, moved / self._mode.mass))
        pairs = zip(self._problem.contacts, step.solution.states, strict=True)
        self._lost.append(np.array([contact.work.of_friction(state) for contact, state in pairs]))
        pace = self._load_steps.pace
        if self._has_settled() and isinstance(pace, PaceOfCycles):
            pace.closed()

    def _has_settled(self) -> bool:
        """Whether a cycle ends, and loss and secant change no more, though tractions may.

        Where nearly all sticks, and little is lost, tractions of single points go on changing.
        """
        count = self._asked.increments
        done, left = divmod(len(self._loop) - count // 4, count)
        if left or done < _FEWEST:
            return False
        ends = [len(self._loop) - 1 - count * back for back in range(_FEWEST, -1, -1)]
        losses = np.diff([self._lost[end].sum() for end in ends])
        ways = [self._loop[end][1] - self._loop[end - count // 2][1] for end in ends[1:]]
        # A loss that is nothing beside what is stored is none.
        work = self._force * self._mode.mass * abs(ways[-1])
        sizes = (max(abs(losses[-1]), _NO_LOSS * work), abs(ways[-1]))
        share = self._asked.tolerance
        for values, size in zip((losses, np.array(ways)), sizes, strict=True):
            before, now = np.abs(np.diff(values)) / size
            # What creeps on by so little a cycle would take tens of cycles to be seen.
            if now > _CREEPS * share and change_to_come(now, before, share) > share:
                return False
        return True

    def _record(self, driven: float, last: Solution) -> DampingRecord:
        """Return the record of the last cycle."""
        count, mass = self._asked.increments, self._mode.mass
        shares, moved = np.array(self._loop[-count - 1 :]).T
        force = self._force * mass * shares
        area = float(0.5 * (force[1:] + force[:-1]) @ np.diff(moved))
        amplitude = 0.5 * float(moved[-1] - moved[count // 2])
        stored = 0.5 * self._force * mass * amplitude
        losses = self._lost[-1] - self._lost[-count - 1]
        names = [contact.label for contact in self._problem.contacts]
        cycles = (len(self._loop) - count // 4) // count
        return DampingRecord(
            mode=self._number,
            driven=driven,
            amplitude=amplitude,
            natural_frequency=math.sqrt(self._force / amplitude) / (2 * math.pi),
            damping_ratio=float(losses.sum()) / (4 * math.pi * stored),
            loss=float(losses.sum()),
            loop_area=area,
            contacts={name: float(loss) for name, loss in zip(names, losses, strict=True)},
            kind=self._kind(last),
            cycles=cycles,
        )

    def _kind(self, last: Solution) -> str:
        """Return the kind of the loop; empty where it did not close."""
        found = "" if last.cycle is None else last.cycle.kind
        return found or ("steady loop" if self._has_settled() else "")


def _to_and_fro(time: float) -> float:
    """Up to 1 in a quarter of a period, then between −1 and 1."""
    phase = (time / _PERIOD + 0.25) % 1.0
    return 1.0 - abs(4.0 * phase - 2.0)
