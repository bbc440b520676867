"""Loads of a scene: kinds that act on a body, each with its work, with their paths (paper, (1.8)).

A new kind is a class and a line in ``LAWS``; the key that it is given by is marked with a
``LoadKind`` in ``scene/loading/conditions.py``. ``register`` adds one at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from dolfinx import fem

from fenics_contact.problem.loads.acting_load import ActingLoad, LoadSite
from fenics_contact.problem.loads.given_values import BodyForce, Pressure, Traction
from fenics_contact.problem.loads.inertia import Acceleration, Rotation
from fenics_contact.problem.loads.resultant import Resultant
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.reference import add_key, remove_key
from fenics_contact.scene.values import Value

LAWS: dict[str, type[ActingLoad]] = {
    law.kind: law for law in (Traction, Pressure, BodyForce, Resultant, Acceleration, Rotation)
}


def register(law: type[ActingLoad], value: Any) -> None:
    """Add a kind of loads, until the process ends or it is taken out.

    Args:
        law: What a load of the kind does; scenes have a key of the name that is its ``kind``.
        value: Type of that key, which may be None, annotated with its dimension, its ``LoadKind``
            and its description, as the keys of ``Load`` are.

    Raises:
        ValueError: A load has such a key already.
    """
    add_key(Load, law.kind, value)
    LAWS[law.kind] = law


def unregister(kind: str) -> None:
    """Take out a kind that was registered."""
    remove_key(Load, kind)
    del LAWS[kind]


def given_loads(loads: tuple[Load, ...], site: LoadSite) -> list[GivenLoad]:
    """Return the loads of a scene that are not zero everywhere; collective.

    Raises:
        InputError: The body lacks what a load acts on, or a value cannot be evaluated.
    """
    found = [
        load_of_components(load, load.components, f"load[{number}]", site)
        for number, load in enumerate(loads)
    ]
    return [load for load in found if load is not None]


def load_of_components(
    load: Load, components: Sequence[Value], key: str, site: LoadSite
) -> GivenLoad | None:
    """Return a load of a scene whose value has other components, as its derivative has; collective.

    Args:
        load: Of the scene.
        components: Those of its value, or their slopes in a number of it.
        key: Of the load, for messages.
        site: The body.

    Returns:
        None where it is zero everywhere.

    Raises:
        InputError: The body lacks what the load acts on, or a value cannot be evaluated.
    """
    acting = LAWS[load.kind].of(load, components, key, site)
    if acting is None:
        return None
    return GivenLoad(load.words, acting, KeyedPath(load.path, f"{key}.path"))


@dataclass(frozen=True, eq=False)
class GivenLoad:
    """A load of a scene with its path.

    Attributes:
        name: For results.
        acting: The load where the path is 1.
        path: Its factor over pseudo-time.
    """

    name: str
    acting: ActingLoad
    path: Callable[[float], float]

    @cached_property
    def form(self) -> fem.Form:
        """Linear form of its work, compiled; collective when first asked for."""
        return self.acting.compiled()
