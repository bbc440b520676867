"""What a contact remembers of load steps that are done: to go back to, and to go on from."""

from __future__ import annotations

from dataclasses import dataclass

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface


@dataclass(frozen=True, eq=False)
class ContactMemory:
    """The state of a contact beside the displacement, when a load step has been solved.

    Attributes:
        indentation: Of its obstacle (length).
        dissipated: By friction, in the steps before (force × length).
        left_open: Work of pressures, where a gap was measured anew (force × length).
        regularisation_parameter: ε as chosen (length).
        is_scaled: Whether ε has been set.
        at_points: What its laws declare, and what happened at the end of the step before, by name:
            (points,) or (points, components).
        paired_at: Displacement at which two bodies were paired; None as meshed (length).
        dissipated_before: `dissipated` at the begin of each cycle of loads that began (force ×
            length).
    """

    indentation: float
    dissipated: float
    left_open: float
    regularisation_parameter: float
    is_scaled: bool
    at_points: dict[str, Array]
    paired_at: Array | None
    dissipated_before: tuple[float, ...] = ()


def remember(contact: ContactSurface) -> ContactMemory:
    """The present state of a contact."""
    kinematics, friction = contact.kinematics, contact.friction
    return ContactMemory(
        indentation=kinematics.indentation,
        dissipated=contact.last_step.dissipated,
        left_open=contact.last_step.left_open,
        regularisation_parameter=friction.regularisation.chosen,
        is_scaled=friction.regularisation.is_known,
        at_points=friction.kept()
        | {"bound": contact.friction_bound.copy()}
        | contact.last_step.at_points()
        | contact.normal.kept()
        | contact.wear.kept(),
        paired_at=kinematics.paired_at,
        dissipated_before=contact.last_step.dissipated_before,
    )


def recall_pairing(contact: ContactSurface, memory: ContactMemory) -> bool:
    """Pair two bodies as they were; whether they were paired otherwise; collective."""
    if contact.kinematics.paired_at is memory.paired_at:
        return False
    contact.update_pairing(memory.paired_at)
    return True


def recall(contact: ContactSurface, memory: ContactMemory) -> None:
    """Go back to a remembered state, bodies being paired as they were."""
    contact.kinematics.drive(memory.indentation)
    done = memory.dissipated, memory.left_open, memory.dissipated_before
    contact.last_step.restore(memory.at_points, *done)
    contact.normal.recall(memory.at_points)
    contact.normal_term.follow_law()
    contact.friction.regularisation.recall(memory.regularisation_parameter, memory.is_scaled)
    contact.friction.recall(memory.at_points)
    contact.friction_term.follow_law()
    contact.wear.recall(memory.at_points)
    contact.kinematics.overlap_by(contact.kinematics.interference, contact.wear.depth)
    contact.normal.set_gap(contact.kinematics.gap)
