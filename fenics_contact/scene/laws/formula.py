"""Formulas that a scene gives as text: parsed, and never run as Python."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from fenics_contact.common.wording import question

_OPERATIONS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: lambda a, b: a**b,
}
#: The functions that a formula may use, on numbers, and how many arguments each has.
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "sqrt": np.sqrt,
    "exp": np.exp,
    "ln": np.log,
    "min": np.minimum,
    "max": np.maximum,
}
_ARGUMENTS = {"sqrt": 1, "exp": 1, "ln": 1, "min": 2, "max": 2}
# Longer ones would be read for minutes, or exceed the depth that Python's parser allows.
_LONGEST, _DEEPEST = 1000, 50


class Formula:
    """A formula of named values: + - * / ^, brackets, and the functions of ``FUNCTIONS``.

    Args:
        text: Such as ``c * d^m``; ``**`` is the same as ``^``.
        names: What its variables may be called.

    Raises:
        ValueError: It is no formula of these; in words, for the key that has it.

    >>> Formula("c * d^2 + max(d, 0)", ["c", "d"]).of({"c": 3.0, "d": 2.0})
    np.float64(14.0)
    """

    def __init__(self, text: str, names: Collection[str]) -> None:
        self.text = text
        self._tree = _tree(text)
        _check(self._tree, text, tuple(names))

    def of(
        self, values: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]] = FUNCTIONS
    ) -> Any:
        """The formula of values: of numbers, of arrays, or of anything that can be calculated with.

        Args:
            values: Of its variables, by name.
            functions: What is meant by the names of ``FUNCTIONS``, such as UFL's.
        """
        return _of(self._tree, values, functions)

    def number(self, values: Mapping[str, float]) -> float:
        """The formula of numbers.

        Args:
            values: Of its variables, by name.

        Raises:
            ValueError: There it is no finite real number.
        """
        try:
            with np.errstate(all="ignore"):
                found = self.of(values)
        except ArithmeticError:
            found = np.nan
        if isinstance(found, complex) or not np.isfinite(found):
            there = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            raise ValueError(f"'{self.text}' is no finite number at {there}")
        return float(found)

    @property
    def used(self) -> set[str]:
        """Names of the variables that stand in it."""
        calls = {id(node.func) for node in ast.walk(self._tree) if isinstance(node, ast.Call)}
        names = (node for node in ast.walk(self._tree) if isinstance(node, ast.Name))
        return {node.id for node in names if id(node) not in calls}


@lru_cache
def _tree(text: str) -> ast.expr:
    if len(text) > _LONGEST:
        raise ValueError(f"the formula has {len(text)} characters, at most {_LONGEST} are read")
    try:
        return ast.parse(text.strip().replace("^", "**"), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(f"'{text}' is no formula, such as c * d^1.5") from None


def _check(node: ast.AST, text: str, names: tuple[str, ...], depth: int = 0) -> None:
    """Refuse what is not in the language of formulas."""
    if depth > _DEEPEST:
        raise ValueError(f"'{text}' is nested too deep, at most {_DEEPEST} levels are read")
    parts: list[ast.expr] = []
    match node:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            return
        case ast.Name(id=name):
            if name not in names:
                hint = question(name, names)
                known = ", ".join(names)
                raise ValueError(f"'{text}': '{name}' is not known{hint}; known here: {known}")
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=one):
            parts = [one]
        case ast.BinOp(left=left, op=operation, right=right) if type(operation) in _OPERATIONS:
            parts = [left, right]
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]):
            if name not in FUNCTIONS:
                known = ", ".join(FUNCTIONS)
                hint = question(name, FUNCTIONS)
                raise ValueError(f"'{text}': no function '{name}'{hint}; there are: {known}")
            if len(given) != _ARGUMENTS[name]:
                raise ValueError(f"'{text}': {name} takes {_ARGUMENTS[name]} values in brackets")
            parts = list(given)
        case _:
            what = "+ - * / ^, numbers, names and the functions " + ", ".join(FUNCTIONS)
            raise ValueError(f"'{text}': a formula may have {what}, and nothing else")
    for part in parts:
        _check(part, text, names, depth + 1)


def _of(node: ast.expr, values: Mapping[str, Any], functions: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=number):
            return float(number)  # type: ignore[arg-type]
        case ast.Name(id=name):
            return values[name]
        case ast.UnaryOp(op=sign, operand=one):
            found = _of(one, values, functions)
            return 0 - found if isinstance(sign, ast.USub) else found
        case ast.BinOp(left=left, op=operation, right=right):
            sides = (_of(one, values, functions) for one in (left, right))
            return _OPERATIONS[type(operation)](*sides)
        case ast.Call(func=ast.Name(id=name), args=given):
            return functions[name](*(_of(one, values, functions) for one in given))
    raise AssertionError(f"{ast.dump(node)} was checked before")
