"""The page of a run, one file that needs nothing else to be shown, and the parts that analyses add.

A section is a template of its name and a line in ``SECTIONS``; analyses bring their own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from markupsafe import Markup

from fenics_contact.analyses import registry
from fenics_contact.common import program
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.page import tables
from fenics_contact.report.page.templates import render, style_sheet
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.check_messages import level_rows
from fenics_contact.results.quantities import headlines
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.tables import branch_rows, cycle_rows, cycle_words


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
        """Return the section of the page that an analysis has, None if it has nothing to say.

        Args:
            result: The content of ``result.json``.
        """
        return None

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        """Draw what the files of a run show of it.

        Raises:
            InputError: A display is missing; says what to install.
        """
        return iter(())

    def write_own(self, folder: Path) -> Path:
        """Write a page of its own, of the file that ``Analysis.page_of`` names.

        Returns:
            The path of the page.

        Raises:
            InputError: A file is missing or damaged, or a library is.
            MachineError: The page could not be written.
        """
        raise NotImplementedError

    def animations(self, run: RunToDraw) -> Iterator[Picture]:
        """Draw what moves, which papers cannot have."""
        return iter(())


@dataclass(frozen=True)
class Content:
    """Content of a page.

    Attributes:
        name: Of the run's folder.
        result: The content of its ``result.json``.
        keeps_scene: Whether the folder's ``scene.toml`` is what was solved.
        pictures: What was drawn of the fields.
        convergence: What was drawn of the iterations.
        view: The interactive view, empty where there are no fields.
        slider: Through the load steps, empty where there is one.
    """

    name: str
    result: RunRecord
    keeps_scene: bool
    pictures: list[Picture]
    convergence: list[Picture]
    view: Markup
    slider: Markup = field(default_factory=Markup)


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Attributes:
        key: Its address in the page, and its template's name.
        name: Its heading.
        is_there: Whether a run has something to say there.
    """

    key: str
    name: str
    is_there: Callable[[Content], bool] = lambda content: True


SECTIONS = (
    Section("advice", "What to try", lambda content: not content.result.converged),
    Section("pictures", "Pictures", lambda content: bool(content.pictures)),
    Section("view-3d", "Interactive view", lambda content: bool(content.view)),
    Section(
        "checks",
        "Checks",
        lambda content: bool(
            content.result.checks
            or branch_rows(content.result.branches)
            or level_rows(content.result)
        ),
    ),
    Section("quantities", "Quantities and errors", lambda content: bool(content.result.quantities)),
    Section("cycles", "Cycles", lambda content: content.result.cycles is not None),
)
# After those of the analyses.
_LAST_SECTIONS = (
    Section("scene", "Scene"),
    Section("model", "Model"),
    Section("contacts", "Contacts", lambda content: bool(content.result.contacts)),
    Section("iterations", "Iterations", lambda content: bool(content.result.steps)),
    Section("timings", "Time"),
    Section("versions", "Versions"),
    Section("cite", "How to cite"),
    Section("reproduce", "How to reproduce"),
)


def page(content: Content) -> str:
    """The whole page."""
    result = content.result
    last = result.steps[-1] if result.steps else None
    parts = registry.parts_of_result(result, "page")
    of_analyses = [section for part in parts if (section := part.PAGE.section(result))]
    imbalances = [f"{x:.3e}" for x in last.imbalances] if last else []
    return render(
        "page.html",
        content=content,
        result=result,
        sections=[
            *(section for section in SECTIONS if section.is_there(content)),
            *of_analyses,
            *(section for section in _LAST_SECTIONS if section.is_there(content)),
        ],
        tables=tables,
        program=program,
        title=result.title or content.name,
        style=style_sheet(),
        outcome=_outcome(result),
        headlines=headlines(result),
        failures=tables.failures(result),
        attempts=last.attempts if last else [],
        branches=branch_rows(result.branches, result.units),
        levels=level_rows(result),
        cycle_words=cycle_words(result.cycles).strip(),
        cycles=cycle_rows(result.cycles, result.units),
        last_imbalances=", ".join(imbalances) or "none",
        ranks=result.model.ranks,
        is_of_script=result.scene.startswith("# This file cannot be run"),
        **{name: value for section in of_analyses for name, value in section.values.items()},
    )


def _outcome(result: RunRecord) -> str:
    """In a few words what came out."""
    wrong = tables.failures(result)
    if result.passed:
        return f"✓ OK: converged, and all {len(result.checks)} checks passed"
    if not result.converged:
        return "✗ Not converged"
    if wrong:
        return f"✗ Not to be trusted: {len(wrong)} of {len(result.checks)} checks failed"
    return "✗ Not as accurate as was asked for"
