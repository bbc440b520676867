"""Couplings, springs, turned supports and contacts at random, held against sums of their own.

``benchmarks/random_scenes.py --kinds coupled`` draws as many as one likes.
"""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from tests.random.balances import balance_of
from tests.random.kinds import draw_kind, with_errors
from tests.random.outcomes import outcome_of

COMM = MPI.COMM_WORLD
SEED, NUMBER = 49, 10


def drawn(number):
    """Without error bars; the same on every rank."""
    return with_errors(draw_kind("coupled", SEED, number), "none")


@pytest.mark.parametrize("number", range(NUMBER))
def test_it_balances_or_is_refused(number):
    random = drawn(number)
    outcome = outcome_of(random)
    assert outcome.code in (0, 2, 3), f"{outcome.words}\n{random!r}"
    if random.must_be:
        assert (outcome.code == 0) == (random.must_be == "answered"), outcome.words
    assert not outcome.balance.faults, random


def of_a_row():
    """The first blocks in a row that are answered, held by springs between couplings alone."""
    for number in range(300):
        random = drawn(number)
        held = any(support.is_elastic for support in random.scene.support)
        if random.must_be == "answered" and random.scene.spring and not held:
            return random
    raise AssertionError("no such scene is drawn")


@pytest.mark.parametrize("name", ["displacement", "force", "spring_energy"])
def test_wrong_results_do_not_balance(name):
    random = of_a_row()
    solved = Run(random.scene, COMM, random.body(COMM))
    result = solved.solve()
    balance = balance_of(solved, result)
    assert not balance.faults
    if name == "spring_energy":
        more = 1.001 * result.quantities[name]
        wrong = dataclasses.replace(result, quantities={**result.quantities, name: more})
    else:
        off = 1e-4 * balance.sizes[name]
        rows = [
            dataclasses.replace(row, **{name: np.add(getattr(row, name), off).tolist()})
            for row in result.couplings
        ]
        wrong = dataclasses.replace(result, couplings=rows)
    assert balance_of(solved, wrong).faults
