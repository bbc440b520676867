"""docs/troubleshooting.md says what the program says: every message it quotes is in the source."""

import ast
import functools
import re

import pytest
from mpi4py import MPI

from fenics_contact.common.errors import InputError, MachineError, NotConvergedError, StoppedError
from fenics_contact.common.failures import BUG, READER_LEFT
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")

PAGE = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "fenics_contact"
# Errors of which every message has its line; those of input say themselves what is accepted, and
# have lines where they are not of scenes and meshes.
EXPLAINED = ("NoEquilibriumError", "NotConvergedError", "MachineError", "_StalledError")
NOT_OF_SCENES = {
    "cli/commands.py",
    "cli/compare.py",
    "cli/new_scene.py",
    "cli/explore.py",
    "cli/fit.py",
    "cli/sweep.py",
    "common/petsc_options.py",
    "explore/exploration.py",
    "explore/keys.py",
    "report/drawing/picture.py",
    "report/drawing/fields.py",
    "report/gallery.py",
    "results/compared_runs.py",
    "report/page/fit.py",
    "report/page/sweep_files.py",
    "analyses/wear_cycles/worn_history.py",
    "results/contact_points.py",
    "results/result.py",
    "simulation/adaptive/targets.py",
    "simulation/output/run_folder.py",
    "simulation/state_file.py",
    "simulation/fits/curves.py",
    "simulation/fits/fit.py",
    "simulation/fits/measured.py",
    "simulation/sweeps/points.py",
    "simulation/output/journal_file.py",
    "simulation/sweeps/journal.py",
    "verification/command.py",
}
HOLE = "…"


@functools.cache
def trees():
    """All sources, parsed by the first test that asks: every run collects this file."""
    return {
        path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted(PACKAGE.rglob("*.py"))
    }


@functools.cache
def shared():
    """Texts that messages share."""
    return {
        statement.targets[0].id: statement.value.value
        for tree in trees().values()
        for statement in tree.body
        if isinstance(statement, ast.Assign)
        and isinstance(statement.targets[0], ast.Name)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    }


def text_of(node):
    """A text of the source, with … for what is filled in; None of another expression."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str | bytes):
        return node.value if isinstance(node.value, str) else node.value.decode(errors="replace")
    if isinstance(node, ast.JoinedStr):
        return "".join(text_of(part) or HOLE for part in node.values)
    if isinstance(node, ast.FormattedValue) and isinstance(node.value, ast.Name):
        return shared().get(node.value.id)
    return None


def texts():
    """All texts of the sources."""
    found = {text_of(node) for tree in trees().values() for node in ast.walk(tree)}
    spoken = (ROOT / "bootstrap").read_text(encoding="utf-8").splitlines()
    return {text for text in found if text} | set(spoken)


def quoted():
    """What stands in backticks in the first column of a table, as the page has it."""
    rows = [line for line in PAGE.splitlines() if line.startswith("| ")]
    return [quote for row in rows for quote in re.findall(r"`([^`]+)`", row.split(" | ")[0])]


def says(quote, text):
    """Whether the parts between the dots of a quote follow each other in a text."""
    parts = [part for part in quote.split(HOLE) if part.strip()]
    place = 0
    for part in parts:
        place = text.find(part, place)
        if place < 0:
            return False
        place += len(part)
    return bool(parts)


def test_every_message_of_the_page_is_one_of_the_program():
    every = texts()
    assert len(quoted()) > 90
    unknown = [quote for quote in quoted() if not any(says(quote, text) for text in every)]
    assert not unknown, "\n".join(unknown)
    assert not any(says("no equilibrium: the loads are too …", text) for text in every)


def messages_of(*errors):
    """Texts with which errors are made."""
    for name, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") in errors and node.args:
                text = text_of(node.args[0])
                if text and len(text.replace(HOLE, "").strip(": '")) > 3:
                    yield name, text


def test_refusals_and_failures_are_all_on_the_page():
    found = list(messages_of(*EXPLAINED))
    assert len(found) > 8
    of_input = [(name, said) for name, said in messages_of("InputError") if name in NOT_OF_SCENES]
    assert {name for name, _ in of_input} == NOT_OF_SCENES
    found += of_input
    page = [quote for quote in quoted() if len(quote) > 15]
    missing = [(name, text) for name, text in found if not any(says(q, text) for q in page)]
    assert not missing, "\n".join(f"{name}: {text}" for name, text in missing)


def test_doubts_are_all_on_the_page():
    """Sentences that a verdict adds: texts of functions that return them."""
    functions = [
        node for node in trees()["simulation/verdict.py"].body if isinstance(node, ast.FunctionDef)
    ]
    after_docstrings = [part for function in functions for part in function.body[1:]]
    found = {text_of(node) for part in after_docstrings for node in ast.walk(part)}
    parts = {part.strip() for text in found if text for part in text.split(HOLE)}
    assert len(parts) > 8
    missing = [part for part in parts if len(part) > 20 and part not in PAGE]
    assert not missing, "\n".join(missing)


def test_every_check_and_exit_code_has_its_line():
    added = [
        node.value
        for node in ast.walk(trees()["simulation/step_history.py"])
        if isinstance(node, ast.AugAssign) and getattr(node.target, "id", "") == "checks"
    ]
    checks = [
        key.value
        for part in (trees()["trust/run_checks.py"], *added)
        for entries in ast.walk(part)
        if isinstance(entries, ast.Dict)
        for key in entries.keys
        if isinstance(key, ast.Constant) and isinstance(key.value, str)
    ]
    assert {"equilibrium", "energy_balance"} <= set(checks)
    for check in checks:
        assert f"| `{check}` | " in PAGE, check
    errors = (InputError, NotConvergedError, MachineError, StoppedError)
    for code in (0, 4, BUG, READER_LEFT, *(error.exit_code for error in errors)):
        assert re.search(rf"^\| {code} \| ", PAGE, re.MULTILINE), code


def test_links_within_the_page_lead_somewhere():
    titles = re.findall(r"^#+ (.+)$", PAGE, re.MULTILINE)
    anchors = {re.sub(r"[^a-z0-9 -]", "", title.lower()).replace(" ", "-") for title in titles}
    assert set(re.findall(r"\]\(#([^)]+)\)", PAGE)) <= anchors
