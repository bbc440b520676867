"""Laws in UFL: formulas of a scene, and numbers at the contact points from what forms are made of.

A law says its energy density once, in UFL. Its forms are integrals of it and of its slopes; what
results say of pressure, traction and energy at the points are numbers of the same expressions,
evaluated here for all points of a rank at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import basix.ufl
import numpy as np
import ufl
from ufl import classes
from ufl.algorithms import expand_indices
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array
from fenics_contact.scene.laws.formula import Formula

# A domain for variables that are numbers. UFL keeps what it has differentiated, so each density is
# derived only once; and with the domain of a mesh it would keep that mesh and its communicators.
_NOWHERE = ufl.Mesh(basix.ufl.element("Lagrange", "interval", 1, shape=(1,)))
_OPERATORS: dict[type, Callable[..., Array]] = {
    classes.Sum: np.add,
    classes.Product: np.multiply,
    classes.Division: np.divide,
    classes.Power: np.power,
    classes.Sqrt: np.sqrt,
    classes.Exp: np.exp,
    classes.Ln: np.log,
    classes.Abs: np.abs,
    classes.MaxValue: np.maximum,
    classes.MinValue: np.minimum,
    classes.Conditional: np.where,
    classes.GT: np.greater,
    classes.GE: np.greater_equal,
    classes.LT: np.less,
    classes.LE: np.less_equal,
    classes.EQ: np.equal,
}


@lru_cache
def point_density(density: Callable[..., Expr], **sizes: int) -> PointDensity:
    """The point density of a law, derived once for all runs.

    Args:
        density: As of ``PointDensity``.
        sizes: Likewise.
    """
    return PointDensity(density, sizes)


class PointDensity:
    """An energy density as numbers at points, with its slopes and curvatures.

    Args:
        density: Takes variables by name, and returns the density in UFL (energy/area).
        sizes: Variables by name: 0 for a scalar, else the number of components.
    """

    def __init__(self, density: Callable[..., Expr], sizes: Mapping[str, int]) -> None:
        self._scalars = {
            name: [ufl.variable(ufl.Constant(_NOWHERE)) for _ in range(max(size, 1))]
            for name, size in sizes.items()
        }
        given = {
            name: ufl.as_vector(self._scalars[name]) if size else self._scalars[name][0]
            for name, size in sizes.items()
        }
        self._density = density(**given)
        self._programs: dict[tuple[str, ...], _Program] = {}

    def value(self, **values: Array | float) -> Array:
        """The density (energy/area).

        Args:
            values: Of all variables at the points, (points,) or (points, components).
        """
        return self._numbers((), values)[..., 0]

    def slope(self, of: str, **values: Array | float) -> Array:
        """Slope in a variable: (points,) of a scalar, (points, components) of a vector."""
        found = self._numbers((of,), values)
        return found if np.ndim(values[of]) == 2 else found[..., 0]

    def curvature(self, of: str, **values: Array | float) -> Array:
        """Curvature of the density in a scalar variable, (points,)."""
        return self._numbers((of, of), values)[..., 0]

    def curvatures(self, of: str, then: str, **values: Array | float) -> Array:
        """Curvatures of the density in the components of two vector variables.

        Returns:
            (points, components of the first, components of the second).
        """
        found = self._numbers((of, then), values)
        sizes = [max(len(self._scalars[name]), 1) for name in (of, then)]
        return found.reshape(len(found), *sizes)

    def vanishes(self, *along: str) -> bool:
        """Whether a derivative is 0 whatever the variables are.

        Args:
            along: By which variables, one after the other.
        """
        return self._program(along).vanishes

    def _program(self, along: tuple[str, ...]) -> _Program:
        if along not in self._programs:
            scalars = [scalar for own in self._scalars.values() for scalar in own]
            parts = [_lowered(part) for part in self._taken(along)]
            self._programs[along] = _Program(scalars, parts)
        return self._programs[along]

    def _numbers(self, along: tuple[str, ...], values: Mapping[str, Array | float]) -> Array:
        program = self._program(along)
        if program.vanishes:
            counts = [len(np.atleast_1d(value)) for value in values.values()]
            return np.zeros((max(counts, default=1), program.count))
        given: list[Array] = []
        for name in self._scalars:
            value = np.asarray(values[name], dtype=np.float64)
            given += list(value.T) if value.ndim == 2 else [value]
        count = max((len(value) for value in given if value.ndim), default=1)
        return program.run(given, count)

    def _taken(self, along: tuple[str, ...]) -> list[Expr]:
        found = [self._density]
        for name in along:
            found = [ufl.diff(part, scalar) for part in found for scalar in self._scalars[name]]
        return found


def _lowered(expression: Expr) -> Expr:
    """Without gradients and indices."""
    return expand_indices(apply_derivatives(apply_algebra_lowering(expression)))


class _Program:
    """Scalar expressions as a function of Python that works out their numbers.

    Written out once: to look expressions up takes UFL longer than to work out their numbers. Each
    line is one operation on what stands in lines before it.

    Args:
        variables: Scalar variables whose numbers are given.
        expressions: Without gradients and indices.

    Attributes:
        count: Number of expressions.
        vanishes: Whether all of them are 0 whatever the variables are.
    """

    def __init__(self, variables: Sequence[Expr], expressions: Sequence[Expr]) -> None:
        self._names = {one.ufl_operands[0]: f"x{place}" for place, one in enumerate(variables)}
        given = ", ".join(self._names.values())
        self._known: dict[str, Any] = {}
        self._lines: list[str] = []
        found = [self._name(expression) for expression in expressions]
        self.vanishes = all(self._known.get(name) == 0.0 for name in found)
        self.count = len(found)
        set_all = [f"found[:, {column}] = {name}" for column, name in enumerate(found)]
        body = "\n    ".join([*self._lines, *set_all])
        # Of our own names and numpy's operations: nothing in it comes from a scene.
        exec(f"def work_out(found, {given}):\n    {body}", self._known)
        self._work_out: Callable[..., None] = self._known["work_out"]

    def _name(self, expression: Expr) -> str:
        """Name of an expression in the program; adds the lines that work it out."""
        if isinstance(expression, classes.Variable):
            return self._name(expression.ufl_operands[0])
        if expression not in self._names:
            is_number = isinstance(expression, classes.ScalarValue | classes.Zero)
            operands = [] if is_number else [self._name(one) for one in expression.ufl_operands]
            name = self._names[expression] = f"y{len(self._names)}"
            if is_number:
                self._known[name] = float(expression)
            else:
                operator = _OPERATORS[type(expression)]
                self._known[operator.__name__] = operator
                self._lines.append(f"{name} = {operator.__name__}({', '.join(operands)})")
        return self._names[expression]

    def run(self, given: Sequence[Array], count: int) -> Array:
        """Numbers of the expressions, (points, expressions).

        Args:
            given: Of the variables, (points,) or one for all, ().
            count: Number of points.
        """
        found = np.empty((count, self.count))
        with np.errstate(all="ignore"):  # both sides of a condition are evaluated
            self._work_out(found, *given)
        return found


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
