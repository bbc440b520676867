"""Cycles that wear in a run: they are computed or passed over, and their tables are written."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

from fenics_contact.analyses.wear_cycles.driver import CyclesOfRun
from fenics_contact.analyses.wear_cycles.worn_files import WornFiles
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask


class WearCyclesTask(AnalysisTask):
    """Takes the load steps of a run through its cycles, and writes ``wear.csv`` meanwhile."""

    missing = "Cycles that wear were not followed"

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._driver = CyclesOfRun(scene)
        self._files: WornFiles | None = None

    def driver(self) -> CyclesOfRun:
        """Return the driver of the load steps of the run."""
        return self._driver

    def begin_files(self, comm: MPI.Comm, folder: Path, resumed: float | None) -> None:
        """Make ready to write the tables, of which those of earlier cycles are kept."""
        self._files = WornFiles(comm, folder, self._last_cycle(resumed))

    def add_to_files(self) -> None:
        """Append the last cycle to the tables."""
        if self._files is not None and self._driver.last is not None:
            self._files.add(self._driver.last)

    def _last_cycle(self, time: float | None) -> int:
        """Number of the cycle that ends at a pseudo-time; 0 before any.

        Args:
            time: Of its load steps; None before any.
        """
        cycles = self.scene.cycles
        if time is None or cycles is None:
            return 0
        return round((time - cycles.begin) / cycles.repetition.period)


TASK = WearCyclesTask
