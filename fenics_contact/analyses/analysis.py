"""An analysis as far as it is known without importing its parts."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any


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
        goes_with: Which of "motion" and "own steps" a scene that asks for it may have: bodies that
            move, load steps that another analysis takes in its own way.
        own_steps: Whether it takes the load steps of a run in its own way, which its parts
            ``table``, ``task``, ``losses`` and ``words`` say.
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
