"""Contacts that a mesh is too coarse for, and obstacles that it would not see at all.

Whether enough points lie across what touches to tell how large it is, and how pressed: about three
are needed in the narrow direction, as then one of them has points that touch all around it. Where
the edge of contact lies inside the surface, and no such point is near, the pressure that comes out
is that of the mesh. A contact up to all borders of its surface has no such edge.

An obstacle that meets the surface between two of its points comes nearer by some distance before it
meets a point: it is hidden where it is not driven as far. Under a force that is about the force
over E*, per unit thickness, or over E* and the spacing of the points. This is told before anything
is solved.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, smallest, total
from fenics_contact.contact.against_obstacle import ObstacleKinematics
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, STICK, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_WORK
from fenics_contact.scene.loading.load_paths import knots
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.convergence.unseen import LARGEST_UNSEEN, governed_by_depth, unseen

# Share of the normal force that too few points may carry.
_LARGEST_SHARE = 0.1
# What cells become there, over what they are: of one point across three.
_FINER = 0.3


@dataclass(frozen=True, eq=False)
class ThinContact:
    """Where fewer than three points lie across what touches.

    Attributes:
        place: Where most of its force acts, (3,) (length).
        finer: Rows of x, y, z and the size that cells there are to have, of this rank (length).
    """

    place: Array
    finer: Array


def thin_contact(contact: ContactSurface, state: ContactState) -> ThinContact | None:
    """Return how thin a contact is; None where its points tell what touches; collective.

    Args:
        contact: The contact.
        state: What happens at its points.
    """
    if not contact.is_one_sided:
        return None
    trace, pieces = contact.trace, contact.trace.pieces
    nodes = slice(0, len(contact.nodes))
    closed = state.status[nodes] != OPEN
    thin = closed & ~_near_surrounded(contact, closed)
    forces = (trace.weights * state.contact_pressure)[nodes] * contact.owned_nodes
    in_thin, whole = total(trace.spaces.comm, np.array([forces[thin].sum(), forces.sum()]))
    if whole <= 0 or in_thin <= _LARGEST_SHARE * whole:
        return None
    rows = np.column_stack([forces, trace.coordinates[nodes]])[thin & contact.owned_nodes]
    rows = gather_rows(trace.spaces.comm, rows[np.lexsort(rows.T[::-1])[-1:]])
    place = rows[np.lexsort(rows.T[::-1])[-1], 1:]
    dimension = trace.spaces.components
    sides = (pieces.areas * (1 if dimension == 2 else 2)) ** (1 / (dimension - 1))
    rows = np.column_stack([pieces.corners.mean(axis=1), _FINER * sides * trace.spaces.degree])
    return ThinContact(place, rows[thin[pieces.points].any(axis=1)])


def _near_surrounded(contact: ContactSurface, closed: Flags) -> Flags:
    """Return for each nodal point whether it, or a neighbour, touches all around."""
    trace, pieces = contact.trace, contact.trace.pieces
    surface = trace.surface

    def beside(pieces_found: Flags) -> Flags:
        """Nodes of some pieces, on whatever rank these are."""
        found = np.zeros((len(surface.coordinates), 1))
        found[pieces.nodes[pieces_found].ravel()] = 1.0
        return np.asarray(surface.summed(found)[trace.numbers, 0] > 0)

    touches = closed[pieces.points] if len(closed) else np.zeros(pieces.points.shape, dtype=bool)
    surrounded = closed & ~beside(~touches.all(axis=1))
    inner = surrounded[pieces.points] if len(closed) else touches
    return np.asarray(surrounded | beside(inner.any(axis=1)))


def words_on(contacts: Sequence[ContactSurface], states: Sequence[ContactState]) -> str:
    """A clause on contacts with too few points across what touches, or nothing; collective.

    Args:
        contacts: In scene order.
        states: Of each.
    """
    found = []
    for contact, state in zip(contacts, states, strict=True):
        thin = thin_contact(contact, state)
        if thin is not None:
            place = ", ".join(f"{x + 0.0:.4g}" for x in thin.place[: contact.spaces.components])
            found.append(f"'{contact.label}' near ({place})")
    if not found:
        return ""
    of, verb = ("the contacts", "are") if len(found) > 1 else ("the contact", "is")
    return (
        f"{of} at {' and '.join(found)} {verb} not resolved: fewer than three points lie across "
        "what touches, and its pressure is that of the mesh; make cells smaller there, or ask for "
        "an accuracy."
    )


# What cells become where contact is not seen, over what they are.
_FINER_UNSEEN = 0.25


@dataclass(frozen=True, eq=False)
class CoarseContact:
    """A contact for which the mesh is too coarse.

    Attributes:
        number: Of the contact, in scene order.
        label: Its name.
        thin: Where too few points lie across what touches, if there.
        is_unseen: Whether some of what touches is not seen.
        governs: Whether that governs the answer.
        sticks: Whether friction holds some of what touches: what slips goes by its size.
        finer: Rows of x, y, z and the size that cells there are to have, of this rank (length).
    """

    number: int
    label: str
    thin: ThinContact | None
    is_unseen: bool
    governs: bool
    sticks: bool
    finer: Array


def coarse_contacts(load_steps: LoadSteps) -> list[CoarseContact]:
    """Return the contacts of an answer that cells are too coarse for; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    found, governed = [], governed_by_depth(load_steps)
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        if not contact.is_one_sided:
            continue
        between = unseen(problem, solution, number, solution.displacement)
        far = between.shares > LARGEST_UNSEEN
        size = _FINER_UNSEEN * between.spacing[far] * problem.spaces.degree
        finer = np.column_stack([between.places[far], size])
        is_unseen = total(problem.comm, len(finer)) > 0
        thin = thin_contact(contact, state)
        if thin is not None:
            finer = np.concatenate([finer, thin.finer])
        if is_unseen or thin is not None:
            governs = is_unseen and not governed[number].passed
            sticking = int((state.status == STICK).sum()) if contact.friction.has_friction else 0
            sticks = total(problem.comm, sticking) > 0
            which = number, contact.label
            found.append(CoarseContact(*which, thin, is_unseen, governs, sticks, finer))
    return found


