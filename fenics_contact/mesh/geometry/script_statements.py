"""Gmsh's geometry scripts as words, numbers, texts and signs, and as statements of these.

They are written again from them: without comments, with a blank between any two, and a statement
a line. What Gmsh reads is then what was examined: Gmsh itself skips conditionals and repeats loops
by characters and by lines, so that comments and texts could hide statements from an examination.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from fenics_contact.mesh.geometry.allowed_words import BRACED, OF_SHAPES

_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r\n\f]+|//[^\n]*|/\*.*?\*/)
    |(?P<word>[A-Za-z_][A-Za-z0-9_]*)
    |(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)
    |(?P<text>"[^"\x00-\x08\x0a-\x1f\x7f]*"|'[^'\x00-\x08\x0a-\x1f\x7f]*')
    |(?P<sign>\.\.\.|\+\+|--|[-+*/=!<>]=|<<|>>|&&|\|\||::|[-+*%^=<>!&|~\#?:;,.(){}\[\]]
        |/(?!\*))""",
    re.VERBOSE | re.DOTALL,
)
_OPENING = {"(": ")", "[": "]", "{": "}"}
_CLOSING = frozenset(_OPENING.values())
# Gmsh would take these for the end of what it skips, and go on with the rest of the word.
_MISREAD = re.compile(r"(?:EndIf|EndFor|ElseIf|Else|Return)(?![A-Za-z_])")
_FLOW = frozenset({"EndIf", "EndFor", "ElseIf", "Else", "Return"})
_MOST = 2**21  # words and signs of a script: half a minute, and 250 MB
_LONGEST = 1000  # of a text; Gmsh takes what is beyond 1023 characters for statements
# Gmsh looks for the end of what it skips by characters, and may pass over five of them.
_BEFORE_TEXT = 8 * " "


class ScriptError(Exception):
    """Raised with what is wrong with a script.

    Attributes:
        line: Where, counted from 1.
        is_forbidden: Whether Gmsh would do it, but a scene's geometry may not.
    """

    def __init__(self, line: int, message: str, is_forbidden: bool = False) -> None:
        super().__init__(message)
        self.line, self.is_forbidden = line, is_forbidden


class Token(NamedTuple):
    """A word, number, text (with its quotes) or sign.

    Attributes:
        kind: Which of these: ``word``, ``number``, ``text``, ``sign``.
        text: As it stands in the script.
        line: Counted from 1.
    """

    kind: str
    text: str
    line: int

    @property
    def content(self) -> str:
        """Content of a text between its quotes."""
        return self.text[1:-1]


def tokens_of(text: str) -> Iterator[Token]:
    """The words, numbers, texts and signs of a script, without blanks and comments.

    Raises:
        ScriptError: There is something else, or too much.
    """
    position, line, number = 0, 1, 0
    while position < len(text):
        found = _TOKEN.match(text, position)
        if found is None:
            raise ScriptError(line, _not_read(text, position))
        kind, word = str(found.lastgroup), found[0]
        if kind != "blank":
            if len(word) > _LONGEST:
                raise ScriptError(line, f"has a {kind} longer than {_LONGEST} characters")
            if kind == "word" and word not in _FLOW and _MISREAD.search(word):
                raise ScriptError(line, f"the name '{word}' ends as a word of Gmsh's; change it")
            number += 1
            if number > _MOST:
                raise ScriptError(line, f"has more than {_MOST} words, numbers and signs")
            yield Token(kind, word, line)
        line += word.count("\n")
        position = found.end()


def _not_read(text: str, position: int) -> str:
    if text[position] in "\"'":
        return "has a text with a control character, or that does not end on its line"
    if text.startswith("/*", position):
        return "has a comment that does not end"
    return f"has the character {text[position]!r}, which is no part of a geometry"


def statements_of(tokens: Sequence[Token]) -> Iterator[list[Token]]:
    """The statements of a script: up to a semicolon or the last brace, or the head of a block.

    Raises:
        ScriptError: One does not end, or Gmsh would not come back to its start.
    """
    start = 0
    while start < len(tokens):
        end = _end(tokens, start)
        statement = list(tokens[start:end])
        is_followed = end < len(tokens) and tokens[end].line == statement[-1].line
        if is_followed and _is_come_back_to(statement):
            word = statement[0].text
            raise ScriptError(tokens[end].line, f"must begin a new line after {word} …")
        yield statement
        start = end


def _end(tokens: Sequence[Token], start: int) -> int:
    """One past the last token of the statement that begins at ``start``."""
    first = tokens[start].text
    if first in ("Else", "EndIf", "EndFor", "Return"):
        return start + 1
    if first in ("Macro", "Function"):
        return min(start + 2, len(tokens))
    is_head = first in ("If", "ElseIf", "For")
    is_braced = first in BRACED or first in OF_SHAPES
    closing: list[str] = []
    for number in range(start, len(tokens)):
        token = tokens[number]
        sign = token.text if token.kind == "sign" else ""
        if sign in _OPENING:
            closing.append(_OPENING[sign])
        elif sign in _CLOSING:
            if not closing or closing.pop() != sign:
                raise ScriptError(token.line, f"has a '{sign}' too many")
            if closing:
                continue
            if is_head or (is_braced and sign == "}" and _is_last(tokens, number, first)):
                return number + 1
        elif sign == ";" and not closing:
            return number + 1
        elif sign == "=" and not closing:
            is_braced = False
    raise ScriptError(tokens[start].line, f"the statement '{first}' does not end")


def _is_last(tokens: Sequence[Token], number: int, first: str) -> bool:
    """Whether a statement without a semicolon ends with this brace."""
    if number + 1 == len(tokens):
        return True
    following = tokens[number + 1]
    if following.kind != "word":
        return following.kind == "text"
    if following.text == "Using":
        return first != "Extrude"
    return not (first == "Intersect" and following.text == "Surface")


def _is_come_back_to(statement: Sequence[Token]) -> bool:
    """Whether Gmsh goes on at the line after it, in a loop or after a macro."""
    return statement[0].text in ("For", "Macro", "Function", "Call")


def written(statements: Sequence[Sequence[Token]]) -> str:
    """A script of these statements, each begun on its line where there is room."""
    lines: list[str] = []
    for statement in statements:
        parts = [_BEFORE_TEXT + t.text if t.kind == "text" else t.text for t in statement]
        line = " ".join(parts)
        missing = statement[0].line - 1 - len(lines)
        if missing >= 0:
            lines += [""] * missing + [line]
        else:
            lines[-1] += f" {line}"
    return "\n".join(lines) + "\n"
