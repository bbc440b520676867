"""Loads whose force over area or volume the scene gives: tractions, pressures, body forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.common.arrays import Array
from fenics_contact.problem.curved_sides import CurvedSides, sampled
from fenics_contact.problem.loads.acting_load import ActingLoad, LoadSite
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.values import Value


@dataclass(frozen=True, eq=False)
class GivenForce(ActingLoad):
    """A load whose value varies as the scene says, interpolated between the nodes.

    Attributes:
        value: A UFL vector; a scalar where it has one component (stress, or force over volume).
        given: What the scene says of each component.
    """

    value: Expr
    given: tuple[Value, ...]

    @classmethod
    def of(cls, load: Load, components: Sequence[Value], key: str, site: LoadSite) -> Self | None:
        """Return the load with values at the nodes of its group; collective."""
        spaces, key_of_value = site.spaces, f"{key}.{load.kind}"
        group = cls.place(load.on, f"{key}.on", spaces)
        nodes = spaces.nodes(group)
        nodal = np.stack(
            [spaces.evaluate(v, nodes, f"{key_of_value}[{i}]") for i, v in enumerate(components)],
            axis=1,
        )
        if spaces.comm.allreduce(int(np.count_nonzero(nodal))) == 0:
            return None
        coefficient = spaces.coefficient(cls.field(nodal), nodes)
        return cls(group, spaces, key_of_value, coefficient, tuple(components))

    @property
    def force(self) -> Expr:
        """Force over area or volume: the value that the scene gives."""
        return self.value

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

    def nodal_of_units(self, found: dict[Any, list[Array]]) -> Array:
        """Return the nodal forces; where they are constant, by those of unit components."""
        if not self.is_constant:
            return self.nodal()
        key = type(self), self.group
        if key not in found:
            found[key] = [self.of_unit(place).nodal() for place in range(len(self.given))]
        return np.tensordot(np.array(self.given, dtype=np.float64), found[key], axes=(0, 0))

    @staticmethod
    def field(nodal: Array) -> Array:
        """Return nodal values as its coefficient has them, from (nodes, components)."""
        return nodal if nodal.shape[1] > 1 else nodal[:, 0]


class Traction(GivenForce):
    """A force over the area of a boundary."""

    kind: ClassVar[str] = "traction"


class Pressure(GivenForce):
    """A force over the area of a boundary, against its normal."""

    kind: ClassVar[str] = "pressure"

    @property
    def force(self) -> Expr:
        """Against the normal."""
        return -self.value * ufl.FacetNormal(self.spaces.body.mesh)

    def missed_density(self, displacement: Expr, sides: CurvedSides) -> Expr:
        """On the surface further out, whose normal is turned."""
        turned = sides.widened * sides.normal - sides.slope
        further = ufl.dot(sides.normal, sides.further_motion(displacement))
        more = ufl.dot(turned, displacement) + further
        return -self.value * more


class BodyForce(GivenForce):
    """A force over the volume of a part of the body."""

    kind: ClassVar[str] = "body_force"
    is_of_volume: ClassVar[bool] = True
