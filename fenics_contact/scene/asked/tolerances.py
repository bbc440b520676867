"""The part of a scene that says how well its numbers are known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fenics_contact.scene.asked.accuracy import flat_names


def as_tolerances(value: Any) -> Any:
    """Keys, in quotes or dotted, and how far each number may be off either way.

    >>> as_tolerances({"contact": {"0": {"friction_coefficient": 0.05}}})
    {'contact.0.friction_coefficient': 0.05}
    """
    if not isinstance(value, Mapping):
        raise ValueError("must be a table of keys, such as 'contact.0.friction_coefficient' = 0.05")
    found: dict[str, Any] = {}
    for name, tolerance in flat_names(value):
        if name in found:
            raise ValueError(f"'{name}' is given twice")
        found[name] = tolerance
    return found
