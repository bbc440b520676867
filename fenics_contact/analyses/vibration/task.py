"""Vibration in a run: modes, what joints damp of them, error bars, and files for ParaView."""

from __future__ import annotations

import logging
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from fenics_contact.analyses.vibration.eigenmodes import Mode
from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.analyses.vibration.vibration import Vibration, damping_scenes, vibration_of
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.errors import InputError, MachineError, NotConvergedError
from fenics_contact.common.failures import attempt
from fenics_contact.common.parallel import on_root
from fenics_contact.common.timings import Timings
from fenics_contact.mesh.refinement import is_of_order_1
from fenics_contact.problem.curved_sides import halved_body
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import ErrorRow
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.motion_errors import FACTOR, with_reduced
from fenics_contact.simulation.output.fields import body_of_cells, write_collection, write_grid
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.part_factors import KnownFactors


class VibrationTask(AnalysisTask):
    """Finds modes and drives them.

    Attributes:
        found: Modes with their shapes; None before these are found.
    """

    missing = "No modes"
    fields = "Fields of modes were not written"

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        damping_scenes(scene)  # refuses what cannot be varied
        self.found: Vibration | None = None

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with modes and damping, and their error bars."""
        kept, scene = body(), self.scene
        found = vibration_of(kept, scene)
        if scene.solver.errors == "all":
            estimate = partial(with_errors, found, kept, scene, result.contacts)
            missing = "Errors of modes were not estimated"
            found = attempt(kept.discrete.spaces.comm, missing, estimate, found, notes)
        self.found = found
        return replace(
            result,
            modes=list(found.modes),
            damping=list(found.damping),
            verdict=" ".join([result.verdict, *found.notes]),
        )

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``modes.pvd``."""
        if self.found is not None:
            write_modes(problem.spaces, self.found.shapes, folder)


TASK = VibrationTask


logger = logging.getLogger(__name__)

# Of a difference to half the cells: errors of first order at the least, as beside edges of slip.
_OF_CELLS = 2.0
# For what is not the leading order.
_SAFETY = 1.25
_FEWEST_INCREMENTS = 8

# Of each mode by its number; of each amplitude by mode, amplitude and values of other numbers.
Values = dict[Hashable, dict[str, float]]


def with_errors(
    found: Vibration, kept: KeptBody, scene: Scene, contacts: Sequence[ContactRecord]
) -> Vibration:
    """The answer with estimated errors; collective.

    Args:
        found: Of the scene.
        kept: Its body.
        scene: One that asks for modes.
        contacts: Those of its result, with ε and ε₁ as used.
    """
    sources: dict[str, Callable[[], Values | None]] = {
        "mesh": lambda: _by_mesh(found, kept, scene),
        "penalty": lambda: _by_parameter(found, kept, scene, contacts, "penalty_parameter"),
        "regularisation": lambda: _by_parameter(
            found, kept, scene, contacts, "regularisation_parameter"
        ),
        "iteration": lambda: _by_tolerance(found, scene),
        "step": lambda: _by_increments(found, kept, scene),
    }
    errors = {source: estimate() for source, estimate in sources.items()}
    return replace(
        found,
        modes=[
            replace(mode, errors=_rows(_of_mode(mode), errors, mode.number)) for mode in found.modes
        ],
        damping=[
            replace(row, errors=_rows(_of_damping(row), errors, _key(row))) for row in found.damping
        ],
    )


def _of_mode(mode: ModeRecord) -> dict[str, float]:
    return {"natural_frequency": mode.natural_frequency}


def _of_damping(row: DampingRecord) -> dict[str, float]:
    names = ("amplitude", "natural_frequency", "damping_ratio", "loss")
    lost = {f"{name}.loss": loss for name, loss in row.contacts.items()}
    return {name: getattr(row, name) for name in names} | lost


def _key(row: DampingRecord) -> Hashable:
    return row.mode, row.driven, tuple(row.by.items())


