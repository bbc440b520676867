"""Formulas of a scene in UFL, for the laws that have them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.scene.laws.formula import Formula

_IN_UFL: Mapping[str, Callable[..., Expr]] = {
    "sqrt": ufl.sqrt,
    "exp": ufl.exp,
    "ln": ufl.ln,
    "min": ufl.min_value,
    "max": ufl.max_value,
}


@lru_cache
def in_ufl(text: str, names: tuple[str, ...]) -> Callable[..., Expr]:
    """A formula as a function of its variables, by name; the same one for the same text.

    Args:
        text: Of the formula.
        names: Of the variables that it may have.
    """
    formula = Formula(text, names)

    def function(**values: Expr) -> Expr:
        return formula.of(values, _IN_UFL)

    return function
