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
        tables: Keys of a scene that ask for it.
        records: Keys of ``result.json`` that it fills.
        files: Regular expression of the files that it writes, but for pictures.
        pictures: Regular expression of the names of its pictures, without their endings.
        phase: Name of its time in ``timings``; empty where it has none of its own.
        uses_body: Whether it solves on the body of the answer again, once this is found.
        goes_with: Which of "motion" and "jumps" a scene that asks for it may have: bodies that
            move, cycles that are passed over.
    """

    package: str
    tables: tuple[str, ...]
    records: tuple[str, ...]
    files: str = ""
    pictures: str = ""
    phase: str = ""
    uses_body: bool = False
    goes_with: tuple[str, ...] = ()

    def is_asked(self, scene: Any) -> bool:
        """Whether a scene asks for it."""
        return any(getattr(scene, key, None) for key in self.tables)

    def is_in(self, result: Any) -> bool:
        """Whether a result has something of it."""
        return any(getattr(result, key, None) for key in self.records)

    def part(self, name: str) -> Any:
        """One of its parts, imported now; None where it has no such part.

        Args:
            name: Of a module in its folder.
        """
        module = f"{self.package}.{name}"
        return None if find_spec(module) is None else import_module(module)
