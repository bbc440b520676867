"""Data of pictures of several runs: fields, contact points and load steps of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fenics_contact.report.drawing.field_files import whole_body
from fenics_contact.report.drawing.figures import plain
from fenics_contact.report.drawing.style import LINES
from fenics_contact.report.gallery import points_of, scene_of
from fenics_contact.report.run_to_draw import axes_of, far_supports
from fenics_contact.results.comparison.runs import ComparedRun
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.load_history import Drive, History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


@dataclass(frozen=True)
class DrawnRun:
    """A run in pictures of several.

    Attributes:
        number: Among those that are compared.
        name: What it is called there.
        result: The content of its ``result.json``.
        table: That of its ``contact.csv``.
        body: A pyvista grid with the fields of the last step.
        far: Names of supports that are no drives.
    """

    number: int
    name: str
    result: RunRecord
    table: ContactTable
    body: UnstructuredGrid
    far: tuple[str, ...]

    @property
    def look(self) -> dict[str, Any]:
        """Colour, dashes and name of its curves, for matplotlib."""
        colour, dashes = LINES[self.number % len(LINES)]
        return {"color": colour, "linestyle": dashes, "label": plain(self.name)}

    @property
    def history(self) -> History:
        """Its load steps."""
        return History.of(self.result)

    @property
    def drives(self) -> list[Drive]:
        """Drives of the run."""
        return self.history.drives(self.result.contacts, self.far)

    @property
    def axes(self) -> str:
        """Letters of the model's axes."""
        return axes_of(self.result.model.kinematics)

    def contact(self, name: str) -> tuple[ContactTable, ContactRecord] | None:
        """Points and entry of a contact; None where it has none of this name.

        Args:
            name: The contact's.
        """
        found = [one for one in self.result.contacts if one.name == name]
        return (self.table.of(name), found[0]) if found else None


def drawn_runs(runs: Sequence[ComparedRun]) -> list[DrawnRun]:
    """Return the runs that have fields: others have no answer.

    Args:
        runs: That are compared.

    Raises:
        InputError: A file is damaged, or missing beside others.
    """
    found = []
    for number, run in enumerate(runs):
        result = run.result
        if not (result.quantities and (run.folder / "fields.pvd").exists()):
            continue
        body, table = whole_body(run.folder), points_of(run.folder, result)
        far = far_supports(scene_of(run.folder, result))
        found.append(DrawnRun(number, run.name, result, table, body, far))
    return found


def contact_names(runs: Sequence[DrawnRun]) -> list[str]:
    """Names of contacts that two runs or more have.

    Args:
        runs: That are drawn.
    """
    names = [one.name for run in runs for one in run.result.contacts]
    return [name for name in dict.fromkeys(names) if names.count(name) > 1]
