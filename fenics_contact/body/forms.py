"""Names of what forms are made of, by UFL and by dolfinx; docstrings give shapes and units."""

from __future__ import annotations

from typing import Any

from dolfinx.fem import Form as CompiledForm
from dolfinx.fem import Function, FunctionSpace
from ufl import Form, Measure
from ufl.core.expr import Expr

__all__ = ["CompiledForm", "Expr", "Form", "Function", "FunctionSpace", "Measure", "Rule"]

# Of a quadrature rule, as a measure's metadata.
Rule = dict[str, Any]
