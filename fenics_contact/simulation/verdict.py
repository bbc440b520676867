"""What a run says of its answer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from fenics_contact.common.failures import attempt
from fenics_contact.common.parallel import largest
from fenics_contact.problem.existence.slip_shares import HELD, slip_shares
from fenics_contact.problem.existence.undetermined import undetermined
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import CONTACT_AREA, SLIP_SINCE_PAIRING
from fenics_contact.results.check_messages import failure
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check
from fenics_contact.scene.settings import Steps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.convergence.coarse_contacts import words_on
from fenics_contact.trust.linear_range import worst_step

# Slip over the size of a contact between two pairings, from which pressures are visibly off:
# without friction a shift of .01 changes them by 1 %.
_FAR = 0.01
# What pressure closes, over the height of facets' arcs, below which these decide about it.
_SAGITTAS = 10.0
# Strains, rotations and indentations over size from which linear theory is visibly off, and what
# each is called.
_LARGE = 0.1
_OF_LINEAR_RANGE = {
    "strain": "strains of {share}",
    "rotation": "rotations of {share} of a radian",
    "obstacle_rotation": "an obstacle that turns by {share} of a radian",
    "indentation": "an indentation of {share} of the radius or thickness",
    "wear": "wear as deep as {share} of half its width",
}
# Of answers whose fields are not known.
_CONVERGED = "Converged; "
_UNCHECKED = f"{_CONVERGED}nothing was checked."
_WITHOUT_FIELDS = " The range of linear theory was not checked: that takes the fields."
_MISSING = "Some of what limits the answer was not looked at"
# Share of the work left open by load steps, from which it is said.
_OPEN = 0.1


def remarks(
    problem: Problem,
    solution: Solution,
    steps: list[StepRecord],
    open_share: float,
    notes: list[str],
) -> str:
    """All that is to be said of an answer beside its checks; collective.

    Args:
        problem: The model.
        solution: Of the last load step.
        steps: All load steps.
        open_share: Share of the work that load steps leave open.
        notes: To which it is added what could not be found out.
    """
    asked: tuple[Callable[[], str], ...] = (
        lambda: slips_as_a_whole(problem, solution),
        lambda: arbitrary_motion(problem, solution),
        lambda: untouched(problem, solution, steps),
        lambda: without_friction(problem),
        lambda: facets_too_straight(problem, solution),
        lambda: slid_far(steps),
        lambda: was_unstable(steps[:-1]),
        lambda: beyond_linear_theory(steps),
        lambda: coarse_path(open_share),
        lambda: loop_expands(solution),
        lambda: "".join(f" {note}." for note in problem.body.notes),
    )
    return "".join(attempt(problem.comm, _MISSING, remark, "", notes) for remark in asked)


def of_quick_answer(
    problem: Problem,
    solution: Solution,
    steps: list[StepRecord],
    checks: dict[str, Check] | None,
    open_share: float,
) -> str:
    """The same of an answer whose fields are not known; collective.

    Args:
        problem: The model.
        solution: Of the last load step.
        steps: All load steps.
        checks: Those that need no field; None where none was made.
        open_share: Share of the work that load steps leave open.
    """
    notes: list[str] = []
    said = _UNCHECKED if checks is None else of_checks(checks)
    found = with_unresolved(said, problem, solution, notes)
    found += remarks(problem, solution, steps, open_share, notes)
    found += "".join(f" {note}" for note in notes)
    return found if checks is None else found + _WITHOUT_FIELDS


def with_unresolved(said: str, problem: Problem, solution: Solution, notes: list[str]) -> str:
    """The first sentence, with contacts in it that are not resolved; collective.

    Args:
        said: Whether to trust the answer, by its checks.
        problem: The model.
        solution: Of the last load step.
        notes: To which it is added what could not be found out.
    """
    look = partial(words_on, problem.contacts, solution.states)
    unresolved = attempt(problem.comm, _MISSING, look, "", notes)
    if not unresolved:
        return said
    if not said.startswith(_CONVERGED):  # worse is said there
        return f"{said} {_capital(unresolved)}"
    return f"Converged, but {unresolved} {_capital(said.removeprefix(_CONVERGED))}"


def _capital(words: str) -> str:
    return words[0].upper() + words[1:]


def slips_as_a_whole(problem: Problem, solution: Solution) -> str:
    """A sentence on parts that friction does not hold, or nothing; collective.

    Args:
        problem: The model.
        solution: Of the last load step.
    """
    if problem.inertia.moves:
        return ""
    shares = slip_shares(problem, solution.states)
    found = None if shares is None else shares.largest()
    if found is None or found.share <= HELD:
        return ""
    return f" There is no equilibrium: {found.words}."


def arbitrary_motion(problem: Problem, solution: Solution) -> str:
    """Sentences on parts whose place is one of many in equilibrium, or nothing; collective.

    Args:
        problem: The model.
        solution: Of the last load step.
    """
    found = undetermined(problem, solution.states, solution.imbalance_limit)
    return "" if found is None else found.words


def asked_too_much(
    problem: Problem, solution: Solution | None, tried: float, reached: float | None
) -> str:
    """What the loads of a step without an answer ask for that friction cannot hold; collective.

    Args:
        problem: The model, as it was at the end of the last step that was done.
        solution: Of that step, by whose pressures friction is judged.
        tried: Pseudo-time of the step without an answer.
        reached: That of the last one that was done.

    Returns:
        Nothing where friction can hold them, or where no step was done.
    """
    if solution is None or reached is None or problem.inertia.moves:
        return ""
    problem.set_time(tried)
    shares = slip_shares(problem, solution.states)
    found = None if shares is None else shares.asked_by_loads()
    problem.set_time(reached)
    if found is None or found.share <= HELD:
        return ""
    return (
        f"{found.words}, by the pressures of the last load step that was done; lower the loads, "
        "or add friction or a support"
    )


def untouched(problem: Problem, solution: Solution, steps: Sequence[StepRecord] = ()) -> str:
    """A sentence on contacts at which nothing touches, or nothing; collective.

    Args:
        problem: The model.
        solution: Of the last load step.
        steps: All of a motion, in which bodies that touched may have left each other.
    """
    left = set()
    if problem.inertia.moves:
        rows = [row for step in steps for row in step.contacts]
        left = {row.name for row in rows if row.quantities.get(CONTACT_AREA, 0.0) > 0}
    touched = [
        largest(problem.comm, np.abs(state.contact_pressure)) > 0 for state in solution.states
    ]
    words = ""
    for contact, touches in zip(problem.contacts, touched, strict=True):
        if not (touches or contact.label in left or contact.normal.pressure_is_known):
            what = "The body does not touch the obstacle"
            if contact.sides.opposite is not None:
                what = "The two surfaces do not touch each other"
            words += f" {what} at '{contact.label}'."
    return words


def without_friction(problem: Problem) -> str:
    """A sentence on contacts whose friction law exerts nothing, or nothing."""
    found = [
        f"'{one.label}' ({one.friction.left_out})"
        for one in problem.contacts
        if one.friction.left_out
    ]
    if not found:
        return ""
    return f" There is no friction at {' and '.join(found)}: the bound of its law is 0 everywhere."


def facets_too_straight(problem: Problem, solution: Solution) -> str:
    """A sentence on curved surfaces of two bodies whose facets are coarse, or nothing; collective.

    Their chords make gaps, beside which what the pressure closes, p L/E*, must be large.
    """
    found = []
    for contact, state in zip(problem.contacts, solution.states, strict=True):
        peak = largest(problem.comm, np.abs(state.contact_pressure))
        closed = peak / contact.moduli.plane_strain * contact.trace.extent()
        if 0 < closed < _SAGITTAS * contact.kinematics.sagitta:
            found.append(f"'{contact.label}'")
    if not found:
        return ""
    return (
        f" The facets at {' and '.join(found)} are too straight for what is pressed together "
        "there, and pressures not to be trusted: use cells of order 2 (mesh.order), or finer ones."
    )


def unconverged(why: str, steps: Steps, tried: float, reached: float | None) -> str:
    """Sentences on a load step without an answer: why, and what may do better.

    Args:
        why: What ended it, in words.
        steps: Those of the scene.
        tried: Pseudo-time of the step.
        reached: That of the last step that was done, None where there is none.
    """
    said = why if why.endswith(("?", ".")) else f"{why}."
    if reached is None:
        return f"No answer: {said}"
    advice = "Or try a smaller steps.smallest."
    if not steps.automatic:
        advice = "Or try more load steps, or steps.automatic = true."
    elif tried - reached > 1.5 * steps.smallest_size:  # cut no further
        advice = "A larger load step ended in the same way."
    return f"No answer at time {tried:g}: {said} {advice}"


def of_checks(checks: dict[str, Check]) -> str:
    """Whether to trust it; if not, what is wrong, how much, and where."""
    failed = [failure(name, check) for name, check in checks.items() if not check.passed]
    if failed:
        return f"Converged, but do not trust it: failed {'; '.join(failed)}."
    every = "the one check" if len(checks) == 1 else f"all {len(checks)} checks"
    return f"{_CONVERGED}{every} of the physics passed."


def slid_far(steps: list[StepRecord]) -> str:
    """A sentence on bodies that slid far within a load step, or nothing."""
    found: dict[str, float] = {}
    for step in steps:
        for contact in step.contacts:
            slid = contact.quantities.get(SLIP_SINCE_PAIRING, 0.0)
            found[contact.name] = max(slid, found.get(contact.name, 0.0))
    far = [f"'{name}' by {slid:.2g}" for name, slid in found.items() if slid > _FAR]
    if not far:
        return ""
    return (
        f" Bodies slid far within a load step, over the contact's size at {' and '.join(far)}: "
        "pressures may be off by as much; take more load steps."
    )


def was_unstable(steps: list[StepRecord]) -> str:
    """A sentence on load steps on the way whose equilibrium is not stable, or nothing."""
    found = [step.load_factor for step in steps if step.unstable_motions]
    if not found:
        return ""
    first, last = found[0], found[-1]
    when = f"At time {first:g}" if first == last else f"From time {first:g} to {last:g}"
    return (
        f" {when} the equilibrium was not stable: the body would have left it by itself, and what "
        "came after may be the end of another way; disturb it a little, and follow it again."
    )


def beyond_linear_theory(steps: list[StepRecord]) -> str:
    """A sentence on what is not small, as linear theory takes it to be, or nothing."""
    found = []
    for what, words in _OF_LINEAR_RANGE.items():
        row = worst_step(steps, what)
        if row is not None and row["value"] > _LARGE:
            where = f"near '{row['on']}'" if "on" in row else f"in '{row['part']}'"
            at = f" at time {row['time']:g}" if row["time"] != steps[-1].load_factor else ""
            share = f"{100 * row['value']:.0f} %"
            found.append(f"{words.format(share=share)} {where}{at}")
    if not found:
        return ""
    return (
        f" Outside the range of linear theory, in which they stay below 10 %: {', '.join(found)}; "
        "results may be off by about as much."
    )


def loop_expands(solution: Solution) -> str:
    """A sentence on a loop on the pressure that does not settle by itself, or nothing."""
    if solution.contraction is None or solution.contraction < 1:
        return ""
    factor = f"{solution.contraction:.2g}"
    return (
        f" A pass of the loop on the pressure multiplies differences by {factor}, so that it does "
        "not settle by itself; the answer was found otherwise."
    )


def coarse_path(share: float) -> str:
    """A sentence on work that the load steps leave open, or nothing.

    Args:
        share: Of the work done.
    """
    if share < _OPEN:
        return ""
    return (
        f" The load steps leave {100 * share:.2g} % of the work open, at points that began to "
        "touch or to slip within a step: take more for sharper energies."
    )
