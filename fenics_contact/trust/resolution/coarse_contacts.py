"""Contacts of an answer that its mesh is too coarse for: for error bars and for the next mesh."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.state import STICK
from fenics_contact.quantities import table
from fenics_contact.quantities.names import FRICTION_WORK
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.resolution.points_across import ThinContact, thin_contact
from fenics_contact.trust.resolution.unseen import LARGEST_UNSEEN, unseen
from fenics_contact.trust.resolution.unseen_depth import governed_by_depth

# What cells become where contact is not seen, over what they are.
_FINER = 0.25


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
        size = _FINER * between.spacing[far] * problem.spaces.degree
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
