"""What loads do on displacements: on the body as it is meshed, and on what facets miss of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.sampled_values import sampled
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.values import Value


@dataclass(frozen=True, eq=False)
class ActingLoad(ABC):
    """A load of a scene with its values in UFL.

    Attributes:
        is_of_volume: Whether it acts inside the body, as a weight does.
        value: Vector, of a pressure a scalar (stress, or force over volume).
        group: What it acts on.
        spaces: Those of the body.
        given: What the scene says of each component.
        key: Of the load, for messages.
    """

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
        """The same with 1 as a component of its value, and 0 as all others."""
        nodes = self.spaces.nodes(self.group)
        nodal = np.zeros((len(nodes), len(self.given)))
        nodal[:, component] = 1.0
        return replace(self, value=self.spaces.coefficient(self.field(nodal), nodes))

    def as_given(self) -> Self:
        """With values as they are between nodes; collective."""
        return replace(self, value=sampled(self.spaces, self.given, self.group, self.key))

    def work(self, displacement: Expr) -> ufl.Form:
        """On a displacement, an integral in UFL."""
        return self.spaces.weight * ufl.dot(self._force, displacement) * self._measure

    @property
    def _force(self) -> Expr:
        """Over area or volume, a UFL vector."""
        return self.value

    @property
    def _measure(self) -> ufl.Measure:
        return self.spaces.boundary(self.group)

    @staticmethod
    def field(nodal: Array) -> Array:
        """Nodal values as its coefficient has them, from (nodes, components of ``given``)."""
        return nodal

    @staticmethod
    def place(group: str, key: str, spaces: Spaces) -> Group:
        """The group of the mesh that it acts on, by the scene's name.

        Raises:
            InputError: There is none, or it is no boundary.
        """
        return spaces.body.boundary(group, key)

    @abstractmethod
    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """What it does more where curves lie outside of facets, but for higher order.

        What lies between has a body force of its own. A surface that lies further out by d has its
        normal turned by −∇d, is longer by ½ |∇d|², and moves by d ∂v/∂n more.
        """

    def _missed_measure(self, sides: CurvedSides) -> ufl.Measure:
        return sides.measure(sides.within(self.group))


class Traction(ActingLoad):
    """A force over the area of a boundary."""

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """On the surface further out, which is longer."""
        more = sides.stretch * displacement + _further(displacement, sides)
        return self.spaces.weight * ufl.dot(self.value, more) * self._missed_measure(sides)


class Pressure(ActingLoad):
    """A force over the area of a boundary, against its normal."""

    @property
    def _force(self) -> Expr:
        return -self.value * ufl.FacetNormal(self.spaces.body.mesh)

    @staticmethod
    def field(nodal: Array) -> Array:
        """One number at each node."""
        return nodal[:, 0]

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """On the surface further out, whose normal is turned."""
        turned = sides.widened * sides.normal - sides.slope
        further = ufl.dot(sides.normal, _further(displacement, sides))
        more = ufl.dot(turned, displacement) + further
        return -self.spaces.weight * self.value * more * self._missed_measure(sides)


class BodyForce(ActingLoad):
    """A force over the volume of a part of the body."""

    is_of_volume: ClassVar[bool] = True

    @property
    def _measure(self) -> ufl.Measure:
        return self.spaces.part(self.group)

    @staticmethod
    def place(group: str, key: str, spaces: Spaces) -> Group:
        """A part of the body."""
        found = spaces.body.group(group, key)
        if found.dimension != spaces.body.dimension:
            raise InputError(f"{key} = '{group}': a body_force needs a part of the body")
        return found

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """In what lies between facets and curves."""
        force = self.spaces.weight * sides.offset * self.value
        return ufl.dot(force, displacement) * self._missed_measure(sides)


# By `Load.kind`.
_KINDS: dict[str, type[ActingLoad]] = {
    "traction": Traction,
    "pressure": Pressure,
    "body_force": BodyForce,
}


@dataclass(frozen=True, eq=False)
class GivenLoad:
    """A load of a scene with its path.

    Attributes:
        name: For results.
        acting: As it is where the path is 1.
        path: Its factor over pseudo-time.
    """

    name: str
    acting: ActingLoad
    path: Callable[[float], float]

    @cached_property
    def form(self) -> fem.Form:
        """Its linear form, compiled; collective when first asked for."""
        return _compiled(self.acting)

    def nodal(self) -> Array:
        """Its nodal forces where the path is 1, (nodes, components); collective (force)."""
        return self.acting.spaces.assemble(self.form)

    def nodal_of_units(self, found: dict[Any, list[Array]]) -> Array:
        """The same by what units of its components do, which are found once; collective.

        Args:
            found: Those of earlier loads on the body, and of this one afterwards.
        """
        acting = self.acting
        if not acting.is_constant:
            return self.nodal()
        key = type(acting), acting.group
        if key not in found:
            size = range(len(acting.given))
            units = [acting.of_unit(component) for component in size]
            found[key] = [acting.spaces.assemble(_compiled(unit)) for unit in units]
        return np.tensordot(np.array(acting.given, dtype=np.float64), found[key], axes=(0, 0))


def given_loads(loads: tuple[Load, ...], spaces: Spaces) -> list[GivenLoad]:
    """The loads of a scene that are not zero everywhere; collective.

    Raises:
        InputError: The body has not what a load acts on, or a value cannot be had.
    """
    found = [_given_load(load, f"load[{number}]", spaces) for number, load in enumerate(loads)]
    return [load for load in found if load is not None]


def _given_load(load: Load, key: str, spaces: Spaces) -> GivenLoad | None:
    law, key_of_value = _KINDS[load.kind], f"{key}.{load.kind}"
    value = getattr(load, load.kind)
    given: tuple[Value, ...] = value if isinstance(value, tuple) else (value,)
    group = law.place(load.on, f"{key}.on", spaces)
    nodes = spaces.nodes(group)
    nodal = np.stack(
        [spaces.evaluate(v, nodes, f"{key_of_value}[{i}]") for i, v in enumerate(given)], axis=1
    )
    if spaces.comm.allreduce(int(np.count_nonzero(nodal))) == 0:
        return None
    coefficient = spaces.coefficient(law.field(nodal), nodes)
    acting = law(coefficient, group, spaces, given, key_of_value)
    name = f"{load.kind.replace('_', ' ')} on {load.on}"
    return GivenLoad(name, acting, KeyedPath(load.path, f"{key}.path"))


def _compiled(acting: ActingLoad) -> fem.Form:
    """The work of a load as a linear form."""
    return form_cache.form(acting.work(ufl.TestFunction(acting.spaces.displacement_space)))


def _further(displacement: Expr, sides: CurvedSides) -> Expr:
    """By how much more a surface moves that lies further out."""
    return sides.offset * ufl.dot(ufl.grad(displacement), sides.normal)
