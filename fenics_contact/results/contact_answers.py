"""What the laws of a contact answer, as ``result.json`` keeps it for pages and pictures.

Nobody there asks for the name of a law. Results that were written before its answers were have
those of the laws that there were.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fenics_contact.results.point_arrays import PointArray


def pressure_is_given(contact: Mapping[str, Any]) -> bool:
    """Whether the pressure is the scene's, and nothing of it is found.

    Args:
        contact: An entry of ``contacts`` in ``result.json``.
    """
    return bool(_answers(contact).get("pressure_is_given", contact["contact"] == "prescribed"))


def is_rigid(contact: Mapping[str, Any]) -> bool:
    """Whether what stands opposite is not to be entered, so that it is drawn as a solid.

    Args:
        contact: As of ``pressure_is_given``.
    """
    return bool(_answers(contact).get("is_rigid", contact["contact"] in ("unilateral", "bonded")))


def carries_shear(contact: Mapping[str, Any]) -> bool:
    """Whether forces along the surface act: friction, or glue.

    Args:
        contact: As of ``pressure_is_given``.
    """
    return bool(_answers(contact).get("carries_shear", contact["law"] != "none"))


def own_arrays(contact: Mapping[str, Any]) -> tuple[PointArray, ...]:
    """What the laws keep of their own at the points, and files and pictures have.

    Args:
        contact: As of ``pressure_is_given``.
    """
    return tuple(PointArray.from_dict(found) for found in contact.get("arrays", []))


def _answers(contact: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = contact.get("answers", {})
    return found
