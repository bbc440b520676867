"""The modes that a scene asks for, and what joints damp of them, on a body that is kept."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from fenics_contact.analyses.vibration.driven_modes import DrivenMode
from fenics_contact.analyses.vibration.eigenmodes import Mode
from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.analyses.vibration.stuck_modes import mode_records, stuck_modes
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.changes import with_changes
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.load_steps import LoadSteps

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

    Args:
        scene: The scene.

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
        return Vibration(mode_records(shapes), shapes, found, notes)


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
