"""The files of a run, read to be drawn."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fenics_contact.report.recognition import AnalyticContact
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord
from fenics_contact.scene.scene import Scene

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


@dataclass(frozen=True)
class RunToDraw:
    """Contents of the files of a run.

    Attributes:
        folder: Where they are.
        result: The content of ``result.json``.
        table: That of ``contact.csv``.
        body: A pyvista grid with the fields of the last step.
        scene: What was solved; None where it was made of what a file cannot hold.
        analytic: Its formulas, if it has some.
    """

    folder: Path
    result: RunRecord
    table: ContactTable
    body: UnstructuredGrid
    scene: Scene | None
    analytic: AnalyticContact | None

    @property
    def flat(self) -> bool:
        """Whether the model is plane or axisymmetric."""
        return bool(self.result.model.kinematics != "3D")

    @property
    def axes(self) -> str:
        """Letters of the axes."""
        return axes_of(self.result.model.kinematics)

    @property
    def contacts(self) -> list[tuple[ContactTable, ContactRecord]]:
        """Points and entries of the contacts."""
        return [(self.table.of(contact.name), contact) for contact in self.result.contacts]

    @property
    def far(self) -> tuple[str, ...]:
        """Names of supports that are no drives."""
        return far_supports(self.scene)


def axes_of(kinematics: str) -> str:
    """Letters of the axes of a model."""
    return {"3D": "xyz", "axisymmetric": "rz"}.get(kinematics, "xy")


def far_supports(scene: Scene | None) -> tuple[str, ...]:
    """The outer boundary of a half-space, as supports are called: it moves, but is no drive.

    Args:
        scene: What was solved, if it is known.
    """
    if scene is None or scene.half_space is None:
        return ()
    on = scene.half_space.on
    return (*on, ", ".join(on))
