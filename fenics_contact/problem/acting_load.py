"""What loads do on displacements: on the body as it is meshed, and on what facets miss of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import ufl

from fenics_contact.body.spaces import Spaces
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.sampled_values import sampled
from fenics_contact.scene.conditions import Load
from fenics_contact.scene.values import Value

Kind = Literal["traction", "pressure", "body_force"]


@dataclass(frozen=True, eq=False)
class ActingLoad:
    """A load of a scene with its values in UFL.

    Attributes:
        kind: As in scenes.
        value: Vector, of a pressure a scalar (stress, or force over volume).
        group: What it acts on.
        spaces: Those of the body.
        given: What the scene says of each component.
        key: Of the load, for messages.
    """

    kind: Kind
    value: Any
    group: Group
    spaces: Spaces
    given: tuple[Value, ...]
    key: str

    @property
    def is_constant(self) -> bool:
        """Whether it is the same everywhere, so that nodes say all of it."""
        return not any(callable(value) for value in self.given)

    def as_given(self) -> ActingLoad:
        """With values as they are between nodes; collective."""
        return replace(self, value=sampled(self.spaces, self.given, self.group, self.key))

    def work(self, displacement: Any) -> Any:
        """On a displacement, an integral in UFL."""
        spaces = self.spaces
        in_body = self.kind == "body_force"
        measure = spaces.part(self.group) if in_body else spaces.boundary(self.group)
        force = self.value
        if self.kind == "pressure":
            force = -self.value * ufl.FacetNormal(spaces.body.mesh)
        return spaces.weight * ufl.dot(force, displacement) * measure

    def missed_work(self, displacement: Any, sides: CurvedSides) -> Any:
        """What it does more where curves lie outside of facets, but for higher order.

        What lies between has a body force of its own. A surface that lies further out by d has its
        normal turned by −∇d, is longer by ½ |∇d|², and moves by d ∂v/∂n more.
        """
        offset, normal = sides.offset, sides.normal
        weight, measure = self.spaces.weight, sides.measure(sides.within(self.group))
        if self.kind == "body_force":
            return weight * offset * ufl.dot(self.value, displacement) * measure
        further = offset * ufl.dot(ufl.grad(displacement), normal)
        if self.kind == "pressure":
            turned = sides.widened * normal - sides.slope
            more = ufl.dot(turned, displacement) + ufl.dot(normal, further)
            return -weight * self.value * more * measure
        more = sides.stretch * displacement + further
        return weight * ufl.dot(self.value, more) * measure


def kind_and_values(load: Load) -> tuple[Kind, tuple[Value, ...]]:
    """Which of the three kinds a load is, and its components."""
    if load.traction is not None:
        return "traction", load.traction
    if load.pressure is not None:
        return "pressure", (load.pressure,)
    assert load.body_force is not None  # the scene has made sure of one
    return "body_force", load.body_force
