"""By what a saved state is known to be of the same scene and the same mesh."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from fenics_contact import compat
from fenics_contact.mesh import Body
from fenics_contact.scene import Scene

# What may change between a run and one that goes on from it: how to get there.
_FREE = ("title", "steps", "solver", "mesh")


def of_scene(scene: Scene) -> dict[str, str]:
    """A digest of every key of a scene but those that may change."""
    return {
        field.name: _digest(_plain(getattr(scene, field.name)))
        for field in dataclasses.fields(scene)
        if field.name not in _FREE
    }


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def _plain(value: Any) -> Any:
    """A part of a scene as JSON has it; a function by its code and what it encloses."""
    if dataclasses.is_dataclass(value):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    code = getattr(value, "__code__", None)
    if code is None:
        return type(value).__qualname__
    enclosed = [cell.cell_contents for cell in value.__closure__ or ()]
    constants = [c for c in code.co_consts if isinstance(c, int | float | str)]
    return [code.co_code.hex(), constants, list(code.co_names), _plain(enclosed)]


def of_mesh(body: Body) -> str:
    """A number that all coordinates of all cells make, on any number of ranks; collective."""
    mesh = body.mesh
    count = mesh.topology.index_map(mesh.topology.dim).size_local
    original = np.asarray(mesh.topology.original_cell_index[:count], dtype=np.uint64)
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)[:count]]
    bits = np.ascontiguousarray(corners.reshape(count, -1) + 0.0).view(np.uint64)
    with np.errstate(over="ignore"):
        mixed = original * np.uint64(0x9E3779B97F4A7C15)
        for column in bits.T:
            mixed = (mixed ^ column) * np.uint64(0xBF58476D1CE4E5B9)
            mixed ^= mixed >> np.uint64(29)
    found = mesh.comm.allreduce(int(mixed.sum(dtype=np.uint64)) if count else 0)
    return f"{found % 2**64:016x}"
