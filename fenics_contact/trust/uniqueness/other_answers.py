"""Whether the answer of a run is the only one, as far as can be said."""

from __future__ import annotations

from dataclasses import dataclass, field

from fenics_contact.common.parallel import largest
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import global_quantities
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.contacts import BranchContact
from fenics_contact.results.records.steps import BranchRecord
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.checks.run_checks import run_checks
from fenics_contact.trust.uniqueness.branches import other_solutions
from fenics_contact.trust.uniqueness.critical_coefficient import uniqueness_limit


@dataclass(frozen=True)
class OtherAnswers:
    """Answers other than the one that a run reports, as far as known.

    Attributes:
        limits: Of each contact with Coulomb's friction, by its name: the coefficient up to which
            the answer is the only one by an estimate, and the coefficient that it has.
        branches: Answers, that of the run first, as in ``result.json``; empty if not asked for.
        without_answer: Number of starts from which none was found.
    """

    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    branches: list[BranchRecord] = field(default_factory=list)
    without_answer: int = 0

    def limit(self, contact: str) -> float | None:
        """``uniqueness_limit`` of a contact for ``result.json``, None where there is none."""
        return self.limits[contact][0] if contact in self.limits else None

    def words(self) -> str:
        """Sentences for the verdict, or nothing; an answer that fails a check counts for none."""
        others = [branch.start for branch in self.branches[1:] if branch.passed]
        if others:
            starts = " and ".join(f"'{start}'" for start in others)
            return (
                f" It is not the only answer: {1 + len(others)} were found, the others from the "
                f"starts {starts}; see branches in result.json."
            )
        beyond = [
            f"at '{name}' ({has:.3g} > {limit:.3g})"
            for name, (limit, has) in self.limits.items()
            if has > limit
        ]
        if not beyond:
            return ""
        looked = "solver.branches looks for them"
        if self.branches:
            looked = "none was found from other starts"
        if self.without_answer:
            looked += f", {self.without_answer} of which did not converge"
        return (
            " The friction coefficient is larger than what leaves a single answer, by an estimate, "
            f"{' and '.join(beyond)}: there may be others; {looked}."
        )


def search_other_solutions(load_steps: LoadSteps) -> OtherAnswers:
    """Estimate limits of uniqueness, and look for other answers if the scene asks; collective.

    Args:
        load_steps: At their end.
    """
    problem, system = load_steps.problem, load_steps.newton.system
    if problem.inertia.moves:  # masses decide where bodies go
        return OtherAnswers()
    limits: dict[str, tuple[float, float]] = {}
    for number, contact in enumerate(problem.contacts):
        if contact.is_coulomb and isinstance(system, CondensedSystem):
            limit = uniqueness_limit(system, number)
            coefficient = contact.friction.bound_slope(contact.pressure())
            if limit is not None:
                limits[contact.label] = limit, largest(problem.comm, coefficient)
    branches, without_answer = [], 0
    if problem.scene.solver.branches and problem.coulomb and load_steps.last is not None:
        branches.append(_branch(problem, "as solved", load_steps.last.solution))
        for start, found in other_solutions(load_steps):
            if found is None:
                without_answer += 1
            else:
                branches.append(_branch(problem, start, found))
    return OtherAnswers(limits, branches, without_answer)


def _branch(problem: Problem, start: str, solution: Solution) -> BranchRecord:
    forces = BulkForces(problem, solution)
    by_contact = [
        contact_quantities(problem, solution, number) for number in range(len(problem.contacts))
    ]
    checks = run_checks(forces)
    return BranchRecord(
        start=start,
        newton_iterations=solution.newton_iterations,
        passed=all(check.passed for check in checks.values()),
        quantities=global_quantities(forces, by_contact),
        contacts=[
            BranchContact(name=contact.label, quantities=found)
            for contact, found in zip(problem.contacts, by_contact, strict=True)
        ],
    )
