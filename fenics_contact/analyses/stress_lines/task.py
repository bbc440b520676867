"""Stress and strain along lines in a run: those of the last load step."""

from __future__ import annotations

from itertools import pairwise
from typing import TypeVar

import numpy as np

from fenics_contact.analyses.stress_lines.record import line_record
from fenics_contact.analyses.stress_lines.words import words_on_outside
from fenics_contact.common.arrays import Array, Flags, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.evaluate.stress_at_places import COMPONENTS, StressAtPlaces, components_of
from fenics_contact.evaluate.temperatures import TemperaturesInBody
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.analysis_tasks import AnalysisFinding, AnalysisTask
from fenics_contact.solve.systems.solution import Solution

Values = TypeVar("Values", Array, Flags)


class StressLinesTask(AnalysisTask):
    """Finds the stress along all lines of the scene once the last load step is solved."""

    missing = "The stress along lines was not found"

    def require(self, problem: Problem) -> None:
        """Refuse a line none of whose points is in the body."""
        places = [_places(line.from_, line.to, line.points) for line in self.scene.line]
        self._places, self._problem = places, problem
        self._solution: Solution | None = None
        self._found: tuple[Solution, AnalysisFinding] | None = None
        every = np.concatenate(places)
        self._stress = StressAtPlaces(problem, every)
        given = problem.scene.has_temperatures
        self._temperatures = TemperaturesInBody(problem, every) if given else None
        for number, inside in enumerate(self._of_lines(self._stress.inside)):
            if not inside.any():
                line = self.scene.line[number]
                raise InputError(
                    f"line[{number}]: none of its points, from {list(line.from_)} to "
                    f"{list(line.to)}, is in the body"
                )

    def accepted(self, time: float, solution: Solution) -> None:
        """Remember the last load step."""
        self._solution = solution

    def evaluate(self) -> AnalysisFinding:
        """The stress in the last load step, found once: estimates of errors change the problem."""
        if self._solution is None:
            raise InputError("no load step was solved in this run, so start without --resume")
        if self._found is None or self._found[0] is not self._solution:
            self._solution.find_body()
            self._found = self._solution, self._finding()
        return self._found[1]

    def _finding(self) -> AnalysisFinding:
        stresses = self._of_lines(self._stress.stress())
        strains, named = self._of_lines(self._stress.strain()), self._by_name
        insides = self._of_lines(self._stress.inside)
        heat: list[Array | None] = [None] * len(insides)
        if self._temperatures is not None:
            heat = [*self._of_lines(self._temperatures.values())]
        rows = zip(self.scene.line, self._places, insides, stresses, strains, heat, strict=True)
        lines = [
            line_record(line.name, places, inside, named(stress), named(strain), temperature)
            for line, places, inside, stress, strain, temperature in rows
        ]
        return AnalysisFinding({"lines": lines}, words=words_on_outside(lines))

    def _of_lines(self, values: Values) -> list[Values]:
        """Values at all points, (points, …), line by line."""
        ends = np.cumsum([0, *(line.points for line in self.scene.line)])
        return [values[begin:end] for begin, end in pairwise(ends)]

    def _by_name(self, tensor: Array) -> dict[str, Array]:
        """Stress or strain by component."""
        names = components_of(self._problem.spaces.components)
        return {name: tensor[:, COMPONENTS[name][0], COMPONENTS[name][1]] for name in names}


def _places(begin: tuple[float, ...], end: tuple[float, ...], points: int) -> Array:
    """Points of a line, evenly spaced, (points, 3) (length)."""
    shares = np.linspace(0.0, 1.0, points)[:, None]
    return in_3d((1 - shares) * np.array(begin) + shares * np.array(end))


TASK = StressLinesTask
