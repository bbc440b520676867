"""The list of analyses, and those of them that a scene asks for or a result has.

The list has names of modules, which are imported when somebody asks: a list of the analyses
themselves would import all that they need.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import Any, cast

from fenics_contact.analyses.analysis import Analysis

# In the order of the page.
_PACKAGES = [
    "fenics_contact.analyses.fretting",
    "fenics_contact.analyses.vibration",
    "fenics_contact.analyses.stability",
    "fenics_contact.analyses.derivatives",
    "fenics_contact.analyses.wear_cycles",
]


def register(package: str) -> None:
    """Add an analysis to those that there are.

    Args:
        package: Name of a module whose ``ANALYSIS`` says what it is; ``scene.reference`` gives
            scenes its table.
    """
    if package not in _PACKAGES:
        _PACKAGES.append(package)


def unregister(package: str) -> None:
    """Take an analysis out that was added."""
    _PACKAGES.remove(package)


def every() -> list[Analysis]:
    """All analyses, without their parts."""
    return [cast(Analysis, import_module(package).ANALYSIS) for package in _PACKAGES]


def asked_by(scene: Any) -> list[Analysis]:
    """Return the analyses that a scene asks for."""
    return [analysis for analysis in every() if analysis.is_asked(scene)]


def takes_steps_of(scene: Any) -> Analysis | None:
    """The analysis that takes the load steps of a scene in its own way, if it asks for one."""
    return next((analysis for analysis in asked_by(scene) if analysis.own_steps), None)


def tables_not_with(scene: Any, what: str) -> list[str]:
    """Keys of a scene by which it asks for what does not go with something else that it has.

    Args:
        scene: The scene.
        what: "motion" or "own steps".
    """
    refused = [analysis for analysis in asked_by(scene) if what not in analysis.goes_with]
    return [key for analysis in refused for key in analysis.asked_by(scene)]


def parts_of_scene(scene: Any, name: str) -> Iterator[Any]:
    """A part of each analysis that a scene asks for, of those that have such a part.

    Args:
        scene: The scene.
        name: Of the part.
    """
    return _parts(asked_by(scene), name)


def parts_of_result(result: Any, name: str) -> Iterator[Any]:
    """A part of each analysis of which a result has something, of those that have such a part.

    Args:
        result: A result, or the content of ``result.json``.
        name: Of the part.
    """
    return _parts([analysis for analysis in every() if analysis.is_in(result)], name)


def part_of_cycle(end: Any, name: str) -> Any:
    """A part of the analysis that brought the end of a cycle in its own way; None if none did.

    Args:
        end: Of a cycle, as a load step has it; None where it ends none.
        name: Of the part.
    """
    return next(parts_of_result(end, name), None)


def _parts(analyses: list[Analysis], name: str) -> Iterator[Any]:
    found = (analysis.part(name) for analysis in analyses)
    return (part for part in found if part is not None)