def notes_on(coarse: Sequence[CoarseContact]) -> list[str]:
    """Sentences on error bars that there are not."""
    notes = []
    for one in coarse:
        if one.governs:
            notes.append(
                f"There are no error bars: on this mesh some of what touches at '{one.label}' is "
                "not seen."
            )
        elif one.is_unseen:
            notes.append(
                f"Pressures, areas and slips at '{one.label}' have no error bars: what stands "
                "opposite sinks in between the points of the surface. It does not govern forces "
                "and displacements, whose bars hold what it makes of them."
            )
        else:
            notes.append(
                f"Pressures, areas and slips at '{one.label}' have no error bars: fewer than three "
                "points lie across what touches."
            )
    return notes


def without_bars(keys: Iterable[Hashable], coarse: Sequence[CoarseContact]) -> list[Hashable]:
    """Return the keys of quantities whose error the mesh is too coarse to tell.

    Args:
        keys: As of ``Measured``.
        coarse: What the mesh is too coarse for.
    """
    if any(one.governs for one in coarse):
        return list(keys)
    without: set[Hashable] = {(one.number, name) for one in coarse for name in _unknown_of(one)}
    without |= {name for one in coarse for name in _unknown_of(one)}
    return [key for key in keys if key in without]


def _unknown_of(one: CoarseContact) -> tuple[str, ...]:
    local = tuple(row.name for row in table.every() if row.is_local)
    return (*local, FRICTION_WORK) if one.sticks else local


# What is left open between points, over what closes, on cells that show an obstacle.
_SHOWN = 0.1
# Cells become at most so many times smaller at once.
_LEAST = 0.125


@dataclass(frozen=True, eq=False)
class Hidden:
    """An obstacle that no point of a surface would meet, however the answer.

    Attributes:
        label: Of the contact.
        place: Where it meets the surface first, (3,) (length).
        spacing: From one contact point to the next there (length).
        wanted: Size of cells that would show it (length).
    """

    label: str
    place: Array
    spacing: float
    wanted: float


def hidden_obstacles(problem: Problem) -> list[Hidden]:
    """Return the obstacles hidden between points, before the first load step; collective."""
    found = [_hidden(problem, contact) for contact in problem.contacts if contact.is_one_sided]
    return [one for one in found if one is not None]


def words_on_hidden(hidden: list[Hidden], components: int) -> list[str]:
    """Sentences on them.

    Args:
        hidden: The obstacles.
        components: Of a place in the model.
    """
    return [
        f"The mesh is too coarse at '{one.label}': the obstacle meets the surface between its "
        f"points, near ({', '.join(f'{x + 0.0:.4g}' for x in one.place[:components])}), and no "
        f"point before the end of its way; make cells there {one.wanted:.2g} wide, or ask for an "
        "accuracy"
        for one in hidden
    ]


def _hidden(problem: Problem, contact: ContactSurface) -> Hidden | None:
    kinematics = contact.kinematics
    if not isinstance(kinematics, ObstacleKinematics) or not kinematics.direction.any():
        return None
    at_points, between = kinematics.first_distances()
    nearest = smallest(problem.comm, at_points, empty=np.inf)
    rows = np.column_stack([-between.depth, between.places, between.spacing])
    rows = gather_rows(problem.comm, rows[np.lexsort(rows.T[::-1])[:1]])
    if len(rows) == 0:
        return None
    first = rows[np.lexsort(rows.T[::-1])[0]]
    ahead, spacing = nearest - first[0], float(first[4])
    closes = _closes(problem, contact, first[0], spacing)
    if not 0 < closes < ahead:
        return None
    share = np.sqrt(_SHOWN * closes / ahead) if np.isfinite(ahead) else 0.0
    wanted = max(share, _LEAST) * spacing * problem.spaces.degree
    return Hidden(contact.label, first[1:4], spacing, float(wanted))


def _closes(problem: Problem, contact: ContactSurface, ahead: float, spacing: float) -> float:
    """How far an obstacle is driven beyond its first touch, at the most, about (length)."""
    times = [1.0, *knots(problem.scene)]
    if contact.force is None:
        return max(contact.paths.indentation(time) for time in times) - ahead
    force = max(contact.paths.force(time) or 0.0 for time in times)
    spaces = problem.spaces
    in_plane = spaces.components == 2 and spaces.kinematics != "axisymmetric"
    return force / contact.moduli.plane_strain / (1.0 if in_plane else spacing)
