"""Options and help of the command line; nothing of FEniCSx, to start fast."""

from __future__ import annotations

import argparse
import os
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import IO, NoReturn

from fenics_contact.cli import tool_options as tools
from fenics_contact.common.wording import did_you_mean, printable

PROGRAM = "fenics-contact"

SHELLS = ("bash", "zsh", "fish")
# Commands that print a text and say nothing else.
TEXTS = ("schema", "materials", "completion")

_ABOUT = """\
Contact with friction in elastostatics, on FEniCSx: a scene in a file says what the body is, what
holds it, loads it and touches it; the answer comes with checks of the physics and with error bars.
After Campos, Oden and Kikuchi (1982)."""

_EXIT_CODES = """\
Exit codes:
  0    converged, and every check passed
  2    bad input, or a scene that has no equilibrium
  3    not converged, or not to the accuracy asked for
  4    converged, but a check of the physics failed
  5    the machine failed: memory, disk, a rank
  130  interrupted; the last load step that was done is kept"""

_FIRST = """\
Examples:
  fenics-contact new hertz              # a scene to start from, with its mesh
  fenics-contact look joint.step        # a CAD file as a page, and a scene to complete
  fenics-contact check hertz.toml       # what would be modelled
  fenics-contact run hertz.toml         # solves it
  fenics-contact sweep hertz.toml --vary contact.0.friction_coefficient=0:0.5:6
  fenics-contact report results/hertz   # pictures and a page
  mpirun -n 4 fenics-contact run hertz.toml

fenics-contact COMMAND --help says more of each."""

_RUN_EXAMPLES = """\
Examples:
  fenics-contact run scene.toml
  fenics-contact run scene.toml --out here --set load.0.pressure=5
  fenics-contact run scene.toml --set "load.0.traction=[-600, 0]" --set accuracy=1e-2
  fenics-contact run scene.toml --resume
  fenics-contact run scene.toml -- -snes_monitor -mat_mumps_icntl_14 80
  mpirun -n 4 fenics-contact run scene.toml"""

_PETSC = """\
What follows -- is for PETSc, and wins over the program's choices, for this run alone. Options get
the prefix fenics_contact_ if they have not got it: -snes_max_it 50 (Newton's method), -ksp_view,
-mat_mumps_icntl_14 80 (the body's factorisation); with solver = "iterative" also -bulk_...
(multigrid) and -zone_... (MUMPS at the contacts). Options that nothing used are named at the end.
With the prefix they may also stand in the environment variable PETSC_OPTIONS."""

_CHECK = """\
Reads scene and mesh as `run` does and says what would be modelled: energy terms, unknowns, solver,
memory, what may still move. It refuses what `run` would refuse, and writes nothing.

Examples:
  fenics-contact check scene.toml
  fenics-contact check scene.toml --set mesh.size=0.1"""

_REPORT = """\
Makes pictures and a page, report.html, of what a run has left in its folder; of a sweep its page,
sweep.html, of a fit its page, fit.html, of cycles that wear theirs, wear.html. It needs the extra
`pictures` (pyvista, matplotlib), but no mesh, no scene and no MPI.

Example:
  fenics-contact report results/hertz"""

_VERIFY = """\
Runs cases that have a formula or a published result: value, reference, source and error of each.

Examples:
  fenics-contact verify                 # all of them
  fenics-contact verify --quick         # about a minute
  fenics-contact verify hertz_sphere --json found.json
  fenics-contact verify --hard          # hard cases; minutes
  fenics-contact verify --errors        # error bars; a quarter of an hour"""

_NEW = """\
Writes a scene with comments, and its mesh beside it, that runs as it is. Files that are there
already are left alone.

Examples:
  fenics-contact new --list
  fenics-contact new hertz
  fenics-contact new own --out mine/first.toml"""

_SCHEMA = """\
Prints the JSON schema of a scene, from which editors complete keys, show what they mean and mark
what is wrong: VS Code with Even Better TOML, and others.

Example:
  fenics-contact schema > scene.schema.json   # a scene names it in its first line:
                                              # #:schema ./scene.schema.json"""

_MATERIALS = """\
Prints the materials that a scene with [units] may name, such as material.name = "steel S355", with
Young's modulus, Poisson's ratio, density, thermal expansion and the source of these.

Example:
  fenics-contact materials > materials.txt"""

