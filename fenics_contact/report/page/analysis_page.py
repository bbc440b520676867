"""Parts of a run's page by an analysis: a section, pictures, animations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import RunRecord


@dataclass(frozen=True)
class AnalysisSection:
    """A section of the page.

    Attributes:
        key: Its address in the page, and the name of its template in the folder of the analysis.
        name: Its heading.
        values: What the template has names for.
    """

    key: str
    name: str
    values: Mapping[str, object]


class AnalysisPage:
    """Part of a run's page by an analysis, ``PAGE`` of the module ``page`` of its folder."""

    def section(self, result: RunRecord) -> AnalysisSection | None:
        """Its section, where it has something to say.

        Args:
            result: The content of ``result.json``.
        """
        return None

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        """Draw what the files of a run show of it.

        Args:
            run: The run.

        Raises:
            InputError: A display is missing; says what to install.
        """
        return iter(())

    def write_own(self, folder: Path) -> Path:
        """Write a page of its own, of the file that ``Analysis.page_of`` names.

        Args:
            folder: Where the file is.

        Returns:
            The path of the page.

        Raises:
            InputError: A file is missing or damaged, or a library is.
            MachineError: The page could not be written.
        """
        raise NotImplementedError

    def animations(self, run: RunToDraw) -> Iterator[Picture]:
        """Draw what moves, which papers cannot have.

        Args:
            run: The run.
        """
        return iter(())
