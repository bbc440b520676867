"""The kind of loads by a force and a moment over a surface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.scene.loading.load_kinds import LoadKind, times
from fenics_contact.scene.values import Kinematics, Value


class ResultantKind(LoadKind):
    """A force and a moment over a surface."""

    def words_of(self, value: Mapping[str, Any]) -> str:
        """``force``, ``moment``, both, or ``bearing load``."""
        if value.get("distribution") == "bearing":
            return "bearing load"
        return " and ".join(key for key in ("force", "moment") if key in value)

    def require(self, value: Mapping[str, Any]) -> None:
        """Refuse a place of a moment, and a moment of a bearing load.

        Raises:
            ValueError: In words.
        """
        if "at" in value and "force" not in value:
            raise ValueError("at: a moment alone has no place; give it without, or give a force")
        if value.get("distribution") == "bearing":
            others = [key for key in ("moment", "at") if key in value]
            if others or "force" not in value:
                extra = others[0] if others else "moment"
                raise ValueError(
                    f"distribution = 'bearing': is the pressure of a force, without {extra}"
                )

    def require_model(self, value: Mapping[str, Any], kinematics: Kinematics, key: str) -> None:
        """Refuse moments of other dimensions, and all but axial forces of axisymmetric models.

        Raises:
            ValueError: In words.
        """
        moment = value.get("moment")
        if kinematics == "axisymmetric":
            others = {"moment", "at"} & value.keys() or value.get("distribution") == "bearing"
            if others or value["force"][0]:
                raise ValueError(
                    f"{key}: an axisymmetric model takes the resultant along its axis alone, over "
                    "the whole turn: force = [0, F], without moment, at and 'bearing'"
                )
        elif kinematics == "3D" and moment is not None and not isinstance(moment, tuple):
            raise ValueError(f"{key}.moment: a 3D model needs a list with an entry for each axis")
        elif kinematics != "3D" and isinstance(moment, tuple):
            raise ValueError(
                f"{key}.moment: a {kinematics} model needs a number, about the axis across it"
            )

    def components(self, value: Mapping[str, Any]) -> tuple[Value, ...]:
        """The force, then the moment."""
        force, moment = _force_and_moment(value)
        return (*force, *moment)

    def vectors(self, value: Mapping[str, Any], key: str) -> dict[str, tuple[Value, ...]]:
        """The force and its place."""
        return {f"{key}.{name}": value[name] for name in ("force", "at") if name in value}

    def times(self, value: Mapping[str, Any], factor: float) -> Any:
        """Force and moment, in the same place."""
        changed = {key: times(value[key], factor) for key in ("force", "moment") if key in value}
        return {**value, **changed}

    def slopes(self, value: Mapping[str, Any], names: Sequence[str]) -> tuple[Value, ...] | None:
        """Slopes of the resultants by a component of either, or by a coordinate of the place."""
        force, moment = (np.zeros(len(each)) for each in _force_and_moment(value))
        place = int(names[1]) if len(names) > 1 else 0
        if names[0] == "at":
            moment = _moment(np.eye(len(force))[place], np.array(value["force"]))
        else:
            {"force": force, "moment": moment}[names[0]][place] = 1.0
        return (*force.tolist(), *moment.tolist())


def _force_and_moment(value: Mapping[str, Any]) -> tuple[Sequence[float], Sequence[float]]:
    """Components of both, zeros of what is not given."""
    force, moment = value.get("force"), value.get("moment")
    if force is None:
        force = (0.0,) * (3 if isinstance(moment, tuple) else 2)
    if moment is None:
        moment = (0.0,) * (3 if len(force) == 3 else 1)
    return force, moment if isinstance(moment, tuple) else (moment,)


def _moment(arm: Array, force: Array) -> Array:
    """Moment of a force, with three components, or in the plane with one."""
    if len(arm) == 3:
        return np.cross(arm, force)
    return np.array([arm[0] * force[1] - arm[1] * force[0]])