_COMPLETION = """\
Prints a script by which a shell completes commands, options, scene files, keys after --set and
names of scenes to start from. It does not start the program, so it answers at once.

Examples:
  fenics-contact completion bash > ~/.local/share/bash-completion/completions/fenics-contact
  fenics-contact completion fish > ~/.config/fish/completions/fenics-contact.fish
  fenics-contact completion zsh > ~/.zfunc/_fenics-contact   # a folder of $fpath"""

_EXIT_BRIEFLY = "Exit codes: see fenics-contact --help."
_EPILOGS = {"run": f"{_RUN_EXAMPLES}\n\n{_EXIT_CODES}", "sweep": tools.SWEEP_EPILOG}


class _Formatter(argparse.HelpFormatter):
    """Help as wide as the terminal; indented lines, as of examples, stay as they are."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=26)

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        paragraphs = [self._fill(part, width, indent) for part in text.split("\n\n")]
        return "\n\n".join(paragraphs)

    @staticmethod
    def _fill(part: str, width: int, indent: str) -> str:
        lines = part.splitlines()
        start = next((n for n, line in enumerate(lines) if line.startswith(" ")), len(lines))
        prose = textwrap.fill(
            " ".join(lines[:start]), width, initial_indent=indent, subsequent_indent=indent
        )
        return "\n".join([prose, *(indent + line for line in lines[start:])])


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one sentence, on one rank."""

    def __init__(self, **settings: object) -> None:
        super().__init__(formatter_class=_Formatter, allow_abbrev=False, **settings)  # type: ignore[arg-type]

    def error(self, message: str) -> NoReturn:
        see = "" if message.endswith("?") else f"; see {self.prog} --help"
        self.exit(2, f"{self.prog}: {message}{see}\n")

    def refuse_unknown(self, words: Sequence[str]) -> NoReturn:
        """Say which word there is no place for, and what it may have been meant to be."""
        word = words[0].partition("=")[0]
        if not word.startswith("-"):
            self.error(f"'{word}' is one too many")
        self.error(f"there is no option '{word}'" + did_you_mean(word, self._options()))

    def _options(self) -> list[str]:
        return [name for name in self._option_string_actions if name.startswith("--")]

    def _print_message(self, message: str, file: IO[str] | None = None) -> None:  # type: ignore[override]
        if is_first_rank():
            super()._print_message(printable(message), file)


def is_first_rank() -> bool:
    """Whether a launcher says so, or there is none; MPI itself would take time to ask."""
    ranks = [os.environ.get(name, "0") for name in ("PMI_RANK", "PMIX_RANK")]
    return all(rank == "0" for rank in ranks)


def parsers() -> tuple[_Parser, dict[str, _Parser]]:
    """The program's parser and, by their names, those of its commands."""
    parser = _Parser(
        prog=PROGRAM,
        usage="%(prog)s COMMAND [options]",
        description=_ABOUT,
        epilog=f"{_FIRST}\n\n{_EXIT_CODES}",
    )
    parser.add_argument(
        "--version", action="store_true", help="versions of the program and of dolfinx"
    )
    parser.add_argument(
        "--verbose",
        dest="all_versions",
        action="store_true",
        help="with --version: of all that numbers depend on; how to cite",
    )
    group = parser.add_subparsers(prog=PROGRAM, dest="command", metavar="COMMAND", title="commands")
    made = {}
    for name, words, usage, description in (
        ("new", "write a scene to start from", "NAME [options]", _NEW),
        tools.LOOK,
        (
            "check",
            "say what would be modelled, without solving",
            "SCENE.toml [options]",
            _CHECK,
        ),
        ("run", "solve a scene", "SCENE.toml [options] [-- PETSc options]", ""),
        tools.SWEEP,
        tools.FIT,
        tools.EXPLORE,
        (
            "report",
            "pictures and a page from the files of a run, sweep, fit or wear",
            "DIR [options]",
            _REPORT,
        ),
        tools.COMPARE,
        ("verify", "run analytic and published benchmarks", "[NAME ...] [options]", _VERIFY),
        ("schema", "print the JSON schema of a scene, for editors", "[options]", _SCHEMA),
        ("materials", "print the materials that scenes may name", "", _MATERIALS),
        ("completion", "print a completion script, for shells", "bash|zsh|fish", _COMPLETION),
    ):
        made[name] = group.add_parser(
            name,
            help=words,
            usage=f"{PROGRAM} {name} {usage}",
            description=description or "Solves a scene, checks the answer and writes it to files.",
            epilog=_EPILOGS.get(name, _EXIT_BRIEFLY),
        )
    _describe_run(made["run"])
    _describe_check(made["check"])
    _add_scene(made["explore"])
    tools.describe_explore(made["explore"])
    _describe_new(made["new"])
    tools.describe_look(made["look"])
    _add_scene(made["sweep"])
    tools.describe_sweep(made["sweep"])
    _add_scene(made["fit"])
    tools.describe_fit(made["fit"])
    made["report"].add_argument(
        "folder",
        metavar="DIR",
        type=Path,
        help="results of a run, a sweep, a fit or of cycles that wear",
    )
    tools.describe_figures(made["report"])
    tools.describe_compare(made["compare"])
    _describe_verify(made["verify"])
    _add_laws(made["schema"], "import this Python module, whose kinds of loads and laws it has")
    made["schema"].set_defaults(verbose=False, quiet=False)
    made["completion"].add_argument("shell", choices=SHELLS, help="for which it is")
    for name, command in made.items():
        if name not in TEXTS:
            _add_verbosity(command, is_only_quiet=name == "new")
    made["run"].add_argument_group("PETSc", _PETSC)
    return parser, made


