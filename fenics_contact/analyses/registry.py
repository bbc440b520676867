"""Analyses as far as they are known without importing their parts, and the list of them.

The list of analyses, and those of them that a scene asks for or a result has. The list has names
of modules, which are imported when somebody asks: a list of the analyses themselves would import
all that they need.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, cast


@dataclass(frozen=True)
class Analysis:
    """One of what tables of a scene ask for.

    Attributes:
        package: The folder with its parts, as a module's name.
        tables: Keys of a scene that ask for it, such as ``fretting`` or ``cycles.jumps``.
        records: Keys that it fills, of ``result.json``, of ``further`` there, or of the end of a
            cycle.
        files: Regular expression of the files that it writes at the end, but for pictures.
        step_files: Regular expression of those that grow with the load steps.
        pictures: Regular expression of the names of its pictures, without their endings.
        phase: Name of its time in ``timings``; empty where it has none of its own.
        uses_body: Whether it solves on the body of the answer again, once this is found.
        goes_with: Which of "motion", "own steps", "cyclic symmetry", "heat" and "exact contacts" a
            scene that asks for it may have: bodies that move, load steps that another analysis
            takes in its own way, a sector in place of a ring, temperatures that conduction finds,
            contacts without penalty and smoothing.
        own_steps: Whether it takes the load steps of a run in its own way, which its parts
            ``table``, ``task`` and ``words`` say.
        page_of: Name of the file of which it makes a page of its own; empty where it makes none.
    """

    package: str
    tables: tuple[str, ...]
    records: tuple[str, ...]
    files: str = ""
    step_files: str = ""
    pictures: str = ""
    phase: str = ""
    uses_body: bool = False
    goes_with: tuple[str, ...] = ()
    own_steps: bool = False
    page_of: str = ""

    def asked_by(self, scene: Any) -> list[str]:
        """Keys by which a scene asks for it."""
        return [key for key in self.tables if _value(scene, key)]

    def is_asked(self, scene: Any) -> bool:
        """Whether a scene asks for it."""
        return bool(self.asked_by(scene))

    def is_in(self, result: Any) -> bool:
        """Whether a result, or the end of a cycle, has something of it."""
        further = getattr(result, "further", {})
        return any(getattr(result, key, None) or further.get(key) for key in self.records)

    def part(self, name: str) -> Any:
        """One of its parts, imported now; None where it has no such part.

        Args:
            name: Of a module in its folder.
        """
        module = f"{self.package}.{name}"
        return None if find_spec(module) is None else import_module(module)


def _value(scene: Any, key: str) -> Any:
    """The value at a key, whose parts are joined by dots; None where a table on it is missing."""
    for name in key.split("."):
        scene = getattr(scene, name, None)
    return scene


# In the order of the page.
_PACKAGES = [
    "fenics_contact.analyses.stress_lines",
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
        what: As of ``Analysis.goes_with``.
    """
    refused = [analysis for analysis in asked_by(scene) if what not in analysis.goes_with]
    return [key for analysis in refused for key in analysis.asked_by(scene)]


def parts_of_scene(scene: Any, name: str) -> Iterator[Any]:
    """A part of each analysis that a scene asks for, of those that have such a part."""
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
