"""Fretting in a run: stresses are kept as load steps end, evaluated, and written for ParaView."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.analyses.fretting.criteria_at_places import evaluate_fretting
from fenics_contact.analyses.fretting.history import StressHistory
from fenics_contact.analyses.fretting.record import FrettingPlaces
from fenics_contact.analyses.fretting.words import fretting_words
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers, in_3d
from fenics_contact.common.parallel import on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.simulation.analysis_tasks import AnalysisFinding, AnalysisTask
from fenics_contact.simulation.output.fields import body_of_cells, write_collection, write_grid
from fenics_contact.solve.systems.solution import Solution


class FrettingTask(AnalysisTask):
    """Keeps the stress near contacts along the load steps.

    Attributes:
        history: The stress; None before the first load step.
    """

    missing = "Fretting was not evaluated"
    fields = "Fields of fretting were not written"
    history: StressHistory | None = None

    def begin(self, problem: Problem) -> None:
        """Keep stress from the first load step on."""
        assert self.scene.fretting is not None
        self._problem = problem
        self.history = StressHistory(problem, self.scene.fretting)

    def resumed(self) -> None:
        """Stress of load steps of an earlier run is not known."""
        if self.history is not None:
            self.history.resume()

    def accepted(self, time: float, solution: Solution) -> None:
        """Keep the stress of a load step."""
        self._last = solution
        if self.history is not None:
            self.history.add(time, solution)

    def evaluate(self) -> AnalysisFinding:
        """The criteria of fatigue, and where they are worst."""
        asked, history = self.scene.fretting, self.history
        assert asked is not None and history is not None
        record, places = evaluate_fretting(self._problem, asked, history) or (None, None)
        found = {"fretting": record, "fretting_places": places}
        return AnalysisFinding(found, words=fretting_words(asked, record))

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``fretting.pvd``."""
        if result.fretting_places is not None:
            moved = self._last.displacement
            write_fretting(problem.spaces, result.fretting_places, moved, folder)


TASK = FrettingTask


# Of the body's size, by which a node and a place that are one may differ.
_SAME_PLACE = 1e-9


def write_fretting(
    spaces: Spaces, places: FrettingPlaces, displacement: Array, folder: Path
) -> None:
    """Write ``fretting.pvd``: all criteria at the nodes near contacts; collective.

    Elsewhere they are no numbers, which ParaView leaves blank.

    Args:
        spaces: Of the body.
        places: Where they were evaluated, the same on every rank.
        displacement: Of the last load step, at the nodes of this rank (length).
        folder: Where to.
    """
    numbers = _place_of_nodes(spaces, places)
    is_place = numbers >= 0
    fields = {"displacement": in_3d(displacement)}
    for name, values in places.values.items():
        fields[name] = np.full(len(numbers), np.nan)
        fields[name][is_place] = values[numbers[is_place]]
    fields["plane"] = np.full((len(numbers), 3), np.nan)
    fields["plane"][is_place] = places.planes[numbers[is_place]]
    space, bodies = spaces.displacement_space, body_of_cells(spaces)
    grid = write_grid(folder, "fretting", 1, space, fields, bodies)
    on_root(spaces.comm, lambda: write_collection(folder / "fretting.pvd", {grid: 0.0}))


def _place_of_nodes(spaces: Spaces, places: FrettingPlaces) -> Integers:
    """Number of the place that each node of this rank is, -1 where it is none."""
    found = np.full(len(spaces.coordinates), -1)
    if len(places.coordinates) == 0:
        return found
    parts = np.array(spaces.parts.names)[spaces.parts.of_node]
    for body in set(places.body):
        mine = np.flatnonzero(parts == body)
        there = np.flatnonzero(np.array(places.body) == body)
        tree = cKDTree(places.coordinates[there])
        near, number = tree.query(
            spaces.coordinates[mine], distance_upper_bound=_SAME_PLACE * spaces.size
        )
        same = np.isfinite(near)
        found[mine[same]] = there[number[same]]
    return found
