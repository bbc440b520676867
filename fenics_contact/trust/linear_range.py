"""How far a solution is from what linear theory holds for: strains, rotations, indentations, wear.

Beyond, results are off by about as much as these are not small. Worn surfaces count by how deep
they are over how wide: the gap is one along the normals of the surface as it was. Where the body is
turned inside out, or passes through what holds it, there is no result.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.comparison import nearer_to_failing
from fenics_contact.trust.strain_zones import CellPoints, Zone, Zones

# Share of a zone's volume that is left out of strains and rotations. A surface of length L in the
# plane has a zone of 2.6 L², so that what is within .09 L of both its ends is left out: under a
# punch the pressure E* d/(π √(a² − x²)) is there 1.75 times that of the middle.
LEFT_OUT = 1e-2
# Share of it that may be turned inside out, for strains without bound reach 1: in this pressure
# within (d/a)²/20 of the edge, over a. A layer under a contact has more.
TURNED = 1e-3
# Share of the deepest wear from which a point counts as worn: width has no meaning at less.
_WORN = 0.01


def worn_share(contact: ContactSurface, state: ContactState) -> float:
    """Deepest wear over half the width that is worn, about the slope of what is left; collective.

    Args:
        contact: Any.
        state: At the end of a load step.
    """
    if not contact.wear.wears:
        return 0.0
    comm, depth = contact.spaces.comm, state.own["worn_depth"]
    deepest = largest(comm, depth)
    if deepest == 0:
        return 0.0
    worn = contact.trace.coordinates[depth >= _WORN * deepest].T
    width = np.linalg.norm([largest(comm, x) - smallest(comm, x) for x in worn])
    return deepest / (0.5 * max(float(width), contact.facet_size))


# Points that slid by less, over the size, are where the gap was measured.
_SLID = 0.01


class IndentationSize:
    """The indentation of one obstacle over size.

    The size is the smaller of the obstacle's radius (half its width if it is a punch) and of
    the extent, along the obstacle's way, of the part of the body that it presses. The indentation
    counts from where the obstacle first touches the undeformed surface, less how far that part
    is displaced as a whole: by its supports, or, where none holds it along an axis, by the mean of
    its displacement; a half-space is not.

    Attributes:
        size: (length).
        label: Of the contact.
        kinematics: Of the contact.

    Args:
        problem: The model; collective.
        contact: One with a rigid obstacle that has a direction.
        points: Those inside the cells.
    """

    def __init__(self, problem: Problem, contact: ContactSurface, points: CellPoints) -> None:
        self._problem = problem
        self.label = contact.label
        spaces, kinematics = problem.spaces, contact.kinematics
        self.kinematics = kinematics
        pressed = np.zeros(spaces.parts.count)
        pressed[spaces.parts.of_node[contact.nodes]] = 1.0
        reached = total(problem.comm, pressed) > 0
        self._nodes = np.flatnonzero(reached[spaces.parts.of_node[: spaces.owned_nodes]])
        first = spaces.displacement_space.dofmap.list[points.cells, 0]
        self._points = np.flatnonzero(reached[spaces.parts.of_node[first]])
        self._volumes = points.volumes[self._points]
        along = spaces.coordinates[self._nodes, : spaces.components] @ kinematics.direction
        extent = largest(problem.comm, along) + largest(problem.comm, -along)
        self.size = min(extent, _width(contact))

    def share(self, displacement: Array, inside: Array) -> float:
        """The indentation over the size, ≥ 0; collective.

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
            inside: At the points inside its cells, (points, components) (length).
        """
        kinematics = self.kinematics
        ahead = kinematics.reached & (kinematics.facing > 0)
        # Where they overlap as drawn, as a tight shaft does, sides of it tell no way.
        gap = kinematics.gap[ahead]
        gaps = np.where(gap > 0, gap / kinematics.facing[ahead], gap)
        way = self._carried_along(displacement, inside) @ kinematics.direction
        went = kinematics.indentation - smallest(self._problem.comm, gaps) - way
        return max(float(went), 0.0) / self.size

    def overlap(self) -> float:
        """How deep a point that slid is inside the obstacle, over the size; collective.

        The gap is that of linear kinematics elsewhere: measured where the points first were.
        """
        depths = self.kinematics.depths_of_slid(_SLID * self.size)
        return max(largest(self._problem.comm, depths), 0.0) / self.size

    def _carried_along(self, displacement: Array, inside: Array) -> Array:
        """Displacement of the part as a whole, (components,) (length); collective."""
        if self._problem.far_field is not None:
            return np.zeros(inside.shape[1])
        held = ~self._problem.free[self._nodes]
        moved = displacement[self._nodes]
        of_points = self._volumes @ inside[self._points]
        sums = np.stack([(moved * held).sum(axis=0), held.sum(axis=0), of_points])
        of_held, count, of_all = total(self._problem.comm, sums)
        volume = total(self._problem.comm, self._volumes.sum())
        mean = np.where(count > 0, of_held / np.maximum(count, 1.0), of_all / volume)
        return np.asarray(mean)


def _width(contact: ContactSurface) -> float:
    """Return the radius or half width of an obstacle; infinite where it has none (length)."""
    obstacle = contact.contact.obstacle
    if obstacle is None or obstacle.radius is None:
        return np.inf
    if obstacle.inner_radius is not None:
        return 0.5 * (obstacle.radius - obstacle.inner_radius)
    return float(obstacle.radius)


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
            obstacle is; the ``obstacle_rotation`` (radian); and how deep ``wear`` is over half the
            width that is worn. What a model has none of is left out.
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
        turning = [one for one in self._problem.contacts if one.kinematics.turning.axis.any()]
        if turning:
            rows["obstacle_rotation"] = _worst(
                [{"value": abs(one.kinematics.angle), "on": one.label} for one in turning]
            )
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


_LARGEST = int(np.float64(np.inf).view(np.int64))


def exceeded(comm: MPI.Comm, zone: Zone, values: Array) -> float:
    """The largest value that more than the share of a zone exceeds or has; collective.

    Args:
        comm: Communicator.
        zone: On whose points.
        values: At all cell points of this rank, ≥ 0, (points,).

    Returns:
        It, the same on any number of ranks; infinite where values are not numbers.
    """
    left_out = LEFT_OUT * zone.volume
    found = np.nan_to_num(values[zone.points], nan=np.inf, posinf=np.inf)
    order = np.argsort(found)
    ordered = found[order]
    # Of what begins at each place: the volume up to the end.
    volumes = np.append(np.cumsum(zone.volumes[order][::-1])[::-1], 0.0)
    low, high = 0, _LARGEST  # as integers, floating-point numbers >= 0 have the same order
    while low < high:
        middle = (low + high + 1) // 2
        at_least = volumes[np.searchsorted(ordered, np.int64(middle).view(np.float64))]
        if total(comm, at_least) > left_out:
            low = middle
        else:
            high = middle - 1
    return float(np.int64(low).view(np.float64))


def share(comm: MPI.Comm, zone: Zone, flags: Flags) -> float:
    """Return the share of a zone's volume at points with a flag; collective."""
    return float(total(comm, zone.volumes[flags[zone.points]].sum())) / zone.volume
