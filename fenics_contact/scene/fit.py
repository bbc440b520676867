"""Conditions that the parts of a scene must fulfil together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fenics_contact.analyses import registry
from fenics_contact.scene.body import MeshSource
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.loading.load_paths import require_cycles
from fenics_contact.scene.loading.motion import require_motion
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import AXES, profiles_of

if TYPE_CHECKING:
    from fenics_contact.scene.scene import Scene

_SAME_TIME = 1e-9


def require_fit(scene: Scene) -> None:
    """Refuse a scene whose parts do not fit each other.

    Args:
        scene: The scene, with numbers in place of texts with units.

    Raises:
        ValueError: They do not, in a sentence that begins with the key.
    """
    _require_vectors(scene)
    _require_model(scene)
    for number, preload in enumerate(scene.preload):
        _require_bolt(scene, preload, f"preload[{number}]")
    if len(scene.mesh) > 1:
        _require_names(scene.mesh)
    _require_distinct("points", [point.name for point in scene.point])
    _require_distinct("contacts", [contact.label for contact in scene.contact])
    _require_distinct("preloads", [preload.label for preload in scene.preload])
    _require_known(scene)
    for require in _OF_TABLES:
        require(scene)
    for part in registry.parts_of_scene(scene, "table"):
        part.require(scene)


def _require_vectors(scene: Scene) -> None:
    """Refuse vectors and profiles that do not have the axes of the model."""
    dimension = scene.dimension
    for number, support in enumerate(scene.support):
        for axis in support.displacement:
            if AXES.index(axis) >= dimension:
                raise ValueError(
                    f"support[{number}].displacement.{axis}: a {scene.kinematics} model has "
                    f"only the axes {', '.join(AXES[:dimension])}"
                )
    vectors: dict[str, Sequence[object]] = {}
    for number, load in enumerate(scene.load):
        vectors |= load.definition.vectors(load.value, f"load[{number}].{load.kind}")
    vectors |= {f"point[{number}].at": point.at for number, point in enumerate(scene.point)}
    for key, vector in vectors.items():
        if len(vector) != dimension:
            raise ValueError(
                f"{key} has {len(vector)} entries; a {scene.kinematics} model needs {dimension}"
            )
    if dimension == 2 and any(profile.along == "z" for profile in profiles_of(scene)):
        raise ValueError(f"a profile along z: a {scene.kinematics} model has only x and y")
    for number, contact in enumerate(scene.contact):
        _require_axes(contact.obstacle, dimension, f"contact[{number}].obstacle")


def _require_model(scene: Scene) -> None:
    """Refuse keys that the kinematic model does not have."""
    if scene.thickness is not None and scene.kinematics != "plane stress":
        raise ValueError(f"thickness is for plane stress, not for {scene.kinematics}")
    if isinstance(scene.thickness, float | int) and scene.thickness <= 0:
        raise ValueError(f"thickness = {scene.thickness:g} must be greater than 0")
    for number, contact in enumerate(scene.contact):
        if contact.friction_law is not None:
            contact.friction_law.require_model(scene.kinematics, f"contact[{number}]")
    if scene.half_space is not None and (scene.load or scene.preload):
        what = "load" if scene.load else "preload"
        raise ValueError(f"half_space: only the contacts' forces reach it, so leave out {what}")
    if scene.half_space is not None and scene.kinematics == "plane stress":
        raise ValueError("half_space is for plane strain, axisymmetric and 3D models")


def _require_bolt(scene: Scene, preload: Preload, key: str) -> None:
    """Refuse a bolt whose axis does not fit the model, or is locked where no load step ends."""
    axis, locked, motion = preload.axis, preload.locked_from, scene.motion
    steps = scene.steps if motion is None else motion.steps
    if len(axis) != scene.dimension:
        raise ValueError(
            f"{key}.axis has {len(axis)} entries; a {scene.kinematics} model needs "
            f"{scene.dimension}"
        )
    if preload.between is not None and not scene.mesh:
        raise ValueError(
            f"{key}.between: only a body of a CAD file can be cut; of a mesh, preload a group of "
            "its cells"
        )
    if scene.kinematics == "axisymmetric" and axis[0] != 0:
        raise ValueError(f"{key}.axis: must be along y, the axis of revolution")
    if locked is None:
        return
    if scene.cycles is None and locked > steps.last * (1 + _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: the last load step ends at {steps.last:g}"
        )
    if motion is not None and motion.start == "static":
        return  # it has been tightened when the motion begins
    ends = steps.all_times if scene.cycles is None else (*steps.all_times, scene.cycles.begin)
    if not steps.automatic and locked < ends[0] * (1 - _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: lies before the end of the first load step, "
            f"{ends[0]:g}, so that no force has tightened it yet"
        )
    if not steps.automatic and min(abs(locked - end) for end in ends) > _SAME_TIME * locked:
        raise ValueError(
            f"{key}.locked_from = {locked:g}: no load step ends there; add it to steps.times"
        )


def _require_known(scene: Scene) -> None:
    """Every quantity that an accuracy is asked of is one of the scene."""
    for name in () if scene.accuracy is None else scene.accuracy.of:
        try:
            scene.names.find(name)
        except ValueError as error:
            raise ValueError(f"accuracy: {error}") from None


def _require_names(meshes: tuple[MeshSource, ...]) -> None:
    """Several meshes are told apart by their names."""
    for number, mesh in enumerate(meshes):
        if not mesh.name:
            raise ValueError(f"mesh[{number}].name is missing: each of several meshes needs one")
    _require_distinct("meshes", [mesh.name for mesh in meshes])


def _require_distinct(things: str, names: Sequence[str]) -> None:
    """Things of one kind are told apart by their names."""
    name, count = Counter(names).most_common(1)[0] if names else ("", 0)
    if count > 1:
        raise ValueError(f"two {things} are called '{name}': give each its own name")


def _require_axes(obstacle: Obstacle | None, dimension: int, key: str) -> None:
    """Vectors of an obstacle have one entry an axis."""
    for name in ("position", "normal", "along", "direction", "displacement"):
        vector = getattr(obstacle, name, None)
        if vector is not None and len(vector) != dimension:
            raise ValueError(f"{key}.{name} has {len(vector)} entries; it needs {dimension}")


# Of tables that not every scene has.
_OF_TABLES = (require_cycles, require_motion)
