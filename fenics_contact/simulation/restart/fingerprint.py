"""By what a saved state is known to be of the same scene and the same mesh."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import ufl

from fenics_contact.body.description import BodyDescription
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import RAMP

# What may change between a run and one that goes on from it: how to get there, what is asked of the
# answer, and what units are called, as numbers are the same in all of them.
_FREE = (
    *("title", "steps", "solver", "mesh", "units"),
    *("derivatives", "tolerances", "fretting", "modes", "damping", "stability"),
)
# Keys that states written before they were there do not know: as long as they have their defaults
# they do not count.
_LATER: dict[str, dict[str, Any]] = {
    "Scene": {"preload": (), "cycles": None, "motion": None},
    "Material": {"density": None},
    "Support": {"name": None},
    "Preload": {"between": None},
    "Contact": {
        "normal_law": None,
        "friction_law": None,
        "interference": 0.0,
        "interference_path": RAMP,
        "wear": None,
    },
    "Cycles": {"jumps": None},
    "Wear": {"share": None},
    "Motion": {"start": "unstressed", "rayleigh": None, "absorbing": ()},
}
# Keys of parts of a scene that may change likewise: how many cycles, and how each is computed.
_FREE_INSIDE: dict[str, tuple[str, ...]] = {
    "Wear": ("share",),
    "Motion": ("end",),
    "Jumps": ("pressure_change", "error", "fixed"),
    "Cycles": ("number", "increments", "until", "tolerance", "keep"),
}
# Where functions are asked: places along each axis of the box around the body, and pseudo-times.
_PLACES = 7
_TIMES = np.linspace(0.0, 5.0, 51).tolist()


def of_scene(scene: Scene, body: Body) -> dict[str, str]:
    """A digest of every key of a scene but those that may change; collective.

    Args:
        scene: Its functions are known by what they give.
        body: Where they are asked.
    """
    probe = _Probe(body)
    return {
        field.name: _digest(probe.plain(getattr(scene, field.name)))
        for field in dataclasses.fields(scene)
        if field.name not in _FREE
        and getattr(scene, field.name) != _LATER["Scene"].get(field.name, ...)
    }


def of_body(description: BodyDescription, body: Body) -> dict[str, str]:
    """The same of all that describes a body besides its mesh; collective.

    Args:
        description: Of the body.
        body: Its mesh.
    """
    probe = _Probe(body)
    names = [field.name for field in dataclasses.fields(description)]
    return {name: _digest(probe.plain(getattr(description, name))) for name in names}


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


class _Probe:
    """Parts of a scene as JSON has them."""

    def __init__(self, body: Body) -> None:
        comm, columns = body.mesh.comm, body.mesh.geometry.x.T
        self._position = ufl.SpatialCoordinate(body.mesh)
        sides = [
            np.linspace(smallest(comm, column), largest(comm, column), _PLACES)
            for column in columns
        ]
        self._points = np.stack(np.meshgrid(*sides, indexing="ij")).reshape(3, -1)

    def plain(self, value: Any) -> Any:
        """A part of a scene."""
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            later = _LATER.get(type(value).__name__, {})
            free = _FREE_INSIDE.get(type(value).__name__, ())
            fields = [f for f in dataclasses.fields(value) if f.compare and f.name not in free]
            parts = {field.name: getattr(value, field.name) for field in fields}
            return {
                name: self.plain(part)
                for name, part in parts.items()
                if name not in later or part != later[name]
            }
        if isinstance(value, Mapping):
            return {str(key): self.plain(entry) for key, entry in value.items()}
        if isinstance(value, list | tuple):
            return [self.plain(entry) for entry in value]
        if value is None or isinstance(value, bool | int | float | str):
            return value
        return self._given_by(value) if callable(value) else type(value).__qualname__

    def _given_by(self, function: Any) -> str:
        """What a function gives: of places, of pseudo-times, or as UFL; else only its name."""
        ways: tuple[Callable[[], str], ...] = (
            lambda: np.asarray(function(self._points), dtype=np.float64).tobytes().hex(),
            lambda: np.array([float(function(t)) for t in _TIMES]).tobytes().hex(),
            lambda: str(function(self._position)),
        )
        for ask in ways:
            try:
                return _digest(ask())
            except Exception:  # whatever a user's function raises, when it is asked amiss
                continue
        return getattr(function, "__qualname__", type(function).__qualname__)


def of_mesh(body: Body) -> str:
    """A number that all coordinates of all cells make, on any number of ranks; collective."""
    mesh = body.mesh
    count = mesh.topology.index_map(mesh.topology.dim).size_local
    original = np.asarray(mesh.topology.original_cell_index[:count], dtype=np.uint64)
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)[:count]]
    bits = np.ascontiguousarray(corners.reshape(count, np.prod(corners.shape[1:])) + 0.0).view(
        np.uint64
    )
    with np.errstate(over="ignore"):
        mixed = original * np.uint64(0x9E3779B97F4A7C15)
        for column in bits.T:
            mixed = (mixed ^ column) * np.uint64(0xBF58476D1CE4E5B9)
            mixed ^= mixed >> np.uint64(29)
    found = mesh.comm.allreduce(int(mixed.sum(dtype=np.uint64)) if count else 0)
    return f"{found % 2**64:016x}"
