"""Functions of the place that a scene gives, as they are between nodes too.

Loads act with values that are interpolated between the nodes of the body's own element. What
functions are besides is seen by elements of a higher degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import basix
import numpy as np
from dolfinx import fem

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.values import Value

# Of the elements, by dimension: a step within a cell is then found to a tenth of the cell.
_DEGREES = {2: 6, 3: 4}
# Of reference coordinates: what lies on a side of the reference cell.
_ON_SIDE = 1e-9


def sampled(spaces: Spaces, values: Sequence[Value], group: Group, key: str) -> Expr:
    """Values on a group, a dolfinx function of one or all components; collective.

    Args:
        spaces: Those of the body.
        values: One of each component.
        group: Cells or facets; the function means something there alone.
        key: For messages.
    """
    mesh, dimension = spaces.body.mesh, spaces.body.dimension
    shape = (len(values),) if len(values) > 1 else ()
    space = fem.functionspace(mesh, ("DG", _DEGREES[dimension], shape))
    places = compat.interpolation_points(space.element)
    if group.dimension == dimension:
        dofs = [space.dofmap.list[spaces.body.entities(group)].ravel()]
    else:
        pairs = spaces.facets(group)
        cell = getattr(basix.CellType, mesh.topology.cell_name())
        dofs = [
            space.dofmap.list[pairs[pairs[:, 1] == side, 0]][:, on_side(cell, side, places)[0]]
            for side in np.unique(pairs[:, 1]).tolist()
        ]
    chosen = np.unique(np.concatenate([np.zeros(0, dtype=np.int32), *map(np.ravel, dofs)]))
    points = space.tabulate_dof_coordinates()[chosen].T
    function = fem.Function(space)
    array = function.x.array.reshape(-1, len(values))
    for axis, value in enumerate(values):
        array[chosen, axis] = spaces.evaluate_at(value, points, key)
    return function


def on_side(cell: Any, side: int, places: Array) -> tuple[AnyIntegers, Array]:
    """Which places of the reference cell are on a side of it, and where on that."""
    dimension = places.shape[1]
    corners = basix.geometry(cell)[basix.topology(cell)[dimension - 1][side]]
    axes = (corners[1:dimension] - corners[0]).T
    reference = (places - corners[0]) @ np.linalg.pinv(axes).T
    apart = np.linalg.norm(places - corners[0] - reference @ axes.T, axis=1)
    on = np.flatnonzero(apart < _ON_SIDE)
    return on, reference[on]
