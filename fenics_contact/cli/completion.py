"""Schemas of scenes, materials, and completion scripts for shells, printed by one rank.

Scripts hold all words that the command line takes: a shell that asked the program would wait for
it to start.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import jinja2

from fenics_contact.cli.options import PROGRAM, is_first_rank, parsers
from fenics_contact.common.program import VERSION, templates
from fenics_contact.scene.schema import scene_schema
from fenics_contact.scene.units.materials import as_text

_READER_LEFT = 141  # as the shell has it


def print_text(options: argparse.Namespace) -> int:
    """Print what a command line asks for, and return the exit code.

    Args:
        options: As ``options.parse`` finds them.
    """
    if not is_first_rank():
        return 0
    try:
        texts: dict[str, Callable[[], str]] = {
            "schema": _schema,
            "materials": as_text,
            "completion": lambda: _script(options.shell),
        }
        print(texts[options.command]())
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _READER_LEFT
    return 0


def _schema() -> str:
    from fenics_contact.scene.schema import scene_schema

    return json.dumps(scene_schema(), indent=2, ensure_ascii=True)


def _script(shell: str) -> str:

    return script(shell)


# Stands for the number of an entry of a list in keys.
_NUMBER = "#"
# Tables in place of single numbers, whose keys nobody sets one by one.
_NOT_ENTERED = ("Profile", "Path", "NamedShares")


@dataclass(frozen=True)
class Argument:
    """An option, or what stands without one.

    Attributes:
        names: Of the option; of others none.
        kind: What follows: nothing, ``text``, ``folder``, ``file``, ``suffix``, ``words``, ``key``.
        choices: The words or suffixes that there are.
        meaning: In a few words.
    """

    names: tuple[str, ...]
    kind: str
    choices: tuple[str, ...]
    meaning: str


@dataclass(frozen=True)
class Command:
    """A command, or with no name the program itself."""

    name: str
    meaning: str
    options: tuple[Argument, ...]
    others: tuple[Argument, ...]


def script(shell: str) -> str:
    """The completion script for a shell.

    Args:
        shell: One of ``options.SHELLS``.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("fenics_contact.cli", "templates"),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters.update(shell=_quoted, fish=_quoted_for_fish)
    template = environment.get_template(f"{shell}.jinja")
    program, *commands = _commands()
    return template.render(
        program=program,
        commands=commands,
        name=PROGRAM,
        version=VERSION,
        keys=list(dict.fromkeys(_keys_to_set(scene_schema()))),
        number=_NUMBER,
    )


def _commands() -> Iterator[Command]:
    program, made = parsers()
    helps = {
        choice.dest: choice.help or ""
        for action in program._actions
        if isinstance(action, argparse._SubParsersAction)
        for choice in action._choices_actions
    }
    for name, parser in {"": program, **made}.items():
        taken = [action for action in parser._actions if action.nargs != argparse.PARSER]
        every = [_argument(name, action) for action in taken]
        yield Command(
            name,
            helps.get(name, ""),
            tuple(argument for argument in every if argument.names),
            tuple(argument for argument in every if not argument.names),
        )


def _argument(command: str, action: argparse.Action) -> Argument:
    kind, choices = _kind(command, action)
    meaning = (action.help or "").partition(";")[0].replace("%%", "%")
    return Argument(tuple(action.option_strings), kind, choices, meaning)


def _kind(command: str, action: argparse.Action) -> tuple[str, tuple[str, ...]]:
    """Return the kind of values of an argument, by its placeholder in the help."""
    placeholder = str(action.metavar or action.dest)
    if action.nargs == 0:
        return "", ()
    if action.choices:
        return "words", tuple(map(str, action.choices))
    if command == "new" and placeholder == "NAME":
        return "words", tuple(templates())
    if placeholder.startswith(("KEY", "table.key")):
        return "key", ()
    if suffix := re.search(r"\.(\w+)$", placeholder):
        return "suffix", (suffix[1],)
    return {"DIR": "folder", "FILE": "file"}.get(placeholder, "text"), ()


def _keys_to_set(schema: Mapping[str, Any]) -> Iterator[str]:
    """The keys of a scene as ``--set`` takes them."""

    def enter(part: Mapping[str, Any], key: str) -> Iterator[str]:
        name = part.get("$ref", "").rpartition("/")[2]
        if name in _NOT_ENTERED:
            yield key
        elif name:
            yield from enter(schema["$defs"][name], key)
        elif "properties" in part:
            for inner, what in part["properties"].items():
                yield from enter(what, f"{key}.{inner}" if key else inner)
        elif "$ref" in part.get("items", {}):
            yield from enter(part["items"], f"{key}.{_NUMBER}")
        elif "anyOf" in part:
            for one in part["anyOf"]:
                yield from enter(one, key)
        else:
            yield key

    return enter(schema, "")


def _quoted(text: str) -> str:
    return shlex.quote(text)


def _quoted_for_fish(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"
