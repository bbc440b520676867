"""States of bodies that move, between which a step goes, and how far contacts slide in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.body.preloaded_part import ScalarColumns
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.scene.loading.motion import Motion

_AT_NODES = ("displacement", "velocity", "internal", "load", "pressed")
_SLIDING = "moving_sliding"


@dataclass(frozen=True, eq=False)
class StepStiffness:
    """The matrix of a step: so many times K, and what is added at each node.

    Attributes:
        nodal: (nodes, components, components) (force/length).
        of_bulk: Factor of K.
        scalars: Its columns of the body's scalars; None where these are those of statics.
    """

    nodal: Array
    of_bulk: float = 1.0
    scalars: ScalarColumns | None = None


@dataclass(frozen=True, eq=False)
class Drag:
    """State of damping when a step begins.

    Attributes:
        rate: K times the mean velocity of the step before, (nodes, components) (force/time).
        across: What it then resists with across contacts, likewise (force).
        lost: Energy that it has taken (energy).
    """

    rate: Array
    across: Array
    lost: float = 0.0


@dataclass(frozen=True, eq=False)
class MovingState:
    """Where bodies are and how they move at the begin of a step, (nodes, components) each.

    Attributes:
        time: When.
        displacement: Of the nodes (length).
        velocity: Likewise (length/time).
        internal: K u (force).
        load: Loads that are given (force).
        pressed: Forces of pressures of contacts (force).
        motions: Of what stands opposite, of each contact, (contacts, components) (length).
        elastic: Slip that goes back, at the points of each contact (length).
        drag: Of damping.
        sliding: Speed of sliding that friction goes by in the step, at the points of each contact;
            None at time 0, where velocities tell it (length/time).
    """

    time: float
    displacement: Array
    velocity: Array
    internal: Array
    load: Array
    pressed: Array
    motions: Array
    elastic: tuple[Array, ...]
    drag: Drag
    sliding: tuple[Array, ...] | None = None

    @property
    def at_points(self) -> list[dict[str, Array]]:
        """Arrays at the points of each contact, by name."""
        found = [
            {f"moving_elastic_{axis}": column for axis, column in enumerate(values.T)}
            for values in self.elastic
        ]
        for each, speed in zip(found, self.sliding or [], strict=False):
            each[_SLIDING] = speed
        return found

    @property
    def parts(self) -> tuple[dict[str, Any], dict[str, Array]]:
        """The parts that are no arrays, as JSON has them, and those at the nodes, by name."""
        said = {"began_at": self.time, "motions": self.motions.tolist(), "lost": self.drag.lost}
        nodal = {name: getattr(self, name) for name in _AT_NODES}
        return said, nodal | {"rate": self.drag.rate, "across": self.drag.across}

    @classmethod
    def of(
        cls,
        said: dict[str, Any],
        nodal: dict[str, Array],
        at_points: Sequence[Mapping[str, Array]],
    ) -> MovingState:
        """The state that has these ``parts``.

        Args:
            said: What is no array.
            nodal: What stands at the nodes of this rank.
            at_points: As the attribute.
        """
        motions = np.array(said["motions"], dtype=np.float64)
        known = [dict(values) for values in at_points]
        sliding = tuple(values.pop(_SLIDING) for values in known if _SLIDING in values)
        return cls(
            time=said["began_at"],
            motions=motions,
            elastic=tuple(np.stack(list(values.values()), axis=1) for values in known),
            sliding=sliding or None,
            drag=Drag(nodal["rate"], nodal["across"], said["lost"]),
            **{name: nodal[name] for name in _AT_NODES},
        )


@dataclass(frozen=True, eq=False)
class FirstState:
    """State in which a motion begins, for the balances along it.

    Attributes:
        energy: That is stored: strains, springs of contacts, elastic slip (energy).
        pressures: Resultant of the pressures of each contact on the body of ``on``, (contacts,
            components) (force).
        overlaps: Of each contact, how deep its surfaces overlap as meshed, at its points (length).
        scalars: Force on each of the body's scalars, and its value (force; length).
    """

    energy: float
    pressures: Array
    overlaps: tuple[Array | float, ...]
    scalars: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, eq=False)
class StepForces:
    """Forces and velocities of a step at the nodes, (nodes, components) each.

    Attributes:
        internal: K u at its end (force).
        needed: From contacts, and from supports the mean of the step: across contacts at its end,
            else less half the change of pressures (force).
        velocity: At its end (length/time).
        pressed: Forces of pressures of contacts then (force).
        dragged: What damping resisted with, the mean of the step (force).
        drag: What it has done at its end.
    """

    internal: Array
    needed: Array
    velocity: Array
    pressed: Array
    dragged: Array
    drag: Drag


def first_velocity(motion: Motion, spaces: Spaces) -> Array:
    """Velocity of the nodes at time 0, (nodes, components) (length/time).

    Raises:
        InputError: A velocity is given to a group that is not there, or is no part of the body.
    """
    found = np.zeros((len(spaces.coordinates), spaces.components))
    for name, velocity in motion.velocity.items():
        key = f"motion.velocity.{name}"
        group = spaces.body.group(name, key)
        if group.dimension != spaces.body.dimension:
            raise InputError(f"{key}: must be a part of the body, not a boundary")
        found[spaces.nodes(group)] = velocity
    return found


# Of the largest bound of friction, by which two are the same.
_SAME = 1e-9


def along_contact(contact: ContactSurface, vectors: Array, opposite: Array) -> Array:
    """Vectors at the nodes relative to the body opposite, along a contact; collective.

    Args:
        contact: The contact.
        vectors: Displacements or velocities, (nodes, components).
        opposite: Those of an obstacle, (components,).
    """
    kinematics = contact.kinematics
    jump = contact.trace.at_points(kinematics.relative(vectors) - opposite)
    return np.asarray(kinematics.tangential(jump))


def _sizes(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _counted(contact: ContactSurface) -> Array:
    """The slip that friction counts at present, (points, components) (length)."""
    kinematics = contact.kinematics
    return contact.friction.effective_slip(kinematics.tangential(kinematics.jump_at_points()))


def elastic_slip(contact: ContactSurface) -> Array:
    """The part of the slip that friction counts at present that goes back, at most ε (length)."""
    return _goes_back(contact, _counted(contact))


def _goes_back(contact: ContactSurface, counted: Array) -> Array:
    if not contact.friction.has_friction:
        return np.zeros_like(counted)
    sizes = _sizes(counted)
    most = np.where(contact.friction_bound > 0, contact.regularisation_parameter, 0.0)
    share = np.divide(np.minimum(sizes, most), sizes, out=np.zeros_like(sizes), where=sizes > 0)
    return np.asarray(counted * share[:, None])


def end_speeds(contacts: Sequence[ContactSurface], size: float) -> tuple[Array, ...]:
    """Speeds at the end of a step, (points,) each; 0 where friction does not follow them.

    Slip that friction counts is ½ Δt v₁ and what goes back, the rest is what slides.

    Args:
        contacts: As the step leaves them.
        size: Its length (time).
    """
    return tuple(2 / size * _sizes(_slides(contact)) for contact in contacts)


def _slides(contact: ContactSurface) -> Array:
    if not contact.friction.follows_speed:
        return np.zeros((len(contact.trace.normals), 1))
    counted = _counted(contact)
    return np.asarray(counted - _goes_back(contact, counted))


def follow(contacts: Sequence[ContactSurface], speeds: Sequence[Array]) -> bool:
    """Let friction go by other speeds; collective.

    Args:
        contacts: With what presses on them at present.
        speeds: As of ``end_speeds``.

    Returns:
        Whether a bound has changed by it.
    """
    changed = False
    for contact, speed in zip(contacts, speeds, strict=True):
        if contact.friction.follows_speed:
            comm, pressure = contact.spaces.comm, contact.pressure()
            before = contact.friction.bound_of(pressure)
            contact.follow_speed(speed)
            off = largest(comm, np.abs(contact.friction.bound_of(pressure) - before))
            changed |= off > _SAME * largest(comm, before)
    return changed
