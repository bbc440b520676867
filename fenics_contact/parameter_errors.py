"""Errors by what the method adds to the problem: penalty, regularisation, and the solver's rest.

Quantities depend on ε₁ and on ε smoothly, at first order where these are small (paper, Section 4;
Theorem 2.4): Q(ε) = Q + c ε + …. So |Q(2ε) − Q(ε)| is the error of Q(ε), at leading order. The
answer with twice the parameter is one or two Newton steps away.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from fenics_contact.errors import NotConvergedError
from fenics_contact.load_steps import History
from fenics_contact.problem import Problem
from fenics_contact.solution import Solution

logger = logging.getLogger(__name__)

# Of the solver's tolerance, for what its rest makes.
_SHARPER = 1e-3

Quantities = Mapping[str, Any]


def parameter_errors(
    history: History, measure: Callable[[Solution], Quantities]
) -> dict[str, dict[str, float]]:
    """Estimated errors of the last load step's quantities by each source; collective.

    Left out are sources that the scene does not have or, over several load steps with the
    incremental law, whose errors come from earlier ones, too.

    Args:
        history: At its end; it is there again afterwards.
        measure: Global quantities of a solution, called in its state; collective.

    Returns:
        By source (``penalty``, ``regularisation``, ``iteration``), then by quantity: absolute, of
        vectors the length of the difference.
    """
    assert history.last is not None
    answer = measure(history.last.solution)
    found = {}
    for source, changed in (
        ("penalty", _softened),
        ("regularisation", _more_regularised),
        ("iteration", _as_it_is),
    ):
        if source != "iteration" and not _applies(history.problem, source):
            continue
        history.go_back()  # sets ε, too, so before that is changed
        with changed(history.problem):
            other = _solved_again(history, measure, _SHARPER if source == "iteration" else 1.0)
        if other is not None:
            found[source] = _differences(answer, other)
    history.go_back()
    return found


def _applies(problem: Problem, source: str) -> bool:
    remembers = any(contact.law == "incremental" for contact in problem.contacts)
    if problem.scene.steps.several and remembers:
        return False
    if source == "penalty":
        return any(contact.has_penalty for contact in problem.contacts)
    return bool(problem.frictional)


@contextmanager
def _softened(problem: Problem) -> Iterator[None]:
    """Twice the ε₁ of every penalty; foundations are as they are."""
    terms = [contact.normal for contact in problem.contacts if contact.has_penalty]
    for term in terms:
        assert term is not None
        term.soften(2.0)
    try:
        yield
    finally:
        for term in terms:
            assert term is not None
            term.soften(1.0)


@contextmanager
def _more_regularised(problem: Problem) -> Iterator[None]:
    """Twice the ε of every contact."""
    terms = [contact.friction for contact in problem.frictional]
    for term in terms:
        assert term is not None
        term.regularisation_parameter *= 2
    try:
        yield
    finally:
        for term in terms:
            assert term is not None
            term.regularisation_parameter /= 2


@contextmanager
def _as_it_is(problem: Problem) -> Iterator[None]:
    yield


def _solved_again(
    history: History, measure: Callable[[Solution], Quantities], sharper: float
) -> Quantities | None:
    """Quantities of the last step solved again from its answer; None where that fails."""
    newton, problem = history.newton, history.problem
    newton.forget()
    for contact in problem.coulomb:
        assert contact.friction is not None
        contact.friction.mode = "coupled"
    newton.continue_start()
    search = None if not problem.coulomb else False
    try:
        newton.run(search, tolerance=sharper * problem.scene.solver.tolerance)
    except NotConvergedError as error:
        logger.debug("  errors of parameters: %s", error)
        return None
    return measure(newton.solution())


def _differences(answer: Quantities, other: Quantities) -> dict[str, float]:
    return {
        name: float(np.linalg.norm(np.subtract(other[name], value)))
        for name, value in answer.items()
        if name in other
    }