def _values(found: Vibration) -> Values:
    """Return the values whose errors are estimated, by mode or amplitude."""
    modes: Values = {mode.number: _of_mode(mode) for mode in found.modes}
    return modes | {_key(row): _of_damping(row) for row in found.damping}


def _rows(
    values: Mapping[str, float], errors: Mapping[str, Values | None], key: Hashable
) -> dict[str, ErrorRow]:
    """Return errors by quantity and source, and their sum; None where a source has no estimate."""
    rows: dict[str, ErrorRow] = {}
    for name in values:
        row = {
            source: None if of is None else of.get(key, {}).get(name)
            for source, of in errors.items()
        }
        known = [error for error in row.values() if error is not None]
        rows[name] = row | {"total": sum(known) if len(known) == len(row) else None}
    return rows


def _none(found: Vibration) -> Values:
    """Return errors of 0, those of a source that is not there."""
    return {key: dict.fromkeys(values, 0.0) for key, values in _values(found).items()}


def _apart(found: Vibration, kept: KeptBody, other: Scene, factor: float) -> Values | None:
    """How far another answer is from the one found, times a factor; collective."""
    try:
        values = _values(vibration_of(kept, other))
    except (NotConvergedError, InputError, MachineError) as error:
        logger.debug("  modes again: %s", error)
        return None
    return {
        key: {name: factor * abs(value - values[key][name]) for name, value in of.items()}
        for key, of in _values(found).items()
        if key in values
    }


def _by_parameter(
    found: Vibration, kept: KeptBody, scene: Scene, contacts: Sequence[ContactRecord], name: str
) -> Values | None:
    """With a small part of ε or of ε₁, as far as contacts have any; collective."""
    other = with_reduced(scene, contacts, name)
    if other is None:
        return None
    if other == scene:
        return _none(found)
    return _apart(found, kept, other, FACTOR)


def _by_tolerance(found: Vibration, scene: Scene) -> Values:
    """Return the change that a closed loop may still have; unknown of one that is not closed."""
    share = 0.0 if scene.damping is None else float(scene.damping.tolerance)
    modes: Values = {mode.number: dict.fromkeys(_of_mode(mode), 0.0) for mode in found.modes}
    return modes | {
        _key(row): {name: share * abs(value) for name, value in _of_damping(row).items()}
        for row in found.damping
        if row.kind
    }


def _by_increments(found: Vibration, kept: KeptBody, scene: Scene) -> Values | None:
    """With half the increments, or twice as many where these are few; collective."""
    damping = scene.damping
    if damping is None:
        return _none(found)
    count = damping.increments
    other = count // 8 * 4
    if other < _FEWEST_INCREMENTS:
        other = 2 * count
    changed = replace(scene, damping=replace(damping, increments=other))
    return _apart(found, kept, changed, _SAFETY / abs(1 - count / other))


def _by_mesh(found: Vibration, kept: KeptBody, scene: Scene) -> Values | None:
    """With cells of half the size; None where these have curved sides; collective."""
    spaces = kept.discrete.spaces
    if not is_of_order_1(spaces.body.mesh):
        return None
    other = KeptBody(scene, halved_body(spaces), Timings(), KnownFactors())
    try:
        return _apart(found, other, scene, _OF_CELLS)
    finally:
        other.close()


def write_modes(spaces: Spaces, modes: Sequence[Mode], folder: Path) -> None:
    """Write ``modes.pvd``: a grid a mode with its displacement, in place of a time its number.

    Args:
        spaces: Of the body; collective.
        modes: In their order.
        folder: Where to.
    """
    grids: dict[str, float] = {}
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    for number, mode in enumerate(modes, start=1):
        more = np.zeros((len(mode.shape), 3 - spaces.components))
        fields = {"displacement": np.hstack([mode.shape, more])}
        grids[write_grid(folder, "modes", number, space, fields, bodies)] = float(number)
    on_root(spaces.comm, lambda: write_collection(folder / "modes.pvd", grids))
