"""The load that acts on a body, whatever its kind."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides, sampled
from fenics_contact.scene.values import Value


@dataclass(frozen=True, eq=False)
class ActingLoad(ABC):
    """A load of a scene with its values in UFL.

    Attributes:
        kind: Key that a scene gives it by, such as ``pressure``.
        is_of_volume: Whether it acts inside the body, as a weight does.
        value: Interpolated between nodes, a vector; a scalar where it has one component (stress,
            or force over volume).
        group: What it acts on.
        spaces: Those of the body.
        given: What the scene says of each component.
        key: Of the load, for messages.
    """

    kind: ClassVar[str]
    is_of_volume: ClassVar[bool] = False
    value: Expr
    group: Group
    spaces: Spaces
    given: tuple[Value, ...]
    key: str

    @property
    def is_constant(self) -> bool:
        """Whether it is the same everywhere, so that nodes say all of it."""
        return not any(callable(value) for value in self.given)

    def of_unit(self, component: int) -> Self:
        """Return the load with 1 as a component of its value, and 0 as all others."""
        nodes = self.spaces.nodes(self.group)
        nodal = np.zeros((len(nodes), len(self.given)))
        nodal[:, component] = 1.0
        return replace(self, value=self.spaces.coefficient(self.field(nodal), nodes))

    def as_given(self) -> Self:
        """Return the load with values as they are between nodes; collective."""
        return replace(self, value=sampled(self.spaces, self.given, self.group, self.key))

    def work(self, displacement: Expr) -> ufl.Form:
        """Work on a displacement, an integral in UFL (energy)."""
        return self.spaces.weight * ufl.dot(self.force, displacement) * self.measure

    @property
    def force(self) -> Expr:
        """Force over area or volume, a UFL vector."""
        return self.value

    @property
    def measure(self) -> ufl.Measure:
        """Measure of what it acts on; by default the facets of a boundary."""
        return self.spaces.boundary(self.group)

    @staticmethod
    def field(nodal: Array) -> Array:
        """Return nodal values as its coefficient has them, from (nodes, components)."""
        return nodal if nodal.shape[1] > 1 else nodal[:, 0]

    @staticmethod
    def place(group: str, key: str, spaces: Spaces) -> Group:
        """Return the group of the mesh that it acts on, by the scene's name.

        Raises:
            InputError: There is none, or it is no boundary.
        """
        return spaces.body.boundary(group, key)

    @abstractmethod
    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """Work that it does more where curves lie outside of facets, but for higher order.

        What lies between has a body force of its own. A surface that lies further out by d has its
        normal turned by −∇d, is longer by ½ |∇d|², and moves by d ∂v/∂n more.
        """

    def missed_measure(self, sides: CurvedSides) -> ufl.Measure:
        """Return the measure of the curved sides of what it acts on."""
        return sides.measure(sides.within(self.group))
