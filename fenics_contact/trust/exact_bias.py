"""Bias by penalty and smoothing, measured by an exact solve of the last load step.

The answer without a penalty and without smoothing of friction is solved on the condensed body,
under the same loads and from the same end of the load step before. The difference of the two is
what ε₁ and ε do to each quantity in that load step, with its sign.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    FRICTION_FORCE,
    MAX_CONTACT_PRESSURE,
    PRESSURE_INTEGRAL,
)
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.results.result import Check
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.at_points.point_laws import why_not
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import contact_change
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.comparison import nearer_to_failing
from fenics_contact.trust.error_estimates.measured import Measured
from fenics_contact.trust.error_estimates.solving_again import restore

# Rows at the points, and unknowns, up to which it takes little beside a run.
_FEW = 1500
# Of force and peak pressure, what automatic parameters may change.
_LARGEST = 1e-3
# Area that opens, closes, sticks or slips in the exact answer alone, over that in contact, and
# change of a force over the force, from which it is another answer.
_OTHER_AREA, _OTHER_FORCE = 0.05, 0.05

_NO_ANSWER = "What penalty and smoothing change was not measured: the exact solve found no answer."
_ANOTHER = (
    "What penalty and smoothing change was not measured: without them other points touch, or "
    "stick, so that it is another answer."
)


@dataclass(frozen=True)
class Bias:
    """Exact quantities less those of a run.

    Attributes:
        quantities: Of the whole model, by name; of vectors a list.
        contacts: Of each contact, in scene order.
        check: Whether automatic parameters change little; None where none is automatic.
        notes: Sentences on what was not measured.
    """

    quantities: Mapping[str, QuantityValue | None] = field(default_factory=dict)
    contacts: list[Mapping[str, QuantityValue | None]] = field(default_factory=list)
    check: Check | None = None
    notes: list[str] = field(default_factory=list)

    def of_contact(self, number: int) -> Mapping[str, QuantityValue | None]:
        """Bias of one contact's quantities for ``result.json``; empty where none was measured."""
        return self.contacts[number] if self.contacts else {}


def exact_bias(load_steps: LoadSteps) -> Bias:
    """Solve the last load step exactly, and compare; collective.

    Args:
        load_steps: At their end; all is there again afterwards.

    Returns:
        Nothing where the scene does not ask for it, or an exact solve does not cover it.
    """
    problem, system, last = load_steps.problem, load_steps.newton.system, load_steps.last
    wanted = problem.scene.solver.exact_check
    if not isinstance(system, CondensedSystem) or last is None or not _is_wanted(problem):
        return Bias()
    if why_not(problem) is not None:
        return Bias()
    exact = ExactSolver(problem, system)
    if wanted == "auto" and max(exact.rows, system.width) > _FEW:
        return Bias()
    measure = Measured(load_steps)
    before = measure(last.solution)
    try:
        load_steps.go_back()
        answer = exact.solve()
        if not answer.is_found:
            return _unknown(before, len(problem.contacts), _NO_ANSWER)
        solution = load_steps.newton.solution(0, answer.way)
        found, changed = measure(solution), contact_change(problem, last, solution)
    finally:
        restore(load_steps)
    if changed > _OTHER_AREA and _largest_share(problem, before, found) > _OTHER_FORCE:
        return _unknown(before, len(problem.contacts), _ANOTHER)
    rows = {key: _difference(found.get(key), value) for key, value in before.items()}
    return Bias(*_by_owner(rows, len(problem.contacts)), _check(problem, before, found))


def _is_wanted(problem: Problem) -> bool:
    """Whether there is a penalty or a smoothing, whose bias the scene asks for."""
    wanted, scene = problem.scene.solver.exact_check, problem.scene
    if wanted is False or scene.is_exact or (wanted == "auto" and scene.solver.errors == "none"):
        return False
    return any(
        one.has_penalty or one.friction.regularisation.is_numerical for one in problem.contacts
    )


Rows = dict[Hashable, QuantityValue | None]


def _unknown(answer: Mapping[Hashable, QuantityValue], contacts: int, why: str) -> Bias:
    """No number, and why."""
    return Bias(*_by_owner(dict.fromkeys(answer), contacts), notes=[why])


def _by_owner(
    rows: Rows, contacts: int
) -> tuple[dict[str, QuantityValue | None], list[Mapping[str, QuantityValue | None]]]:
    """Rows of the whole model, and of each contact."""
    of_contacts: list[dict[str, QuantityValue | None]] = [{} for _ in range(contacts)]
    for key, value in rows.items():
        if isinstance(key, tuple):
            of_contacts[key[0]][key[1]] = value
    return {key: value for key, value in rows.items() if isinstance(key, str)}, [*of_contacts]


def _difference(exact: QuantityValue | None, value: QuantityValue) -> QuantityValue | None:
    """The exact value less the other; of vectors a list."""
    if exact is None:
        return None
    found = np.subtract(exact, value)
    return found.tolist() if found.ndim else float(found)


def _check(
    problem: Problem,
    before: Mapping[Hashable, QuantityValue],
    found: Mapping[Hashable, QuantityValue],
) -> Check | None:
    """Changes of force and peak at contacts whose parameters are automatic, over force and peak."""
    worst: Check | None = None
    for number, contact in enumerate(problem.contacts):
        given = contact.contact
        parameters = given.penalty_parameter, given.regularisation_parameter
        if parameters != ("auto", "auto") or not contact.is_one_sided:
            continue
        share = _share(number, before, found)
        if share is not None:
            worst = nearer_to_failing(worst, Check(share, _LARGEST, contact.label))
    return worst


_OF_A_CONTACT = (
    (PRESSURE_INTEGRAL, PRESSURE_INTEGRAL),
    (FRICTION_FORCE, PRESSURE_INTEGRAL),
    (MAX_CONTACT_PRESSURE, MAX_CONTACT_PRESSURE),
)


def _share(
    number: int,
    before: Mapping[Hashable, QuantityValue],
    found: Mapping[Hashable, QuantityValue],
) -> float | None:
    """Largest change of a contact's forces and peak, over these; None where nothing presses."""
    shares = []
    for name, over in _OF_A_CONTACT:
        key, size = (number, name), float(np.linalg.norm(before.get((number, over), 0.0)))
        if size > 0 and key in before and key in found:
            shares.append(float(np.linalg.norm(np.subtract(found[key], before[key]))) / size)
    return max(shares, default=None)


def _largest_share(
    problem: Problem,
    before: Mapping[Hashable, QuantityValue],
    found: Mapping[Hashable, QuantityValue],
) -> float:
    """Largest change of forces and peak over all contacts; 0 where none presses."""
    shares = [_share(number, before, found) for number in range(len(problem.contacts))]
    return max((share for share in shares if share is not None), default=0.0)
