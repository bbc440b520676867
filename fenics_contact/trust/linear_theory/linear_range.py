"""How far a solution is from what linear theory holds for: small strains, rotations, indentations.

Beyond, results are off by about as much as these. Where the body is turned inside out, or passes
through what holds it, there is no result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.checks.comparison import nearer_to_failing
from fenics_contact.trust.linear_theory.displacement_gradient import CellPoints
from fenics_contact.trust.linear_theory.indentation_sizes import IndentationSize
from fenics_contact.trust.linear_theory.worn_width import worn_share
from fenics_contact.trust.linear_theory.zones import TURNED, Zone, Zones, exceeded, share

# What is compared by the check: of each, name and limit. Depths that linear kinematics leaves in
# an obstacle are of second order: .005 of a sphere's radius for a contact of .35 of it.
_LIMITS = {"turned": TURNED, "beyond": TURNED, "overlap": 0.1}
# A zone is named before another whose value is no larger but by round-off.
_ROUND_OFF = 1e-9


class LinearRange:
    """Strains, rotations and indentations of a model's load steps.

    Args:
        problem: The model; collective.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._points = CellPoints(problem.spaces, problem.elastic.law)
        self._zones = Zones(problem, self._points)
        self._obstacles = [
            IndentationSize(problem, contact, self._points)
            for contact in problem.contacts
            if contact.has_penalty
            and not contact.kinematics.faces_body
            and contact.kinematics.direction.any()
        ]
        self._sides = [self._side(axis, at) for axis, at in problem.discrete.held.flat_sides]

    def of(self, solution: Solution) -> dict[str, dict[str, Any]]:
        """Return the sizes of a load step, in whose state the model is; collective.

        Returns:
            What → its largest value, and the ``part`` or the surface (``on``) that has it: the
            largest principal ``strain`` and ``rotation`` (radian) that more than a share of .01
            of a zone has; the ``indentation`` over size; what share of a zone is ``turned`` inside
            out or ``beyond`` a plane of symmetry; over size how deep an ``overlap`` with an
            obstacle is; and how deep ``wear`` is over half the width that is worn. What a model
            has none of is left out.
        """
        found = self._points.deformation(solution.displacement)
        zones, comm = self._zones.at(solution.states), self._problem.comm
        beyond = np.zeros(len(found.turned), dtype=bool)
        for axis, at, inwards in self._sides:
            place = self._points.positions[:, axis] + found.displacement[:, axis]
            beyond |= ~(inwards * (place - at) > 0)

        def worst(value_in: Callable[[Zone], float]) -> dict[str, Any]:
            return _worst(
                [
                    {"value": value_in(zone), "on" if zone.is_near else "part": zone.name}
                    for zone in zones
                ]
            )

        rows = {
            "strain": worst(lambda zone: exceeded(comm, zone, found.strain)),
            "rotation": worst(lambda zone: exceeded(comm, zone, found.rotation)),
            "turned": worst(lambda zone: share(comm, zone, found.turned)),
        }
        if self._sides:
            rows["beyond"] = worst(lambda zone: share(comm, zone, beyond))
        if any(contact.wear.wears for contact in self._problem.contacts):
            rows["wear"] = _worst(
                [
                    {"value": worn_share(contact, state), "on": contact.label}
                    for contact, state in zip(self._problem.contacts, solution.states, strict=True)
                ]
            )
        if self._obstacles:
            rows["overlap"] = self._of_obstacles(lambda obstacle: obstacle.overlap())
        if self._obstacles and self._problem.has_datum:
            inside, nodal = found.displacement, solution.displacement
            rows["indentation"] = self._of_obstacles(lambda o: o.share(nodal, inside))
        return rows

    def _of_obstacles(self, value: Callable[[IndentationSize], float]) -> dict[str, Any]:
        return _worst([{"value": value(o), "on": o.label} for o in self._obstacles])

    def _side(self, axis: int, at: float) -> tuple[int, float, float]:
        """A plane of symmetry, with the sign of the side on which the body is; collective."""
        offsets = self._points.positions[:, axis] - at
        comm = self._problem.comm
        return axis, at, 1.0 if largest(comm, offsets) > largest(comm, -offsets) else -1.0


def _worst(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The first of the rows that have the largest value."""
    most = max(row["value"] for row in rows)
    return next(row for row in rows if row["value"] >= most * (1 - _ROUND_OFF))


def worst_step(steps: Sequence[Mapping[str, Any]], what: str) -> dict[str, Any] | None:
    """Return the row of the load step, as in ``result.json``, where something is largest.

    Args:
        steps: Those of a run.
        what: One of those of ``LinearRange.of``.

    Returns:
        Its value, where, and ``time``; None where no step has it.
    """
    rows = [
        {**step["linear_range"][what], "time": step["load_factor"]}
        for step in steps
        if what in step.get("linear_range", {})
    ]
    return max(rows, key=lambda row: float(row["value"])) if rows else None


def linear_range(steps: Sequence[Mapping[str, Any]]) -> Check | None:
    """Nothing is turned inside out or passes through what holds it, in any load step.

    Args:
        steps: Of a run, as in ``result.json``; those of files before this check was made have none.
    """
    worst: Check | None = None
    for what, limit in _LIMITS.items():
        row = worst_step(steps, what)
        if row is not None:
            contact, part = row.get("on", ""), row.get("part", "")
            worst = nearer_to_failing(worst, Check(row["value"], limit, contact, (), what, part))
    return worst
