"""Part of a given contact pressure that a mesh misses.

Between its nodes a function is interpolated, and so are normals: at the ends of a curved surface
these are those of the last facet. The pressure as it is given acts on facets, and on what these
miss of a curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.evaluate.contact_quantities import resultant
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.pressure import Pressure


@dataclass(frozen=True)
class MissedPressure:
    """Missed part of one contact's given pressure.

    Attributes:
        nodal: Forces, (nodes, components) (force).
        force: The length of their sum (force).
        share: By how much more the pressure's integral is, over what it is.
    """

    nodal: Array
    force: float
    share: float


def missed_pressure(
    contact: ContactSurface, sides: CurvedSides, time: float
) -> MissedPressure | None:
    """Return the missed part of a contact's given pressure; collective.

    Args:
        contact: The contact.
        sides: Those of its body.
        time: Pseudo-time.

    Returns:
        None where the pressure is not given, or where it is one number on a flat surface.
    """
    spaces, group, given = contact.spaces, contact.trace.group, contact.contact.pressure
    if given is None or not contact.normal.loads:
        return None
    is_curved = total(spaces.comm, int(sides.within(group).sum())) > 0
    load = Pressure(None, group, spaces, (given,), "contact.pressure")
    if load.is_constant and not is_curved:
        return None
    load, test = load.as_given(), ufl.TestFunction(spaces.displacement_space)
    surface, (form, path) = contact.trace.surface, contact.normal.loads[0]
    factor = path(time)
    nodal = spaces.assemble(form_cache.form(load.work(test)))
    nodal -= surface.on_body(surface.assemble(form))
    whole = spaces.weight * load.value * spaces.boundary(group)
    parts = [float(fem.assemble_scalar(form_cache.form(whole)))]
    if is_curved:
        nodal += spaces.assemble(form_cache.form(load.missed_work(test, sides)))
        more = spaces.weight * load.value * sides.stretch * sides.measure(sides.within(group))
        parts.append(float(fem.assemble_scalar(form_cache.form(more))))
    present = float(contact.trace.integral(contact.pressure()))
    true = factor * float(total(spaces.comm, sum(parts)))
    return MissedPressure(
        factor * nodal,
        abs(factor) * float(np.linalg.norm(resultant(spaces, nodal[: spaces.owned_nodes]))),
        abs(true - present) / (abs(present) or 1.0),
    )
