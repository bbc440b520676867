"""Work of loads on displacements, a file for each kind: tractions, pressures, body forces.

A new kind is a file of its own and a line in ``LAWS``; the key that it is given by is marked with a
``LoadKind`` in ``scene/loading/conditions.py``. ``register`` adds one at run time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.problem.loads.acting_load import ActingLoad
from fenics_contact.problem.loads.body_force import BodyForce
from fenics_contact.problem.loads.given_load import GivenLoad
from fenics_contact.problem.loads.pressure import Pressure
from fenics_contact.problem.loads.traction import Traction
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.reference import add_key, remove_key
from fenics_contact.scene.values import Value

LAWS: dict[str, type[ActingLoad]] = {law.kind: law for law in (Traction, Pressure, BodyForce)}


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


def given_loads(loads: tuple[Load, ...], spaces: Spaces) -> list[GivenLoad]:
    """Return the loads of a scene that are not zero everywhere; collective.

    Raises:
        InputError: The body lacks what a load acts on, or a value cannot be evaluated.
    """
    found = [
        load_of_components(load, load.definition.components(load.value), f"load[{number}]", spaces)
        for number, load in enumerate(loads)
    ]
    return [load for load in found if load is not None]


def load_of_components(
    load: Load, components: Sequence[Value], key: str, spaces: Spaces
) -> GivenLoad | None:
    """Return a load of a scene whose value has other components, as its derivative has; collective.

    Args:
        load: Of the scene.
        components: Those of its value, or their derivatives by a number of it.
        key: Of the load, for messages.
        spaces: Those of the body.

    Returns:
        None where it is zero everywhere.

    Raises:
        InputError: The body lacks what the load acts on, or a value cannot be evaluated.
    """
    law, key_of_value = LAWS[load.kind], f"{key}.{load.kind}"
    group = law.place(load.on, f"{key}.on", spaces)
    nodes = spaces.nodes(group)
    nodal = np.stack(
        [spaces.evaluate(v, nodes, f"{key_of_value}[{i}]") for i, v in enumerate(components)],
        axis=1,
    )
    if spaces.comm.allreduce(int(np.count_nonzero(nodal))) == 0:
        return None
    coefficient = spaces.coefficient(law.field(nodal), nodes)
    acting = law(coefficient, group, spaces, tuple(components), key_of_value)
    name = f"{load.definition.words} on {load.on}"
    return GivenLoad(name, acting, KeyedPath(load.path, f"{key}.path"))
