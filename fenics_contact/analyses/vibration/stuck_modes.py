"""Modes about the last state of a scene, all that carries pressure stuck."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fenics_contact.analyses.vibration.eigenmodes import Eigenmodes, Mode
from fenics_contact.analyses.vibration.record import ModeRecord
from fenics_contact.body.mass import Mass
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.modes.served import LinearisedBody


def stuck_modes(system: CondensedSystem, body: CondensedBody, number: int) -> list[Mode]:
    """The lowest modes; collective.

    Args:
        system: At the begin of the load step that would come next.
        body: Its body.
        number: How many.

    Raises:
        InputError: There are not so many.
        NotConvergedError: They were not found, or a rigid motion is free.
    """
    problem = system.problem
    if problem.stabilisation:
        raise NotConvergedError(
            "modes: a rigid motion is held by nothing, so that its frequency is 0; hold it by a "
            "support"
        )
    mass, free = Mass(problem.scene.material, problem.spaces), problem.free
    problem.stick_all()  # what carries pressure has the stiffness of contact, and of stick
    stuck = LinearisedBody(system, body)

    def times_mass(nodal: Array) -> Array:
        return mass.times(nodal * free) * free

    count = int(total(problem.comm, float(free[: problem.spaces.owned_nodes].sum())))
    return Eigenmodes(problem.spaces, times_mass, stuck.solve).lowest(number, count)


def mode_records(modes: Sequence[Mode]) -> list[ModeRecord]:
    """Return the modes as ``result.json`` has them.

    Args:
        modes: In their order.
    """
    return [
        ModeRecord(
            number=number,
            natural_frequency=mode.circular_frequency / (2 * math.pi),
            modal_mass=mode.mass,
        )
        for number, mode in enumerate(modes, start=1)
    ]
