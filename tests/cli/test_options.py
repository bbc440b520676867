"""The command line's words: help, hints, and one sentence for what it does not know."""

import re

import pytest
from mpi4py import MPI

from fenics_contact import main
from fenics_contact.cli import program as cli
from fenics_contact.cli.options import is_first_rank
from fenics_contact.cli.program import parse
from tests.messages import says
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
COMMANDS = (
    *("new", "look", "check", "run", "fit", "explore", "report", "verify", "schema"),
    *("materials", "completion"),
)
OF_TEXTS = ("schema", "materials", "completion")  # which say nothing but what they print


def said(capsys, *arguments, code):
    """What rank 0 says on stdout and stderr as it stops; the others say nothing."""
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == code
    found = tuple(capsys.readouterr())
    if COMM.rank > 0:
        assert found == ("", "")
    return COMM.bcast(found)


def test_help_has_commands_examples_and_exit_codes(capsys):
    found, _ = said(capsys, "--help", code=0)
    for command in COMMANDS:
        assert re.search(rf"^    {command} +\S", found, re.MULTILINE), command
    for code in (0, 2, 3, 4, 5, 130):
        assert re.search(rf"^  {code} +\S", found, re.MULTILINE), code
    assert "  fenics-contact run hertz.toml " in found


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_help_with_examples_that_it_understands(capsys, command):
    found, _ = said(capsys, command, "--help", code=0)
    examples = re.findall(rf"^  fenics-contact {command} (.*?)(?:  +#.*)?$", found, re.MULTILINE)
    assert examples
    for example in examples:
        example = example.partition(">")[0]
        words = [word.strip('"') for word in re.findall(r'"[^"]*"|\S+', example)]
        assert parse([command, *words]).command == command
    options = re.findall(r"^  (--[a-z]+)", found, re.MULTILINE)
    if command not in OF_TEXTS:
        assert "--quiet" in options and (command == "new" or "--verbose" in options)


@pytest.mark.parametrize("columns", [70, 80, 120])
def test_help_is_as_wide_as_the_terminal(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    found, _ = said(capsys, "run", "--help", code=0)
    as_they_are = ("usage:", "  fenics-contact", "  mpirun")
    prose = [line for line in found.splitlines() if not line.startswith(as_they_are)]
    longest = max(map(len, prose))
    assert columns - 20 < longest < columns


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rnu", "x.toml"], "no_command_rnu"),
        (["fly"], "no_command_fly"),
        (["run"], "scene_is_required"),
        (["run", "a.toml", "b.toml"], "one_scene_too_many"),
        (["run", "a.toml", "--otu", "b"], "no_option_otu"),
        (["run", "a.toml", "--qiet=1"], "no_option_qiet"),
        (["--verison"], "no_option_verison"),
        (["--verbose"], "verbose_without_command"),
        (["--verbose", "run", "a.toml"], "verbose_without_command"),
        (["check", "a.toml", "--", "-ksp_view"], "petsc_options_of_check"),
        (["run", "a.toml", "--quiet", "--verbose"], "quiet_and_verbose"),
        (["run", "a.toml", "--out"], "out_without_argument"),
    ],
)
def test_what_is_not_known_is_one_sentence_with_a_hint(capsys, arguments, words):
    out, error = said(capsys, *arguments, code=2)
    assert out == "" and error.count("\n") == 1
    says(words, error)


def test_no_command_is_answered_by_help(capsys):
    out, error = said(capsys, code=2)
    assert out == "" and "Examples:" in error


def test_words_after_two_dashes_are_for_petsc():
    options = parse(["run", "a.toml", "--out", "b", "--", "-ksp_view", "--", "-x"])
    assert options.petsc == ["-ksp_view", "--", "-x"] and str(options.out) == "b"
    assert parse(["check", "a.toml", "--"]).petsc == []


def test_version_says_what_numbers_depend_on(capsys):
    assert main(["--version"]) == 0
    found = COMM.bcast(capsys.readouterr().out)
    assert re.fullmatch(r"fenics-contact \d\S+, with dolfinx 0\.\d+\S*\n", found)
    assert main(["--version", "--verbose"]) == 0
    found = COMM.bcast(capsys.readouterr().out)
    assert re.match(
        r"fenics-contact \d\S+, with dolfinx 0\.\d+\S*, PETSc 3\.\d+\.\d+, Python 3", found
    )
    assert "To cite it: L. T. Campos" in found


def test_scripts_have_help_and_hints(capsys):
    from demos.demo_slab import __doc__ as words
    from demos.demo_slab import scene

    with pytest.raises(SystemExit) as stop:
        cli.run_script(scene, "results/slab", words, ["--help"])
    found = COMM.bcast(capsys.readouterr().out)
    assert stop.value.code == 0
    assert "results folder (results/slab)" in found and "Exit codes:" in found
    assert "Example 1 of Campos" in found
    with pytest.raises(SystemExit) as stop:
        cli.run_script(scene, "results/slab", words, ["--no-picture"])
    assert stop.value.code == 2
    says("no_option_no_picture", COMM.bcast(capsys.readouterr().err))


@pytest.mark.parametrize("name", ["PMI_RANK", "PMIX_RANK"])
def test_one_rank_of_a_launcher_speaks(monkeypatch, name):
    for variable in ("PMI_RANK", "PMIX_RANK"):
        monkeypatch.delenv(variable, raising=False)
    assert is_first_rank()
    monkeypatch.setenv(name, "1")
    assert not is_first_rank()
    monkeypatch.setenv(name, "0")
    assert is_first_rank()


def test_quiet_check_and_verify_say_nothing_of_a_success(capsys):
    assert main(["check", str(ROOT / "demos" / "slab.toml"), "--quiet"]) == 0
    assert main(["verify", "patch", "--quick", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
