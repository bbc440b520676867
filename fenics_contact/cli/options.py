"""Options and help of the command line; nothing of FEniCSx, to start fast."""

from __future__ import annotations

import argparse
import os
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import IO, NoReturn

from fenics_contact.cli import figures, texts
from fenics_contact.cli.compare import options as compare
from fenics_contact.cli.explore import options as explore
from fenics_contact.cli.fit import options as fit
from fenics_contact.cli.look import options as look
from fenics_contact.cli.sweep import options as sweep
from fenics_contact.common.wording import did_you_mean, printable

PROGRAM = "fenics-contact"

SHELLS = ("bash", "zsh", "fish")

_EXIT_BRIEFLY = "Exit codes: see fenics-contact --help."
_EPILOGS = {"run": f"{texts.RUN_EXAMPLES}\n\n{texts.EXIT_CODES}", "sweep": sweep.EPILOG}


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


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the words after ``fenics-contact``.

    Args:
        arguments: These words.

    Returns:
        ``command``, and the options of that command; ``petsc`` are the words after ``--``.

    Raises:
        SystemExit: Help was asked for (0), or something is wrong (2); it was said.
    """
    parser, commands = parsers()
    words, petsc = _split(arguments)
    first = next((word for word in words if not word.startswith("-")), None)
    if first is not None and first not in commands:
        known = list(commands)
        hint = did_you_mean(first, known) or f"; there are {', '.join(known)}"
        parser.error(f"there is no command '{first}'{hint}")
    options, left = parser.parse_known_args(words, argparse.Namespace(petsc=petsc))
    if left:
        (parser if first is None else commands[first]).refuse_unknown(left)
    if options.command is None and not (options.version or options.all_versions):
        parser.print_help(sys.stderr)
        parser.exit(2)
    if options.all_versions and not options.version:
        parser.error("--verbose belongs to --version, or comes after a command")
    if petsc and options.command != "run":
        parser.error("only the command run takes PETSc options, after --")
    return options


def parse_script(
    arguments: Sequence[str] | None, default_folder: str, description: str
) -> argparse.Namespace:
    """What the words after a demo script ask for; see ``parse``."""
    parser = _Parser(
        description=description,
        usage="%(prog)s [options] [-- PETSc options]",
        epilog=texts.EXIT_CODES,
    )
    parser.add_argument(
        "--out", type=Path, default=Path(default_folder), help=f"results folder ({default_folder})"
    )
    parser.add_argument("--no-pictures", action="store_true", help="write files only")
    _add_resume(parser)
    _add_verbosity(parser)
    parser.add_argument_group("PETSc", texts.PETSC)
    words, petsc = _split(sys.argv[1:] if arguments is None else arguments)
    options, left = parser.parse_known_args(words, argparse.Namespace(petsc=petsc))
    if left:
        parser.refuse_unknown(left)
    return options


def _split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """The words before and after the first ``--``."""
    words = list(arguments)
    place = words.index("--") if "--" in words else len(words)
    return words[:place], words[place + 1 :]


def parsers() -> tuple[_Parser, dict[str, _Parser]]:
    """The program's parser and, by their names, those of its commands."""
    parser = _Parser(
        prog=PROGRAM,
        usage="%(prog)s COMMAND [options]",
        description=texts.ABOUT,
        epilog=f"{texts.FIRST}\n\n{texts.EXIT_CODES}",
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
        ("new", "write a scene to start from", "NAME [options]", texts.NEW),
        look.COMMAND,
        (
            "check",
            "say what would be modelled, without solving",
            "SCENE.toml [options]",
            texts.CHECK,
        ),
        ("run", "solve a scene", "SCENE.toml [options] [-- PETSc options]", ""),
        sweep.COMMAND,
        fit.COMMAND,
        explore.COMMAND,
        (
            "report",
            "pictures and a page from the files of a run, sweep, fit or wear",
            "DIR [options]",
            texts.REPORT,
        ),
        compare.COMMAND,
        ("verify", "run analytic and published benchmarks", "[NAME ...] [options]", texts.VERIFY),
        ("schema", "print the JSON schema of a scene, for editors", "[options]", texts.SCHEMA),
        ("completion", "print a completion script, for shells", "bash|zsh|fish", texts.COMPLETION),
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
    explore.describe(made["explore"])
    _describe_new(made["new"])
    look.describe(made["look"])
    _add_scene(made["sweep"])
    sweep.describe(made["sweep"])
    _add_scene(made["fit"])
    fit.describe(made["fit"])
    made["report"].add_argument(
        "folder",
        metavar="DIR",
        type=Path,
        help="results of a run, a sweep, a fit or of cycles that wear",
    )
    figures.describe(made["report"])
    compare.describe(made["compare"])
    _describe_verify(made["verify"])
    _add_laws(made["schema"], "import this Python module, whose kinds of loads and laws it has")
    made["schema"].set_defaults(verbose=False, quiet=False)
    made["completion"].add_argument("shell", choices=SHELLS, help="for which it is")
    for name, command in made.items():
        if name not in ("schema", "completion"):  # which say nothing else
            _add_verbosity(command, is_only_quiet=name == "new")
    made["run"].add_argument_group("PETSc", texts.PETSC)
    return parser, made


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
