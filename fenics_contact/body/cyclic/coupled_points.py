"""Points of couplings in a sector of a ring: one for all sectors on the axis, else one for each.

Couplings have copies in all sectors, as everything has, which move by u(R x) = R u(x). A point off
the axis has a copy in each sector, and moves in any way. One on the axis is its own copy: its
displacement d = R d is along the axis, and its rotation about it. A rigid boundary that reaches the
cut shares points with its copies, so that all of them are one rigid body, whose point is on the
axis.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.description import CoupledGroup
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.scene.values import AXES, AxisName

# Of a unit vector: how far it may be from an axis of the mesh.
_ALONG = 1e-9


def axis_of_point(
    cut: CutFaces, described: CoupledGroup, key: str, at: Array, nodes: Integers
) -> AxisName | None:
    """The axis along and about which the point of a coupling moves; collective.

    Args:
        cut: The cut faces.
        described: The coupling.
        key: Where, for messages.
        at: Its point, (components,) (length).
        nodes: Of its boundary (local indices, owned and ghost).

    Returns:
        None where each sector has a point of its own, which moves in any way.

    Raises:
        InputError: The boundary is rigid and shares points with copies that move otherwise, or the
            axis is along none of the mesh.
    """
    reaches, is_alike = cut.reached_by(nodes)
    is_joined = described.is_rigid and reaches
    nearest = cut.on_axis(at)
    if np.linalg.norm(nearest - at) > cut.tolerance:
        if is_joined:
            place = ", ".join(f"{x:.6g}" for x in nearest + 0.0)
            raise InputError(
                f"{key}.on = '{described.on}': reaches a cut face of cyclic_symmetry, so that it "
                "is one rigid body with its copies in the other sectors; give it a point of the "
                f"axis, such as at = [{place}]"
            )
        return None
    if is_joined and not is_alike:
        raise InputError(
            f"{key}.on = '{described.on}': reaches a cut face of cyclic_symmetry where, turned, it "
            "does not reach the other one; a rigid boundary ends in both alike, or in none"
        )
    along = np.flatnonzero(np.abs(cut.axis) > 1 - _ALONG)
    if len(along) == 0:
        raise InputError(
            f"{key}.at: is on the axis of cyclic_symmetry, which is along none of the axes of the "
            "mesh; a point there needs an axis along x, y or z"
        )
    return AXES[int(along[0])]
