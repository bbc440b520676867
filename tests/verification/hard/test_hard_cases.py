"""Hard cases: quick ones, and that nothing wrong passes for right."""

import dataclasses
import json
import math

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Material, Run, main, run
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.resultant_checks import equilibrium
from fenics_contact.verification import Finding
from fenics_contact.verification.hard import CASES, HardCase
from fenics_contact.verification.hard.case import ReferenceFailedError, Trial, run_hard_case
from fenics_contact.verification.hard.coefficients import branches
from fenics_contact.verification.hard.command import verify_hard
from fenics_contact.verification.hard.exact import STICK, exact_answer, statuses_of
from fenics_contact.verification.hard.scenes import (
    box,
    compared,
    driven_body,
    driven_scene,
    with_contact,
)
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
QUICK = (
    "penalty_1e-10",
    "driven_5_mu_2",
    "slab_719.99",
    "slab_720.01",
    "tipping_2.499",
    "tipping_2.5",
    "pulled_off_rough",
    "just_touching_rough",
    "comes_again",
    "units_static_1",
    "distorted_quadrilaterals",
    "inclusion_1e+06",
    "shared_nodes_rough",
)


@pytest.mark.parametrize("name", QUICK)
def test_quick_cases(name):
    (case,) = (case for case in CASES if case.name == name)
    outcome = run_hard_case(case)
    assert outcome.passed, (outcome.decisive, outcome.findings, outcome.note)


def test_there_are_many_with_names_of_their_own_and_ways_to_end():
    assert len(CASES) >= 40
    assert len({case.name for case in CASES}) == len(CASES)
    for case in CASES:
        assert case.source and case.difficulty
        assert case.reason or case.expected == ("solved",)


def test_the_page_has_a_row_for_every_case_and_none_is_silently_wrong():
    page = (ROOT / "docs" / "hard_cases.md").read_text(encoding="utf-8")
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")]
    found = {row[0].removeprefix("| "): row for row in rows}
    for case in CASES:
        assert case.name in found, f"{case.name}: run verify --hard --table docs/hard_cases.md"
        assert found[case.name][1] == case.difficulty
    assert "none are silently wrong" in page


CONVERGED = (Trial(0, "Converged."),)


def made(*findings, trials=CONVERGED, expected=("solved",), reason="", error=None):
    def run(kept):
        kept.done.extend(trials)
        yield from findings
        if error:
            raise error

    return HardCase("made", "made", "made up", "nowhere", run, expected, reason)


RIGHT, WRONG = Finding("F", 1.0, 1.0, 1e-3), Finding("F", 1.01, 1.0, 1e-3)
REFUSED = Trial(2, "no equilibrium: the loads are twice what friction can hold")
REFUSAL = {"expected": ("refused",), "reason": "friction can hold"}


@pytest.mark.parametrize(
    ("case", "passed", "silently_wrong"),
    [
        (made(RIGHT), True, False),
        (made(RIGHT, WRONG), False, True),
        (made(Finding("F", math.nan, 1.0, 1e-3)), False, True),
        (made(), False, True),  # nothing was compared
        (made(trials=[REFUSED], **REFUSAL), True, False),
        (made(trials=[REFUSED], expected=("refused",), reason="push it away"), False, False),
        (made(trials=[REFUSED]), False, False),  # there is an answer
        (made(RIGHT, **REFUSAL), False, True),  # there is none
        (made(trials=[Trial(3, "No answer: no friction can hold it.")], **REFUSAL), False, False),
        (made(RIGHT, trials=[Trial(0, ""), Trial(4, "do not trust it")]), False, False),
        (made(RIGHT, error=ReferenceFailedError("no reference")), False, False),
    ],
)
def test_only_right_answers_and_right_refusals_pass(case, passed, silently_wrong, capsys):
    outcome = run_hard_case(case)
    assert outcome.passed == passed
    assert outcome.is_silently_wrong == silently_wrong
    assert verify_hard((), cases=[case]) == (0 if passed else 4)
    said = COMM.bcast(capsys.readouterr().out)
    assert ("SILENTLY WRONG" in said) == silently_wrong
    assert ("1 is silently wrong" in said) == silently_wrong


def solved_case(solved, reference, **keys):
    """A case that solves one scene and compares it with the inequalities of another."""

    def run(trials):
        result = trials.solve(solved, driven_body())
        yield from compared(result, exact_answer(reference, driven_body, statuses_of(result)), 1e-3)

    return HardCase("made", "made", "made up", "nowhere", run, **keys)


def test_a_wrong_coefficient_or_a_soft_penalty_is_silently_wrong():
    right = driven_scene(0.5, 0.05, -0.01)
    assert run_hard_case(solved_case(right, right)).passed
    for wrong in (driven_scene(0.495, 0.05, -0.01), with_contact(right, penalty_parameter=1e-6)):
        outcome = run_hard_case(solved_case(wrong, right))
        assert outcome.ending == "solved" and outcome.is_silently_wrong


