"""Bodies with temperatures at random, held against sums of their own, and taken up again.

``benchmarks/random_scenes.py --kinds heated`` draws as many as one likes.
"""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.state_file import StateFile
from tests.random.balances import balance_of
from tests.random.heat_balances import heat_faults
from tests.random.kinds import draw_kind, with_errors
from tests.random.outcomes import outcome_of

COMM = MPI.COMM_WORLD
SEED, NUMBER = 50, 12


def drawn(number):
    """Without error bars; the same on every rank."""
    return with_errors(draw_kind("heated", SEED, number), "none")


@pytest.mark.parametrize("number", range(NUMBER))
def test_it_balances_or_is_refused(number):
    random = drawn(number)
    outcome = outcome_of(random)
    assert outcome.code in (0, 2, 3), f"{outcome.words}\n{random!r}"
    if random.must_be:
        assert (outcome.code == 0) == (random.must_be == "answered"), outcome.words
    assert not outcome.balance.faults, random


# The last but one has a pressure that falls steeply as more heat crosses, the last one pressures
# that are round-off.
@pytest.mark.parametrize(
    ("seed", "number"), [(SEED, 0), (SEED, 1), (SEED, 2), (SEED, 3), (SEED, 15), (3051, 24)]
)
def test_heat_that_is_conducted_balances(seed, number):
    random = with_errors(draw_kind("conducting", seed, number), "none")
    outcome = outcome_of(random)
    assert outcome.code == 0, f"{outcome.words}\n{random!r}"
    assert not outcome.balance.faults, random


def test_wrong_heat_is_noticed():
    """Of a given temperature, between the boundaries, and across the contact."""
    random = with_errors(draw_kind("conducting", SEED, 6), "none")
    solved, result = _solved(random)
    assert not list(heat_faults(solved, result))
    rise = solved.problem.conduction.rise
    solved.problem.conduction.rise = 1.001 * rise
    assert any("off the given one" in fault for fault in heat_faults(solved, result))
    solved.problem.conduction.rise = rise + np.linspace(0, 1e-3, len(rise)) * np.ptp(rise)
    assert any("comes from nowhere" in fault for fault in heat_faults(solved, result))
    solved.problem.conduction.rise = rise
    for contact in result.contacts:
        contact.quantities["heat_flow"] *= 1.001
    assert any("results say" in fault for fault in heat_faults(solved, result))


def test_a_stiff_fit_on_springs_balances():
    """Penalties begin with forces of 1e6 times what acts: one step leaves 4e-4 of that."""
    solved, result = _solved(drawn(112))
    assert not balance_of(solved, result).faults


def _solved(random):
    solved = Run(random.scene, COMM, random.body(COMM))
    return solved, solved.solve()


def first_of(kind, wanted=lambda random: True):
    """The first scene of a kind that is wanted."""
    for number in range(300):
        random = drawn(number)
        if random.kind == f"heated: {kind}" and wanted(random):
            return random
    raise AssertionError(f"no such {kind} is drawn")


def test_a_wrong_temperature_does_not_balance():
    random = first_of("row", lambda random: len(random.scene.temperature) == 1)
    solved = Run(random.scene, COMM, random.body(COMM))
    result = solved.solve()
    assert not balance_of(solved, result).faults
    (given,) = random.scene.temperature
    warmer = dataclasses.replace(given, value=1.001 * (given.value or 1.0))
    solved.scene = dataclasses.replace(random.scene, temperature=(warmer,))
    assert balance_of(solved, result).faults


def test_a_free_body_with_stress_is_noticed():
    random = first_of("free", lambda random: random.stress is not None)
    solved = Run(random.scene, COMM, random.body(COMM))
    result = solved.solve()
    assert not balance_of(solved, result, random.stress).faults
    assert balance_of(solved, result, 1e-9 * random.stress).faults


def written(made, out, resume):
    """The result of a run with its files."""
    files.require_writable(out, COMM)
    state = StateFile(out, made.problem)
    return files.solve_and_write(made, out, state, state.load() if resume else None)


@pytest.mark.parametrize("kind", ["fit", "stack", "bolted"])
def test_what_was_stopped_goes_on(kind, folder):
    """The state after two of three load steps leads to the same answer."""
    random = first_of(kind)
    times = (1.0, 1.5, 2.0) if kind == "bolted" else (0.4, 0.7, 1.0)
    whole = dataclasses.replace(random.scene, steps=Steps(times=times))
    begun = dataclasses.replace(random.scene, steps=Steps(times=times[:2]))
    body = random.body(COMM)
    at_once = Run(whole, COMM, body).solve()
    assert at_once.exit_code == 0, at_once.verdict
    written(Run(begun, COMM, body), folder / "out", resume=False)
    taken_up = written(Run(whole, COMM, body), folder / "out", resume=True)
    for name in ("strain_energy", "external_work", "max_temperature"):
        assert taken_up.quantities[name] == pytest.approx(at_once.quantities[name], rel=1e-8)
