"""The kinds of scalar unknowns, each with what finds those of a problem: a line for a new one."""

from __future__ import annotations

from collections.abc import Callable

from fenics_contact.problem.scalars.indentation import indentations
from fenics_contact.problem.scalars.resultant import resultants
from fenics_contact.problem.scalars.scalar import BodyScalar, KnownProblem, ScalarUnknown
from fenics_contact.problem.scalars.shortening import shortenings

Kind = Callable[[KnownProblem], list[ScalarUnknown]]

# Each returns the scalar unknowns of a kind of a problem whose contacts and far field are known.
_KINDS: list[Kind] = [indentations, resultants, shortenings]


def register(kind: Kind) -> None:
    """Make a kind known.

    Args:
        kind: Returns the scalar unknowns of the kind of a problem; collective.
    """
    _KINDS.append(kind)


def unregister(kind: Kind) -> None:
    """Take out a kind that was registered."""
    _KINDS.remove(kind)


def scalars_of(problem: KnownProblem) -> list[ScalarUnknown]:
    """All scalar unknowns of a problem, those of the body last; collective."""
    found = [scalar for kind in _KINDS for scalar in kind(problem)]
    return sorted(found, key=lambda scalar: isinstance(scalar, BodyScalar))
