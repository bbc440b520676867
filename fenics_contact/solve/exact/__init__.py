"""Signorini's and Coulomb's laws solved exactly, without ε and ε₁, on a condensed body.

``LocalProblem`` says what is solved, ``solve`` solves it, and an ``ExactAnswer`` is what it finds;
``Linearisation`` has its derivatives, and ``several`` looks for other answers. All is NumPy and
SciPy on arrays, on one rank. It is the limit ε → 0, ε₁ → 0 of the paper's (3.4).
"""

from fenics_contact.solve.exact.answer import ExactAnswer
from fenics_contact.solve.exact.derivatives import ExactGradient, Linearisation
from fenics_contact.solve.exact.local_problem import LocalProblem, PointLaws
from fenics_contact.solve.exact.solver import solve

__all__ = [
    "ExactAnswer",
    "ExactGradient",
    "Linearisation",
    "LocalProblem",
    "PointLaws",
    "solve",
]
