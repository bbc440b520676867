"""Values of the scene's materials at points of the body, and as UFL coefficients.

Numbers become constants where one material fills the body, else functions on cells; what
varies in space is interpolated in each cell, between points inside it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from dolfinx import fem

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, raise_together, smallest
from fenics_contact.scene.material import Material
from fenics_contact.scene.values import Value


class MaterialPoints:
    """The points of a discontinuous space, and which material each is of; collective.

    Attributes:
        space: Constants in each cell; or, where a value varies, of a degree that energies keep up
            with. Its nodes lie inside the cells, so that a jump between cells stays one.
        owner: Number of the material at each of its points.

    Args:
        materials: Of the scene.
        spaces: Of the body.
        varies: Whether any of the values is a function of position.

    Raises:
        InputError: A cell has no material, or two.
    """

    def __init__(self, materials: Sequence[Material], spaces: Spaces, varies: bool) -> None:
        self._spaces, self._materials = spaces, materials
        self._keys = [
            f"material[{i}]" if len(materials) > 1 else "material" for i in range(len(materials))
        ]
        mesh, degree = spaces.body.mesh, 0
        if varies:
            degree = spaces.degree - (0 if compat.is_tensor_cell(mesh) else 1)
        self.space = fem.functionspace(mesh, compat.interior_element(mesh, degree))
        self._points = self.space.tabulate_dof_coordinates().T
        self.owner = self._find_owners()

    def _find_owners(self) -> Integers:
        """Number of the material at each point; every cell must have exactly one."""
        body, comm = self._spaces.body, self._spaces.comm
        index_map = body.mesh.topology.index_map(body.dimension)
        owner = np.full(index_map.size_local + index_map.num_ghosts, -1)
        error = None
        for number, (key, material) in enumerate(zip(self._keys, self._materials, strict=True)):
            cells: AnyIntegers | slice = slice(None)
            if material.on:
                group = body.group(material.on, f"{key}.on")
                if group.dimension != body.dimension:
                    raise InputError(f"{key}.on = '{material.on}': must be a part of the body")
                cells = body.entities(group)
            if (owner[cells] >= 0).any():
                error = InputError(
                    f"{key}.on = '{material.on}': shares cells with another material"
                )
            owner[cells] = number
        raise_together(comm, error)
        if (owner < 0).any():
            error = InputError("material: some cells of the body have none; give each its own")
        raise_together(comm, error)
        owner_of_point = np.empty(self._points.shape[1], dtype=np.int64)
        owner_of_point[self.space.dofmap.list] = owner[:, None]
        return owner_of_point

    def evaluate(self, name: str, values: Sequence[Value]) -> Array:
        """One coefficient at all points: value i where material i is; collective.

        Args:
            name: Of its key.
            values: One of each material.

        Raises:
            InputError: A function fails, or gives what is not finite.
        """
        found = np.zeros(len(self.owner))
        for number, value in enumerate(values):
            mine = self.owner == number
            key = f"{self._keys[number]}.{name}"
            found[mine] = self._spaces.evaluate_at(value, self._points[:, mine], key)
        return found

    def coefficient(self, values: Array) -> fem.Constant | fem.Function:
        """A constant where the values are all the same, else a function; collective.

        Args:
            values: At all points.
        """
        comm = self._spaces.comm
        least = smallest(comm, values)
        if least == largest(comm, values):
            return fem.Constant(self._spaces.body.mesh, least)
        function = fem.Function(self.space)
        function.x.array[:] = values
        return function
