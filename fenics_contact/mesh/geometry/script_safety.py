"""Gmsh's geometry scripts that a scene may use: those that only make a geometry and its mesh.

A ``.geo`` file is a program. It can start others, write files and read any. What a script may
say is listed in ``script_words``; the rest is refused before Gmsh sees it, and Gmsh is given
the script as it was understood here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from fenics_contact.mesh.geometry import script_words as words
from fenics_contact.mesh.geometry.script_words import (
    ScriptError,
    Token,
    statements_of,
    tokens_of,
    written,
)

# Gmsh takes numbers alone, writes each into 256 characters and copies the format to as many.
_FORMAT = re.compile(r"(?:[^%]|%%|%[-+ #0]*[0-9]{0,2}(?:\.[0-9]{0,2})?[eEfFgG]){0,200}")
_ASSIGNING = frozenset({"=", "+=", "-=", "*=", "/=", "++", "--"})
_NAMING = frozenset({"Macro", "Function", "Call", "For", "Exists", "GetForced"})
_SAYING = frozenset({"Printf", "Warning"})
_FORMATTING = frozenset({"Error", "Sprintf"})
_FOLDER_OF_SCRIPT = frozenset({"CurrentDirectory", "CurrentDir"})
# Words that may follow a name directly.
_AFTER_NAMES = frozenset({"In", "Using", "Knots", "Order", "Plane", "Field"})
_DEFINING = frozenset({"DefineConstant", "DefineNumber", "DefineString"})
_BEGINNING = words.KEYWORDS | words.OF_SHAPES | words.READS


class FileRead(NamedTuple):
    """A file that a script reads.

    Attributes:
        command: By which, such as ``Merge``.
        name: As it stands there, one character a byte.
        line: Of the command.
    """

    command: str
    name: str
    line: int


class GeometryScript:
    """A script that has been read, and understood as words and statements.

    Args:
        text: Its content.

    Raises:
        ScriptError: It is no script of Gmsh.
    """

    def __init__(self, text: str) -> None:
        self._statements = list(statements_of(list(tokens_of(text))))

    def defined(self) -> set[str]:
        """Names of the variables and macros that it defines."""
        return {name for statement in self._statements for name in _defined(statement)}

    def files(self) -> Iterator[FileRead]:
        """Files that it reads.

        Raises:
            ScriptError: A name is not given outright.
        """
        for statement in self._statements:
            for number, token in enumerate(statement):
                if token.kind == "word" and token.text in words.READS:
                    yield _file_read(statement, number)[0]

    def checked(self, defined: set[str], opened: Callable[[FileRead], str]) -> str:
        """The script for Gmsh, once it is known to do nothing but make a geometry and its mesh.

        Args:
            defined: Names that it or one of the others read with it defines.
            opened: The name of what Gmsh is to open in place of a file that the script reads.

        Raises:
            ScriptError: It does something else.
        """
        kept = []
        for statement in self._statements:
            if _Checker(statement, defined).is_of_use():
                kept.append(_with_files(statement, opened))
        return written(kept)


def _defined(statement: Sequence[Token]) -> Iterator[str]:
    """Names that a statement gives a value; or asks for, whether they have one."""
    if statement[0].text in ("DefineConstant", "UndefineConstant"):
        yield from _constants(statement)
        return
    for number, token in enumerate(statement):
        before = statement[number - 1].text if number else ""
        after = statement[number + 1].text if number + 1 < len(statement) else ""
        is_named = before in _NAMING or (before == "(" and statement[number - 2].text in _NAMING)
        is_given = number == 0 and _operator(statement) in _ASSIGNING
        if token.kind == "word" and (is_named or is_given or after in ("++", "--")):
            yield token.text


def _constants(statement: Sequence[Token]) -> Iterator[str]:
    depth = 0
    for number, token in enumerate(statement):
        before = statement[number - 1]
        if token.kind == "word" and depth == 1 and (before.text in "[," or before.kind != "sign"):
            yield token.text
        if token.kind == "word" and depth == 1 and before.text in "})":
            yield token.text  # Gmsh needs no comma between two
        depth += (token.text in "([{") - (token.text in ")]}")


def _operator(statement: Sequence[Token]) -> str:
    """The sign after the name, and its index, with which a statement begins."""
    depth = 0
    for token in statement[1:]:
        if token.kind == "sign" and token.text in "([{":
            depth += 1
        elif token.kind == "sign" and token.text in ")]}":
            depth -= 1
        elif depth == 0 and token.text != "~":
            return token.text if token.kind == "sign" else ""
    return ""


def _file_read(statement: Sequence[Token], number: int) -> tuple[FileRead, int]:
    """The file that a command reads, and where the expression of its name ends.

    ``"name"``, or ``StrCat(CurrentDirectory, "name")``, which is the same.
    """
    command = statement[number]
    rest = statement[number + 1 : number + 8]  # of long statements no copies
    brackets = [token.text for token in rest[:1]] == ["("]
    rest = rest[1:] if brackets else rest
    skipped = 0
    said = [token.text for token in rest[:4]]
    if len(said) == 4 and said[0] == "StrCat" and said[2] in _FOLDER_OF_SCRIPT and said[3] == ",":
        skipped, rest = 4, rest[4:]
    closing = 1 if skipped else 0
    if not rest or rest[0].kind != "text" or any(t.text not in ")]" for t in rest[1 : 1 + closing]):
        raise ScriptError(
            command.line,
            f"'{command.text}' must be followed by the name of a file in quotes, and nothing else",
            is_forbidden=True,
        )
    found = FileRead(command.text, rest[0].content, command.line)
    return found, number + 1 + brackets + skipped + 1 + closing


def _with_files(statement: Sequence[Token], opened: Callable[[FileRead], str]) -> list[Token]:
    """The statement with the names of files that Gmsh is to open."""
    found: list[Token] = []
    number = 0
    while number < len(statement):
        token = statement[number]
        found.append(token)
        number += 1
        if token.kind == "word" and token.text in words.READS:
            file, end = _file_read(statement, number - 1)
            if statement[number].text == "(":
                found.append(statement[number])
            found.append(Token("text", f'"{opened(file)}"', token.line))
            number = end
    return found


class _Checker:
    """Examines one statement.

    Args:
        statement: Its tokens, at least one.
        defined: Names of variables and macros.
    """

    def __init__(self, statement: Sequence[Token], defined: set[str]) -> None:
        self._tokens, self._defined = statement, defined
        self._first = statement[0].text
        self._operator = _operator(statement)
        self._is_view = self._first == "View" and self._kind(1) == "text"
        self._is_display = self._sets_display()
        defining = (n for n, token in enumerate(statement) if token.text in _DEFINING)
        self._constants_from = next(defining, len(statement))

    def is_of_use(self) -> bool:
        """Whether Gmsh is to have it: whether it is more than a message or an option of display.

        Raises:
            ScriptError: It is not allowed.
        """
        self._require_start()
        for number, token in enumerate(self._tokens):
            if token.kind == "word":
                self._require_word(number)
            elif token.kind == "text":
                self._require_text(number)
        if self._first in _SAYING or self._first == "Error":
            self._require_no_file()
        if self._first == "Field":
            self._require_field()
        return self._first not in _SAYING and not self._is_display

    def _text(self, number: int) -> str:
        return self._tokens[number].text if 0 <= number < len(self._tokens) else ""

    def _kind(self, number: int) -> str:
        return self._tokens[number].kind if 0 <= number < len(self._tokens) else ""

    def _refusal(self, number: int, why: str) -> ScriptError:
        token = self._tokens[min(number, len(self._tokens) - 1)]
        return ScriptError(token.line, f"'{token.text}' {why}", is_forbidden=True)

    def _require_start(self) -> None:
        """A statement is one of Gmsh's own, an assignment or a command of those allowed."""
        second, third = self._text(1), self._text(2)
        is_allowed = self._kind(0) == "word" and (
            self._first in _BEGINNING
            or self._is_view
            or self._is_display
            or (self._first in words.COMMANDS and self._kind(1) in ("number", "word"))
            or (self._first in words.OPTIONS and second == ".")
            or (self._first in words.FIELD_ROLES and second == "Field")
            or (self._first, second, third) == ("Background", "Mesh", "View")
            or self._operator in _ASSIGNING
        )
        if not is_allowed:
            raise self._refusal(0, "is no statement that makes a geometry or its mesh")

    def _require_word(self, number: int) -> None:
        """A word is one of those allowed, and stands where it means nothing else."""
        word, before = self._text(number), self._text(number - 1)
        if word in words.FORBIDDEN:
            raise self._refusal(number, "is not allowed")
        if before == "." and number > 0:
            return  # of an option, which is looked at before the point
        if word in words.KEYWORDS:
            self._require_keyword(number)
        elif self._text(number + 1) == ".":
            self._require_option(number)
        elif not (self._is_display or self._is_special(number)):
            if word not in self._defined and word not in words.NUMBERS and before != "Color":
                raise self._refusal(number, "is neither defined nor a word that makes a geometry")
            if not self._stands_alone(number):
                raise self._refusal(number, f"before {self._text(number + 1)} is not allowed")

    def _require_keyword(self, number: int) -> None:
        word = self._text(number)
        if word in words.STATEMENTS and number > 0:
            raise self._refusal(number, "must begin a statement")
        if word not in _FORMATTING:
            return
        if self._kind(number + 2) != "text" or self._text(number + 3) not in (",", ")", "]"):
            raise self._refusal(number, "must be followed by a text in quotes")
        if _FORMAT.fullmatch(self._tokens[number + 2].content) is None:
            raise self._refusal(number + 2, "is no format of numbers, such as %g or %6.3f")

    def _require_text(self, number: int) -> None:
        if self._is_display:
            raise self._refusal(number, "is a text, to which no option of display may be set")

    def _require_option(self, number: int) -> None:
        """Options: of geometry and meshes; of display only the size of the model may be read."""
        option = f"{self._text(number)}.{self._text(number + 2)}"
        if self._text(number) not in words.OPTIONS:
            if not (self._is_display or words.READABLE_OPTION.fullmatch(option)):
                raise self._refusal(number, "has no option of a geometry or a mesh")
        elif number == 0 and option not in words.TEXT_OPTIONS and not self._is_display:
            for value in range(3, len(self._tokens)):
                if self._kind(value) == "text" or self._text(value) in words.TEXT_FUNCTIONS:
                    raise self._refusal(value, f"is a text, to which {option} may not be set")

    def _sets_display(self) -> bool:
        """Whether the statement sets how Gmsh shows things."""
        if self._first in words.DISPLAY_OPTIONS and not self._is_view:
            return self._operator == "."
        return (
            self._first in words.OPTIONS
            and self._text(1) == "."
            and words.WITHOUT_EFFECT.fullmatch(self._text(2)) is not None
        )

    def _is_special(self, number: int) -> bool:
        """Whether a word that is none of Gmsh's keywords has a meaning where it stands."""
        word, before, after = (self._text(n) for n in (number, number - 1, number + 1))
        if number == 0 and self._operator not in _ASSIGNING:
            return word not in self._defined  # which has been found to be an allowed start
        return (
            (before, word) in words.PHRASES
            or (word in words.OF_SHAPES and after == "{")
            or (self._first == "Transfinite" and word in words.ARRANGEMENTS and after == ";")
            or (self._is_view and words.VIEW_ELEMENT.fullmatch(word) is not None and after == "(")
            or (word in words.READS and self._kind(number + 2) == "text")
            or (self._first == "Field" and before == "=")
            or self._is_attribute(number)
        )

    def _is_attribute(self, number: int) -> bool:
        """Whether it describes a constant: ``Name "…"``, after a comma within braces."""
        follows = self._text(number - 1) in (",", "[", "(")
        is_known = self._text(number) in words.ATTRIBUTES
        return number > self._constants_from and follows and is_known

    def _stands_alone(self, number: int) -> bool:
        """Whether no command can be meant: no value follows directly."""
        following, kind = self._text(number + 1), self._kind(number + 1)
        if kind in ("number", "text"):
            return False
        if kind == "word":
            is_next_constant = self._first == "DefineConstant" and following not in words.KEYWORDS
            return is_next_constant or following in _AFTER_NAMES
        return following not in ("(", "[") or self._kind(number + 2) != "text"

    def _require_no_file(self) -> None:
        """``Printf(…);`` and not ``Printf(…) > "file";``."""
        closed = _closing(self._tokens, 1)
        if self._text(1) != "(" or closed != len(self._tokens) - 2:
            raise self._refusal(0, "may not write to a file")

    def _require_field(self) -> None:
        """``Field[…] = Type;`` or ``Field[…].Option = …;`` of those that are known."""
        end = _closing(self._tokens, 1)
        sign, name, after = (self._text(end + n) for n in (1, 2, 3))
        if self._text(1) != "[" or sign not in ("=", "."):
            raise self._refusal(0, "must be followed by [number] = … or by [number].…")
        if sign == "=" and (name not in words.FIELDS or after != ";"):
            raise self._refusal(end + 2, "is no type of field that is computed")
        if sign == "." and (name not in words.FIELD_OPTIONS or after != "="):
            raise self._refusal(end + 2, "is no option of such a field")


def _closing(tokens: Sequence[Token], start: int) -> int:
    """Where the bracket that stands at ``start`` is closed."""
    depth = 0
    for number in range(start, len(tokens)):
        if tokens[number].kind == "sign":
            depth += (tokens[number].text in "([{") - (tokens[number].text in ")]}")
        if depth == 0:
            return number
    return len(tokens) - 1
