"""Messages on the accuracy that a scene asks for. No FEniCSx in here."""

from __future__ import annotations

from collections.abc import Mapping

from fenics_contact.results.records.model import LevelRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.words.rounding import UNKNOWN
from fenics_contact.scene.asked.accuracy import Accuracy
from fenics_contact.scene.quantity_names import in_words

_ADVICE = {
    "penalty": "contact.penalty_parameter is given; make it smaller, or leave it out",
    "regularisation": "contact.regularisation_parameter is given; make it smaller, or leave it out",
    "iteration": "lower solver.tolerance and solver.outer_tolerance",
    "step": "take more load steps",
    "domain": "model more of the body around the contact",
}


def source_advice(source: str) -> str:
    """Return advice against errors of a source other than the mesh."""
    return _ADVICE[source]


def plan(asked: Mapping[str, float], accuracy: Accuracy) -> str:
    """Return the plan of adaptive meshes in words, for ``fenics-contact check``."""
    limits = ", ".join(f"{percent(v)} of {in_words(name)}" for name, v in asked.items())
    return (
        f"Adaptive: finer meshes until the estimated errors are below {limits}; at most "
        f"{accuracy.max_levels} meshes, and {accuracy.max_dofs} dofs."
    )


def reached(meshes: int) -> str:
    """A sentence for the verdict."""
    return f"The accuracy asked for was reached with mesh {meshes}."


def not_reached(reason: str) -> str:
    """A sentence for the verdict; the reason may be one or several."""
    return f"The accuracy asked for was not reached: {reason.rstrip('.')}."


def level_line(number: int, level: LevelRecord, asked: Mapping[str, float]) -> str:
    """A level on one line, with the estimated errors and those allowed."""
    errors = ", ".join(
        f"{in_words(name)} {percent(level.errors[name])} of {percent(limit)}"
        for name, limit in asked.items()
    )
    return f"mesh {number}: {level.dofs} dofs, {level.seconds:.1f} s; errors: {errors}"


def energy_line(by_energy: Mapping[str, str]) -> str:
    """Return on one line which quantities have no adjoint, and why; empty where all have."""
    found = "; ".join(f"{in_words(name)}: {why}" for name, why in by_energy.items())
    return f"refined by errors in the energy norm: {found}" if found else ""


def percent(value: float | None) -> str:
    """A relative error, ``?`` where it was not estimated."""
    return UNKNOWN if value is None else f"{100 * value:.2g} %"


def level_rows(result: Outcome) -> list[list[str]]:
    """A table of the levels of a run, its head first, what was asked last; empty without any."""
    if not result.levels or result.accuracy is None:
        return []
    asked = result.accuracy.asked
    rows = [["mesh", "dofs", "cells", "seconds", *map(in_words, asked)]]
    for number, level in enumerate(result.levels):
        errors = [percent(level.errors[name]) for name in asked]
        counted = [str(number + 1), str(level.dofs), str(level.cells)]
        rows.append([*counted, f"{level.seconds:.1f}", *errors])
    rows.append(["asked for", "", "", "", *map(percent, asked.values())])
    return rows
