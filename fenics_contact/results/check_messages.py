"""Messages of checks and of the accuracy that a scene asks for. No FEniCSx in here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fenics_contact.results.records.run import LevelRecord, Outcome
from fenics_contact.results.result import Check
from fenics_contact.results.rounding import UNKNOWN
from fenics_contact.scene.quantity_names import in_words
from fenics_contact.scene.settings import Accuracy


@dataclass(frozen=True)
class CheckWords:
    """Words of a check.

    Attributes:
        compares: What is compared, and over what its value is taken; a sentence.
        failure: What is wrong when it fails, with ``{share}`` for its value.
        kinds: The same for checks of several comparisons, by ``Check.kind``.
        title: What people read in place of its key, where that says more than what is compared.
    """

    compares: str
    failure: str = ""
    kinds: Mapping[str, str] = field(default_factory=dict)
    title: str = ""


WORDS: Mapping[str, CheckWords] = {
    "equilibrium": CheckWords(
        "Forces and moments of loads, supports and contacts on each connected part add up to "
        "zero; over the sum of its nodal forces.",
        "{share} of the forces are out of balance",
    ),
    "resultant": CheckWords(
        "Resultants that the body takes from contacts against what is put on: the force that "
        "drives an obstacle, a given pressure times the area, the loads on a part that only "
        "contacts hold; over the forces added up.",
        kinds={
            "obstacle": "the obstacle's force on the body is {share} off the one that drives it",
            "pressure": "the force of the given pressure is {share} off pressure times area",
            "part": "what the body takes from contacts is {share} off the loads",
        },
    ),
    "stabilisation": CheckWords(
        "The largest force where motions that nothing resists are held, which is to vanish; over "
        "all forces applied.",
        "where a motion that nothing resists is held, {share} of the forces act; the loads push "
        "it, so give it a support, or friction",
    ),
    "point_support": CheckWords(
        "The largest force where a support holds a point, or an edge in space, which is to hold "
        "rigid motions alone; over all forces applied and all reactions.",
        "a point or an edge that a support holds takes {share} of the forces, under which no mesh "
        "ends what it gives way; hold a boundary there",
    ),
    "preload": CheckWords(
        "The force along each preloaded part that is not locked against the one that it is "
        "tightened to; over the largest force.",
        "the force of a preload is {share} off the one that it is tightened to",
    ),
    "coupling": CheckWords(
        "Force and moment that the body needs of each coupling against those given, moments over "
        "the face's largest distance from its point; over the largest force. And its motion "
        "against the one that is given, over the largest motion.",
        kinds={
            "force": "the force or moment of a coupling is {share} off the one that is given",
            "motion": "the motion of a coupling is {share} off the one that is given",
        },
    ),
    "cyclic_symmetry": CheckWords(
        "Displacements of one cut face of a sector against those of the other, turned, over the "
        "largest of them; and forces that both faces together leave out of balance, over those "
        "that the body needs there.",
        kinds={
            "motion": "the cut faces of the sector move apart by {share} of what they move",
            "forces": "what one cut face of the sector gets and the other gives differ by {share}",
        },
    ),
    "action_and_reaction": CheckWords(
        "Forces on both bodies of a contact, and their moments, add up to zero; over the forces "
        "on one.",
        "what one body gets and the other gives differ by {share}",
    ),
    "boundary_stress": CheckWords(
        "Stress in the body, integrated over a contact, against the contact's pressure and "
        "friction; over these and the body's mean stress.",
        "the stress in the body carries {share} more or less than the contact",
    ),
    "heat_balance": CheckWords(
        "Heat that a body takes in at its boundaries and across its contacts, as their pressures "
        "say, and does not give; over all heat.",
        "a body takes in {share} more heat than it gives, or less",
    ),
    "unseen_contact": CheckWords(
        "How deep what stands opposite sinks into the surface between two contact points; over "
        "itself and what the peak pressure closes from one point to the next or, where that is "
        "too much, what the whole body gives way under the contact's force.",
        "what stands opposite sinks in between the points of the surface, by {share} of what "
        "closes there; the mesh is too coarse to see it",
    ),
    "slip_limit": CheckWords(
        "Friction found against the most that it can carry, along the rigid motion of parts, not "
        "held by supports nor across contacts, in which the two are nearest: the work of one over "
        "that of the other.",
        "friction carries {share} of all that it can against a rigid motion that no support holds",
    ),
    "friction_cone": CheckWords(
        "Friction that the body needs at a node against the most that friction can carry there; "
        "over the largest such bound.",
        "traction exceeds its bound by {share} of the largest bound",
    ),
    "friction_law": CheckWords(
        "Friction that the body needs at a node against the friction law's at the slip there; "
        "over the largest bound.",
        "traction is off the friction law by {share} of the largest bound",
    ),
    "outer_loop": CheckWords(
        "The bound that friction was solved with against the coefficient times the pressure that "
        "came out; over the largest such bound.",
        "friction was solved with a bound that is off the pressure's by {share} of the largest; "
        "the loop on the pressure ended too early",
    ),
    "regularisation": CheckWords(
        "Forces and peak pressure of a contact, with automatic parameters, against those without "
        "penalty and smoothing of friction, solved exactly on the same mesh; over the force and "
        "the peak.",
        "penalty and smoothing of friction change force or peak pressure by {share}",
    ),
    "dissipation": CheckWords(
        "Friction acts against the slip at every point; over the largest bound and slip.",
        "friction pushes along the slip, by {share} of the largest bound and slip",
    ),
    "stick_creep": CheckWords(
        "Creep of points that stick, |u_T| ≤ ε: the share of ε against the share of the bound "
        "that the body needs; and creep against what the body gives way under the same friction.",
        kinds={
            "law": "creep over ε is off the share of the bound by {share} of the largest bound",
            "share": "points that stick creep by {share} of what the body gives way; the "
            "regularisation_parameter is too large for this scene",
        },
    ),
    "contact_law": CheckWords(
        "Pressure that the body needs at a node against the penalty's or foundation's; over the "
        "peak pressure.",
        "pressure is off the contact law by {share} of the peak",
    ),
    "complementarity": CheckWords(
        "Pressure that the body needs where the gap is open; over the peak pressure.",
        "{share} of the peak pressure acts across an open gap",
    ),
    "tension": CheckWords(
        "Tension that the body needs at a node of a contact that cannot pull; over the peak "
        "pressure.",
        "the contact pulls with {share} of the peak pressure",
    ),
    "penetration": CheckWords(
        "Energy in the penalties against the strain energy: the share by which contact forces "
        "are off.",
        "penalties hold {share} of the strain energy; the penalty_parameter is too large for "
        "this scene",
    ),
    "penetration_depth": CheckWords(
        "The deepest penetration against what the pressure closes, p L/E*, which is about the "
        "indentation, and against the shortest edge of the cells at the contact; of glue, how far "
        "it is pulled apart against what the bodies give way under the same tractions.",
        kinds={
            "closing": "penetration is {share} of what the pressure closes; the "
            "penalty_parameter is too large for this scene",
            "cell": "penetration is {share} of the shortest edge of a cell",
            "glue": "glue gives way by {share} of what the bodies do; the penalty_parameter is too "
            "large for this scene",
        },
    ),
    "pressure_recovery": CheckWords(
        "The penalty's pressure against that recovered from nodal forces of the body: median "
        "difference over the mean pressure.",
        "the two pressures differ by {share} of their mean; pressures are not resolved",
    ),
    "volume_ratio": CheckWords(
        "In finite strains: the largest share of its volume that any piece of a body has lost, "
        "1 − det F. Cells that collapse, as in a corner that folds, lose nearly all, on a wrong "
        "branch of equilibria.",
        "a piece of the body has lost {share} of its volume: cells have collapsed; take smaller "
        "load steps, or triangles in a corner that folds",
    ),
    "stable_equilibrium": CheckWords(
        "In finite strains: the number of motions in which the body would leave the equilibrium by "
        "itself: negative eigenvalues of its tangent, of motions that contact and friction leave. "
        "Such an answer is one on a branch that nobody sees: the body has buckled before.",
        "the equilibrium is not stable: the body would leave it by itself, as a strip that "
        "buckles; take smaller load steps, and a small imperfection to follow",
    ),
    "linear_range": CheckWords(
        "No part of the body is turned inside out, and none passes through what holds it, in any "
        "load step; over the volume of a part, of a material, or of what lies near a surface that "
        "is touched, loaded or held, of which a thousandth is left out.",
        kinds={
            "turned": "{share} of the volume is turned inside out; the loads or displacements are "
            "too large for linear theory",
            "beyond": "{share} of the volume passes through a plane of symmetry or the axis; the "
            "loads or displacements are too large for linear theory",
            "overlap": "the body passes into an obstacle that it slides along, by {share} of the "
            "radius or thickness; linear theory measures the gap where points first were",
        },
        # It passes far outside the range of linear theory, of which the verdict tells.
        title="inside out or overlapping",
    ),
    "free_modes": CheckWords(
        "Forces of contacts and kinetic energy of a motion in free modes against those in half as "
        "many, or the kinetic energy that no mode has; over the largest, in the worst step.",
        "the motion may be off by {share} for lack of free modes; ask for more, or leave "
        "motion.modes.number to the program",
    ),
    "momentum_balance": CheckWords(
        "The change of momentum of each connected part in a step of motion against the impulses of "
        "loads, supports and contacts; over all of these, in the worst step.",
        "momentum changes by {share} otherwise than by what acts",
    ),
    "energy_balance": CheckWords(
        "Work done along the load steps less strain energy, penalties' energy and dissipation; "
        "over the work done.",
        "{share} of the work done is not accounted for",
    ),
    "cycle_loss": CheckWords(
        "Work of all that is moved in the last cycle, the areas of its loops, against what "
        "friction dissipates in it, where the loop is closed; over the work done in the cycle.",
        "the areas of the loops and the loss of the cycle differ by {share} of the work done in it",
    ),
}


def title(name: str) -> str:
    """Return the title of a check for readers; by default its key in words.

    Args:
        name: Its key in ``result.json``.

    >>> title("friction_cone"), title("linear_range")
    ('friction cone', 'inside out or overlapping')
    """
    return (name in WORDS and WORDS[name].title) or name.replace("_", " ")


def compares(name: str) -> str:
    """Return what a check compares; empty for an unknown check, as of another version's file."""
    return WORDS[name].compares if name in WORDS else ""


def failure(name: str, check: Check) -> str:
    """Return what is wrong, by how much, and where: ``friction cone: traction exceeds …``."""
    words = WORDS[name]
    said = words.kinds[check.kind] if check.kind else words.failure
    said = said.format(share=_share(check.value))
    if check.value != check.value:
        said = "its value is not a number"
    if check.unmade:
        said = f"it could not be made: {check.unmade}"
    return f"{title(name)}: {said}{_where(check)}"


def _share(value: float) -> str:
    return f"{value:.3g} times" if value > 10 else f"{100 * value:.3g} %"


def _where(check: Check) -> str:
    at = f" at '{check.contact}'" if check.contact else ""
    at += f" in '{check.part}'" if check.part else ""
    if check.place:
        at += f" near ({', '.join(f'{x + 0.0:.4g}' for x in check.place)})"
    return at


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
