"""Digests by which a saved state is known to belong to a scene and a mesh.

Keys that have their defaults do not count. A default means the same within a version of the
program: whoever changes one, or its meaning, gives state files and saved bodies another format.
Those of format 1 have digests of tables with all keys. Which keys these are is fixed, since that
format is no longer written; a key that a scene class gets later does not belong there.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import ufl

from fenics_contact.body.description import BodyDescription
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.parallel import largest, on_root, smallest
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.given_keys import given_keys, is_free_at_resume
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Path, Profile

# Where functions are asked: places along each axis of the box around the body, and pseudo-times.
_PLACES = 7
_TIMES = np.linspace(0.0, 5.0, 51).tolist()


def keys_of_state(table: Any) -> dict[str, Any]:
    """Return the keys of a table that a saved state depends on, with their values.

    A key that has its default is left out, so that a state can still be resumed when its class has
    got another key since.

    Args:
        table: Of a scene, or a part of the description of a body.
    """
    no_part = {field.name for field in dataclasses.fields(table) if not field.compare}
    return {
        name: value
        for name, value in given_keys(table).items()
        if name not in no_part and not is_free_at_resume(table, name)
    }


def of_scene(
    scene: Scene, body: Body, keys: Callable[[Any], dict[str, Any]] = keys_of_state
) -> dict[str, str]:
    """Return a digest of each key of a scene that a saved state depends on; collective.

    Args:
        scene: Its functions are known by their values.
        body: Functions of position are evaluated in the box around it.
        keys: Returns the keys of a table that count, with their values.
    """
    probe = _Probe(body, keys)
    return {name: _digest(probe.plain(value)) for name, value in keys(scene).items()}


def of_body(description: BodyDescription, body: Body) -> dict[str, str]:
    """Return a digest of each part of what describes a body besides its mesh; collective.

    Args:
        description: Of the body.
        body: Its mesh.
    """
    probe = _Probe(body, keys_of_state)
    return {name: _digest(probe.plain(part)) for name, part in keys_of_state(description).items()}


def differences(ours: Mapping[str, str], theirs: Mapping[str, str]) -> list[str]:
    """Return the names of keys whose digests differ, or that only one of the two has."""
    return [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def _content(file: str) -> str:
    """A digest of a file's content, wherever it lies; its path where it cannot be read any more."""
    try:
        with open(file, "rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError:
        return file


class _Probe:
    """Parts of a scene as JSON has them.

    Args:
        body: Around which functions of position are evaluated.
        keys: Returns the keys of a table that count, with their values.
    """

    def __init__(self, body: Body, keys: Callable[[Any], dict[str, Any]]) -> None:
        comm, columns = body.mesh.comm, body.mesh.geometry.x.T
        self._keys, self._comm = keys, comm
        self._position = ufl.SpatialCoordinate(body.mesh)
        sides = [
            np.linspace(smallest(comm, column), largest(comm, column), _PLACES)
            for column in columns
        ]
        self._points = np.stack(np.meshgrid(*sides, indexing="ij")).reshape(3, -1)

    def plain(self, value: Any) -> Any:
        """Return a part of a scene as JSON has it."""
        if callable(value) and not isinstance(value, Profile | Path):
            return self._given_by(value)
        if isinstance(value, Obstacle) and value.file is not None:
            value = dataclasses.replace(
                value, file=on_root(self._comm, partial(_content, value.file))
            )
        if dataclasses.is_dataclass(value):
            return {name: self.plain(part) for name, part in self._keys(value).items()}
        if isinstance(value, Mapping):
            return {str(key): self.plain(entry) for key, entry in value.items()}
        if isinstance(value, list | tuple):
            return [self.plain(entry) for entry in value]
        if value is None or isinstance(value, bool | int | float | str):
            return value
        return type(value).__qualname__

    def _given_by(self, function: Any) -> str:
        """Return a digest of a function's values or of its UFL; of none of these, its name."""
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


# Of each table, the keys that were in its fingerprint whatever their value.
_KEYS = {
    name: keys.split()
    for name, keys in {
        "Accuracy": "main normal_force pressure_integral friction_force contact_force reaction "
        "max_contact_pressure contact_area stick_area slip_area contact_radius stick_radius "
        "max_slip indentation strain_energy external_work friction_work of max_levels max_dofs",
        "Contact": "pressure pressure_path name contact obstacle against slave penalty_parameter "
        "foundation_stiffness law friction_coefficient regularisation_parameter",
        "Cycles": "begin",
        "Discretisation": "degree",
        "FormulaFriction": "parameters",
        "Load": "traction pressure body_force path",
        "Material": "youngs_modulus poissons_ratio stiffness on",
        "Motion": "velocity modes",
        "MotionModes": "number accuracy",
        "Obstacle": "shape radius inner_radius gap position normal along direction indentation "
        "force displacement path displacement_path",
        "OwnFrictionLaw": "parameters",
        "OwnNormalLaw": "parameters",
        "Path": "cycles",
        "Preload": "path locked_from name",
        "PressureFormula": "parameters",
        "Rayleigh": "mass stiffness",
        "Scene": "thickness discretisation support load contact point symmetry half_space accuracy",
        "Support": "path",
        "Wear": "threshold",
    }.items()
}


def keys_in_format_1(table: Any) -> dict[str, Any]:
    """Return the keys of a table that count in format 1, with their values.

    Args:
        table: Of a scene.
    """
    always = {key: getattr(table, key) for key in _KEYS.get(type(table).__name__, ())}
    return always | keys_of_state(table)