def test_a_scene_without_equilibrium_that_gets_an_answer_is_silently_wrong():
    scene = driven_scene(0.5, 0.01, -0.01)
    outcome = run_hard_case(solved_case(scene, scene, **REFUSAL))
    assert outcome.is_silently_wrong and not outcome.passed


def test_a_wrong_refusal_fails():
    """A support that is missing: the scene is refused, and was to be solved."""
    scene = dataclasses.replace(driven_scene(0.0, 0.01, -0.01), support=())
    outcome = run_hard_case(solved_case(scene, scene))
    assert outcome.ending == "refused" and not outcome.passed
    assert not outcome.is_silently_wrong


def test_exact_answers_keep_every_inequality():
    scene = driven_scene(2.0, 0.05, -0.01)
    exact = exact_answer(scene, driven_body)
    bound = 2.0 * exact.pressure
    peak = exact.pressure.max()
    assert exact.pressure.min() >= -1e-9 * peak
    assert (np.abs(exact.friction) <= bound + 1e-9 * peak).all()
    sticks = exact.status == STICK
    slips = np.abs(exact.status) == 1
    assert sticks.any() and slips.any()
    assert (np.abs(exact.friction[sticks]) < bound[sticks]).all()
    assert np.abs(exact.friction[slips]) == pytest.approx(bound[slips])
    assert (exact.friction[slips] * exact.status[slips] <= 0).all()


def test_exact_answers_are_where_smaller_parameters_lead():
    """Of first order in ε₁: a tenth of it is ten times as near."""
    scene = driven_scene(0.0, 0.0, -0.01)
    exact = exact_answer(scene, driven_body)
    errors = []
    for penalty in (1e-6, 1e-7, 1e-8):
        result = run(with_contact(scene, penalty_parameter=penalty), body=driven_body())
        errors.append(result.quantities["normal_force"] / exact.normal_force - 1)
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.05)


def test_large_friction_has_branches_and_a_moderate_one_has_not():
    """Separated, slipping, sticking at μ = 2, but at μ = 1 only separated (the specification)."""
    found = branches(2.0)
    assert len(found) == 3
    resting, slipping, sticking = sorted(found, key=lambda branch: branch.normal_force)
    assert resting.normal_force == 0
    assert slipping.normal_force > 0.1 and STICK not in slipping.status
    assert STICK in sticking.status
    (only,) = branches(1.0)
    assert only.normal_force == 0


def test_command_line_writes_rows_and_a_table(folder, capsys):
    rows, table = folder / "found.json", folder / "table.md"
    names = ["tipping_2.4", "tipping_2.6"]
    assert main(["verify", "--hard", *names, "--json", str(rows), "--table", str(table)]) == 0
    solved, refused = json.loads(rows.read_text(encoding="utf-8"))
    assert [row["name"] for row in (solved, refused)] == names
    assert solved["found"] == "solved" and solved["newton"] > 0
    assert len(solved["findings"]) == 3
    assert refused["exit_code"] == 2 and "push it away" in refused["sentence"]
    page = table.read_text(encoding="utf-8")
    assert all(f"| {name} | " in page for name in names)
    assert refused["sentence"] in page
    assert "2 of 2 cases passed" in COMM.bcast(capsys.readouterr().out)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--hard", "nonsense"], "no case 'nonsense'; there are\n  "),
        (["--hard", "--quick"], "no --quick"),
        (["--table", "table.md"], "add --hard"),
        (["--hard", "--table", "/nowhere/table.md"], "a folder that can be written to"),
    ],
)
def test_bad_words_are_one_sentence(arguments, message, capsys):
    assert main(["verify", *arguments]) == 2
    assert message in COMM.bcast(capsys.readouterr().err)


def test_round_off_of_a_stiff_part_is_no_imbalance_and_an_imbalance_is_none_of_it():
    """A plate a million times as stiff: its round-off fails no check, a reaction .1 % off does."""
    scene = driven_scene(0.5, 0.01, -0.01)
    material = (Material(1000, 0.3, on="rest"), Material(1e9, 0.3, on="plate"))
    body = box((16, 12), (2, 1.5), parts={"plate": lambda x: x[:, 1] > 1})
    prepared = Run(dataclasses.replace(scene, material=material), COMM, body)
    result = prepared.solve()
    assert result.passed, result.verdict
    held = np.abs(prepared.problem.spaces.coordinates[:, 1] - 1.5) < 1e-9
    prepared.solution.internal_force[held, 1] *= 1.001
    forces = BulkForces(prepared.problem, prepared.solution)
    assert not equilibrium(forces).passed
