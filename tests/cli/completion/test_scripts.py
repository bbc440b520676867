"""Completion scripts, tried in the shells that are there; bash is everywhere."""

import os
import shutil
import subprocess

import pytest

from fenics_contact import main
from fenics_contact.cli.completion import script
from fenics_contact.cli.options import SHELLS, parsers
from fenics_contact.common.program import templates

pytestmark = pytest.mark.serial

IN_BASH = """
source "$SCRIPT"
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_fenics_contact
printf '%s\\n' "${COMPREPLY[@]}"
"""
# What a terminal of its own shows after a line and two tabs: until there is what is expected, or
# for ten seconds.
IN_ZSH = """
zmodload zsh/zpty
zpty -b shell zsh -f -i
shown() {
    local all='' part
    repeat 100; do
        while zpty -r -t shell part; do all+=$part; done
        [[ $all == *$1* ]] && break
        sleep 0.1
    done
    print -r -- "$all"
}
zpty -w shell 'PS1=; autoload -Uz compinit; compinit -u -d "$PWD/.zcompdump"; source "$SCRIPT"'
zpty -w shell 'LISTMAX=10000; setopt no_beep no_auto_menu; print re""ady'
shown ready >/dev/null
zpty -w -n shell "$1"$'\\t\\t'
shown "$2"
zpty -d shell
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with a script for each shell, and files of several kinds."""
    folder = tmp_path_factory.mktemp("completion")
    for shell in SHELLS:
        (folder / f"script.{shell}").write_text(script(shell), encoding="utf-8")
    for name in ("a scene.toml", "slab.toml", "slab.geo", "measured.csv"):
        (folder / name).touch()
    (folder / "results").mkdir()
    return folder


def ask(place, shell, command, *arguments):
    """What a shell prints."""
    found = shutil.which(shell)
    if found is None:
        pytest.skip(f"there is no {shell}")
    done = subprocess.run(
        [found, *command, *arguments],
        cwd=place,
        env=dict(os.environ) | {"SCRIPT": str(place / f"script.{shell}"), "TERM": "dumb"},
        capture_output=True,
        text=True,
        timeout=120,
        stdin=subprocess.DEVNULL,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def in_bash(place, *words):
    return [
        line
        for line in ask(place, "bash", ["--norc", "-c", IN_BASH, "-"], *words).splitlines()
        if line
    ]


def in_fish(place, *words):
    line = " ".join(words)
    command = ["--no-config", "-c", 'source $SCRIPT; complete -C "$argv[1]"', line]
    return [found.partition("\t")[0] for found in ask(place, "fish", command).splitlines()]


CASES = [
    (["ru"], {"run"}, {"check"}),
    ([""], {"run", "check", "new", "schema", "completion"}, {"slab.toml"}),
    (["run", "--"], {"--out", "--set", "--resume", "--quiet"}, {"--list"}),
    (["run", "sl"], {"slab.toml"}, {"slab.geo"}),
    (["run", "slab.toml", "--out", "r"], {"results"}, {"slab.toml"}),
    (["new", ""], set(templates()), {"slab.toml"}),
    (["completion", ""], {"bash", "zsh", "fish"}, {"run"}),
    (["verify", "--json", "me"], {"measured.csv"}, set()),
    (["run", "a", "--set", "steps.n"], {"steps.number="}, {"steps.end="}),
    (["run", "a", "--set", "contact.0.fr"], {"contact.0.friction_coefficient="}, set()),
    (["run", "a", "--set", "contact.12.fr"], {"contact.12.friction_coefficient="}, set()),
    (["run", "a", "--set", "load."], {"load.0.pressure="}, {"contact.0.pressure="}),
    (["run", "slab.toml", "--", "-k"], set(), {"--quiet", "-h"}),
]


@pytest.mark.parametrize("ask_shell", [in_bash, in_fish], ids=["bash", "fish"])
@pytest.mark.parametrize(
    ("words", "some", "none"), CASES, ids=[" ".join(words) for words, _, _ in CASES]
)
def test_words_are_completed(place, ask_shell, words, some, none):
    found = {name.rstrip("/") for name in ask_shell(place, "fenics-contact", *words)}
    assert some <= found and not none & found


def test_bash_takes_an_equals_sign_for_a_word(place):
    """So that --out=r comes as three words, and a value that is set as well."""
    assert in_bash(place, "fenics-contact", "run", "a", "--out", "=", "r") == ["results"]
    assert "results" in in_bash(place, "fenics-contact", "run", "a", "--out", "=")
    assert in_bash(place, "fenics-contact", "run", "a", "--set", "mesh.size", "=") == []
    assert in_bash(place, "fenics-contact", "run", "a", "--set", "mesh.size", "=", "s") == []


def test_bash_keeps_names_with_blanks_whole(place):
    assert in_bash(place, "fenics-contact", "run", "a") == ["a scene.toml"]


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("fenics-contact ", "check"),
        ("fenics-contact run --", "--resume"),
        ("fenics-contact run s", "slab.toml"),
        ("fenics-contact new ", "cylinders"),
        ("fenics-contact run a --set contact.3.fr", "contact.3.friction_coefficient="),
        ("fenics-contact run a --out re", "results/"),
    ],
)
def test_zsh_completes_too(place, line, found):
    assert found in ask(place, "zsh", ["-f", "-c", IN_ZSH, "-"], line, found)


@pytest.mark.parametrize("shell", SHELLS)
def test_scripts_are_whole(place, shell):
    """Every command and long option is in each, and the shell finds nothing wrong with it."""
    text = (place / f"script.{shell}").read_text(encoding="utf-8")
    for name, parser in parsers()[1].items():
        assert name in text
        for option in parser._option_string_actions:
            assert (f"-l {option[2:]} " if shell == "fish" else option) in text or option == "-h"
    ask(place, shell, ["-n", str(place / f"script.{shell}")])


def test_the_command_prints_the_script(capsys):
    assert main(["completion", "bash"]) == 0
    assert capsys.readouterr().out == script("bash") + "\n"
