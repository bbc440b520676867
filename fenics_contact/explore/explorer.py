"""Answers for the page, from a study; everything here is called by the thread that solves."""

from __future__ import annotations

import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.explore.messages import Message
from fenics_contact.explore.rows import Numbers, rows_of
from fenics_contact.explore.shape import Shape
from fenics_contact.results.check_messages import failure
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.result import Result
from fenics_contact.simulation.description import units_of
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.quick_answers import Answer
from fenics_contact.simulation.studies.study import Study

# Seconds of a back-substitution up to which the body follows while one drags.
_BODY_FOLLOWS = 0.05
_LATELY = 5  # answers that this is measured by

_QUICK = "Quick answer: checks and error bars come when you let go."
_BODY_WAITS = "The body follows when you let go: {:.0f} ms an answer would be too slow."


class Explorer:
    """Asks a study, and says what it answers as messages to the page.

    Args:
        study: What is explored.
    """

    def __init__(self, study: Study) -> None:
        self._study = study
        self._run: Run | None = None
        self._known: Run | None = None  # whose records these are
        self._records: list[ContactRecord] = []
        self._shape: Shape | None = None
        self._seconds: deque[float] = deque(maxlen=_LATELY)

    def follow(self, changes: Mapping[str, Any]) -> Iterator[Message]:
        """The quick answer to changes of the scene, while they are dragged.

        Args:
            changes: As of ``Study.quantities``.

        Raises:
            MachineError: The machine failed.
        """
        try:
            yield from self.begin(changes)
        except (InputError, NotConvergedError) as error:
            yield _nothing(str(error))

    def begin(self, changes: Mapping[str, Any]) -> Iterator[Message]:
        """Solve for the first time, where without an answer there is nothing to go on from.

        Args:
            changes: As of ``follow``.

        Raises:
            InputError: The scene cannot be used, or has no equilibrium.
            NotConvergedError: There is no answer.
            MachineError: The machine failed.
        """
        start = time.perf_counter()
        answer = self._study.quantities(changes, follow=True, checks=False)
        if not answer.converged or answer.points is None:
            raise NotConvergedError(answer.said)
        yield from self._quick(answer, answer.points, changes, start)

    def solve(self, changes: Mapping[str, Any], stopped: Callable[[], bool]) -> Iterator[Message]:
        """The whole answer, with checks and bars; nothing if it was stopped.

        Args:
            changes: As of ``Study.solve``.
            stopped: Whether it is not wanted any more.

        Raises:
            MachineError: The machine failed.
        """
        start = time.perf_counter()
        self._seconds.clear()  # another body, or a machine that is less busy, may be faster
        self._run = None  # its body may be another one from here on
        try:
            run = self._run = self._study.prepare(changes)
            result = run.solve(stopped=stopped)
        except InputError as error:
            yield _nothing(str(error))
            return
        if result.interrupted:
            return
        if not result.converged or result.points is None or run.solution is None:
            yield _nothing(result.verdict)
            return
        yield from self._new_shape(run, result.points)
        displacement = run.solution.displacement
        header = {
            "whole": True,
            "passed": result.passed,
            "said": _said_of(result),
            "rows": rows_of(Numbers.of_result(result), result.points, result.units),
        }
        yield self._answer(header, result.points, displacement, start)

    def _quick(
        self, answer: Answer, points: ContactPoints, changes: Mapping[str, Any], start: float
    ) -> Iterator[Message]:
        if self._run is None:
            self._run = self._study.prepare(changes)
        run = self._run
        yield from self._new_shape(run, points)
        units = units_of(self._study.scene, answer.quantities)
        numbers = Numbers.of_answer(answer, self._records)
        said = [_QUICK, *([answer.said] if answer.said else [])]
        displacement = self._displacement()
        if displacement is None:
            said.append(_BODY_WAITS.format(1e3 * statistics.median(self._seconds)))
        header = {
            "whole": False,
            "start": answer.start,
            "said": said,
            "rows": rows_of(numbers, points, units),
        }
        yield self._answer(header, points, displacement, start)

    def _displacement(self) -> Array | None:
        """Return the displacement of the last quick answer; None where it takes too long."""
        if self._seconds and statistics.median(self._seconds) > _BODY_FOLLOWS:
            return None
        start = time.perf_counter()
        found = self._study.displacement()
        self._seconds.append(time.perf_counter() - start)
        return found

    def _new_shape(self, run: Run, points: ContactPoints) -> Iterator[Message]:
        """Yield the body that the page draws, if it is another than before."""
        if run is not self._known:
            self._known, self._records = run, run.contacts()
        if self._shape is None or not self._shape.is_of(run.problem, points):
            self._shape = Shape(run.problem, points, self._records)
            yield self._shape.message()

    def _answer(
        self,
        header: dict[str, Any],
        points: ContactPoints,
        displacement: Array | None,
        start: float,
    ) -> Message:
        assert self._shape is not None
        arrays: dict[str, Any] = {}
        moved = None
        if displacement is not None:
            moved = np.zeros((len(displacement), 3))
            moved[:, : displacement.shape[1]] = displacement
            arrays["displacement"] = moved[self._shape.nodes]
        for number, places in enumerate(self._shape.contacts):
            for name, values in places.parts(points).items():
                arrays[f"{number}.{name}"] = values
            if moved is not None and places.is_rigid:
                arrays[f"{number}.obstacle"] = places.obstacle(points, moved)
            arrays[f"{number}.zone"] = places.zone(points)
        header["milliseconds"] = round(1e3 * (time.perf_counter() - start), 2)
        return Message("answer", header, arrays)


def with_number(message: Message, number: int) -> Message:
    """A message that says which request it answers."""
    return replace(message, header={**message.header, "number": number})


def _nothing(words: str) -> Message:
    """Why there is no answer; the page keeps the last one."""
    return Message("nothing", {"said": [words]})


def _said_of(result: Result) -> list[str]:
    """The verdict, and what is wrong with each check that failed."""
    wrong = [failure(name, check) for name, check in result.checks.items() if not check.passed]
    return [result.verdict, *wrong]
