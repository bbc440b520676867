"""What an analysis says on the terminal: before a run, and of what came out."""

from __future__ import annotations

from fenics_contact.results.records.run import Outcome
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.names import UnitNames

Rows = list[list[str]]


class AnalysisWords:
    """Words of an analysis, the part ``words`` of its folder has them as ``WORDS``."""

    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        """Lines on what a run will look at, for ``fenics-contact check``.

        Args:
            scene: One that asks for the analysis.
            units: Names of its units, if any.
        """
        return []

    def tables(self, result: Outcome) -> list[Rows]:
        """Tables of what came out, the head of each first.

        Args:
            result: A result that has something of the analysis.
        """
        return []

    def notes(self, result: Outcome) -> list[str]:
        """Sentences on what came out, below the tables.

        Args:
            result: As of ``tables``.
        """
        return []
