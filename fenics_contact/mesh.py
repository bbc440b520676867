"""The body's mesh with its named groups, as every later step sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.errors import InputError


@dataclass(frozen=True)
class Group:
    """A physical group: its topological dimension and the tags of its parts."""

    dimension: int
    tags: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Body:
    """A distributed mesh and the names of its parts.

    Attributes:
        mesh: dolfinx mesh of one cell type.
        cell_tags: dolfinx mesh tags of the cells.
        facet_tags: dolfinx mesh tags of the facets.
        groups: Name → group; groups may share parts.
        source: What messages call this mesh, such as its file name.
    """

    mesh: Any
    cell_tags: Any
    facet_tags: Any
    groups: Mapping[str, Group]
    source: str = "the mesh"

    @property
    def dimension(self) -> int:
        """Topological dimension of the cells."""
        return self.mesh.topology.dim

    def group(self, name: str, key: str) -> Group:
        """A group by name.

        Raises:
            InputError: There is none of that name; the message lists those there are.
        """
        if name not in self.groups:
            known = ", ".join(sorted(self.groups)) or "none"
            raise InputError(
                f"{key} = '{name}': {self.source} has no such physical group; it has: {known}"
            )
        return self.groups[name]

    def boundary(self, name: str, key: str) -> Group:
        """A group of facets by name; an error if it is one of cells."""
        group = self.group(name, key)
        if group.dimension != self.dimension - 1:
            raise InputError(f"{key} = '{name}': must be a boundary, not a part of the body")
        return group

    def entities(self, group: Group) -> NDArray[np.int32]:
        """Local indices (owned and ghost, sorted) of the cells or facets of a group."""
        tags = self.cell_tags if group.dimension == self.dimension else self.facet_tags
        return tags.indices[np.isin(tags.values, group.tags)]