def script_parser(default_folder: str, description: str) -> _Parser:
    """The parser of a script that makes a scene; see ``parse_script``."""
    parser = _Parser(
        description=description,
        usage="%(prog)s [options] [-- PETSc options]",
        epilog=_EXIT_CODES,
    )
    parser.add_argument(
        "--out", type=Path, default=Path(default_folder), help=f"results folder ({default_folder})"
    )
    parser.add_argument("--no-pictures", action="store_true", help="write files only")
    _add_resume(parser)
    _add_verbosity(parser)
    parser.add_argument_group("PETSc", _PETSC)
    return parser


def _describe_run(command: argparse.ArgumentParser) -> None:
    _add_scene(command)
    command.add_argument(
        "--out", metavar="DIR", type=Path, help="results folder (results/ and the scene's name)"
    )
    _add_resume(command)


def _describe_check(command: argparse.ArgumentParser) -> None:
    _add_scene(command)


def _describe_new(command: argparse.ArgumentParser) -> None:
    command.add_argument("name", metavar="NAME", nargs="?", help="which one; see --list")
    command.add_argument("--out", metavar="FILE", type=Path, help="to write (NAME.toml)")
    command.add_argument("--list", action="store_true", help="say what there is")


def _describe_verify(command: argparse.ArgumentParser) -> None:
    command.add_argument("names", metavar="NAME", nargs="*", help="benchmarks to run (all)")
    which = command.add_argument_group("which")
    which.add_argument("--quick", action="store_true", help="coarser and fewer: about a minute")
    which.add_argument("--hard", action="store_true", help="the hard cases instead: minutes")
    which.add_argument("--errors", action="store_true", help="error bars against true errors")
    files = command.add_argument_group("files")
    files.add_argument("--json", metavar="FILE", type=Path, help="a list of what was found")
    files.add_argument(
        "--table", metavar="FILE", type=Path, help="of hard cases or errors: a table in Markdown"
    )


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", metavar="SCENE.toml", type=Path, help="file that says what")
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="table.key=value",
        action="append",
        default=[],
        help="replace a value of the scene; list entries count from 0: load.0.pressure=5",
    )
    _add_laws(parser, "allow the scene to name laws of this Python module, which is then imported")


def _add_laws(parser: argparse.ArgumentParser, words: str) -> None:
    parser.add_argument("--laws", metavar="MODULE", action="append", default=[], help=words)


def _add_resume(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on from the last load step in the folder, on any number of ranks; the scene's "
        "steps and solver may have changed, nothing else",
    )


def _add_verbosity(parser: argparse.ArgumentParser, is_only_quiet: bool = False) -> None:
    group = parser.add_argument_group("messages").add_mutually_exclusive_group()
    if is_only_quiet:
        parser.set_defaults(verbose=False)
    else:
        group.add_argument(
            "--verbose", action="store_true", help="every phase and every Newton step, too"
        )
    group.add_argument("--quiet", action="store_true", help="nothing, unless something is wrong")
