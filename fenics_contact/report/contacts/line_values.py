"""Values to draw along a contact line, panel by panel.

Still pictures, the slider of the report and pages of several runs all draw these.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.contacts.own_arrays import label, shown_arrays, sizes
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.records.contacts import ContactRecord

PRESSURE, FRICTION, GAP, SLIP = "contact pressure", "friction traction", "gap", "slip"
BOUND = r"friction bound, $\pm\mu p$"


@dataclass(frozen=True)
class LineValues:
    """A panel's values along a contact line.

    Attributes:
        name: What they are.
        label: Of the panel's axis.
        values: At the points of the line, (points,); not a number where there is none.
        bounds: Further curves that the values keep between, likewise.
        is_peaked: Whether single points may have far more than others, which is then cut off.
    """

    name: str
    label: str
    values: Array
    bounds: list[Array] = field(default_factory=list)
    is_peaked: bool = False


def line_values(
    line: SurfaceLine, contact: ContactRecord, kept: Collection[str] = ()
) -> list[LineValues]:
    """The curves worth drawing: what is found, and what is not zero all along.

    Args:
        line: The contact line.
        contact: Its entry in ``result.json``.
        kept: Names of those that are worth it in another load step.
    """
    found, frictional = not contact.pressure_is_given, contact.carries_shear
    gap = line.rows.numbers["gap"]
    is_apart = (np.isfinite(gap) & ~line.rows.closed).any()
    own = {array.words: array for array in contact.own_arrays if array.words in kept}
    own |= shown_arrays(line.rows, contact)
    return [
        *([pressure_along(line)] if found or not frictional else []),
        *([friction_along(line, contact)] if frictional else []),
        *([gap_along(line)] if found and (is_apart or GAP in kept) else []),
        *(LineValues(name, label(array), sizes(line.rows, array)) for name, array in own.items()),
    ]


def pressure_along(line: SurfaceLine) -> LineValues:
    """The contact pressure.

    Args:
        line: The contact line.
    """
    pressure = line.rows.numbers["contact_pressure"]
    return LineValues(
        PRESSURE, labelled("contact pressure, $p$", "stress"), pressure, is_peaked=True
    )


def friction_along(line: SurfaceLine, contact: ContactRecord) -> LineValues:
    """The friction traction with its bound ±g, on the side (or sides) where it lies.

    Args:
        line: The contact line.
        contact: Its entry in ``result.json``.
    """
    traction, numbers = line.traction, line.rows.numbers
    bounds, bound = [], numbers.get("friction_bound")
    if bound is None and contact.coulomb_coefficient:
        bound = contact.coulomb_coefficient * numbers["contact_pressure"]
    if bound is not None:
        sides = [side for side in (1, -1) if (side * traction > 0.02 * bound.max()).any()]
        bounds = [side * bound for side in sides]
    words = labelled(r"friction traction, $\sigma_T$", "stress")
    return LineValues(FRICTION, words, traction, bounds, is_peaked=True)


def gap_along(line: SurfaceLine) -> LineValues:
    """The gap.

    Args:
        line: The contact line.
    """
    gap = line.rows.numbers["gap"]
    return LineValues(GAP, labelled("gap", "length"), np.where(np.isfinite(gap), gap, np.nan))


def slip_along(line: SurfaceLine) -> LineValues:
    """The slip since the start along the surface; none where nothing faces a point.

    Args:
        line: The contact line.
    """
    slip = np.where(np.isfinite(line.rows.numbers["gap"]), line.slip, np.nan)
    return LineValues(SLIP, labelled("slip, $s$", "length"), slip)
