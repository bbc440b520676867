"""Solutions with other nodal values of the body than those that were found."""

from __future__ import annotations

import dataclasses

from fenics_contact.common.arrays import Array
from fenics_contact.solve.systems.solution import Solution


def with_body(solution: Solution, **changes: Array) -> Solution:
    """The same with other nodal values, by the names of ``BodyAnswer``; collective."""
    body = dataclasses.replace(solution.find_body(), **changes)
    return dataclasses.replace(solution, find_body=lambda: body)
