"""Answers of a study and their table for the page that explores; for the thread that solves."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.wording import one_line
from fenics_contact.explore.messages import Message
from fenics_contact.explore.shape import BodyShape
from fenics_contact.quantities import table
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, has_true_value, measured_by
from fenics_contact.results.check_messages import failure
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.quantities import idle_quantities
from fenics_contact.results.records.contacts import ContactRecord, PreloadRecord
from fenics_contact.results.records.record import NO_UNITS, Errors, Quantities, UnitsRecord
from fenics_contact.results.result import Result
from fenics_contact.results.rounding import rounded, sizes_of
from fenics_contact.scene.quantity_names import OF_PRELOADS
from fenics_contact.simulation.description import units_of
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.quick_answers import Answer
from fenics_contact.simulation.studies.study import Study

# What a row says where bars are made when one lets go.
_LATER = ""


@dataclass(frozen=True)
class Numbers:
    """The numbers of an answer, whole or quick.

    Attributes:
        quantities: Of the whole model.
        contacts: Each contact, with its own.
        preloads: By name.
        reactions: Of the supports of each name, with errors; of a whole answer.
        errors: Of the whole model's quantities.
        has_bars: Whether errors were estimated as far as the scene asks for it.
    """

    quantities: Quantities
    contacts: Sequence[ContactRecord]
    preloads: Mapping[str, PreloadRecord]
    reactions: Mapping[str, Any] = field(default_factory=dict)
    errors: Errors = field(default_factory=dict)
    has_bars: bool = False

    @classmethod
    def of_answer(cls, answer: Answer, records: Sequence[ContactRecord]) -> Numbers:
        """Return the numbers of a quick answer.

        Args:
            answer: That converged.
            records: Of its contacts, without numbers.
        """
        contacts = [
            dataclasses.replace(record, quantities=found, errors={})
            for record, found in zip(records, answer.contacts, strict=True)
        ]
        return cls(answer.quantities, contacts, answer.preloads)

    @classmethod
    def of_result(cls, result: Result) -> Numbers:
        """Return the numbers of a whole answer."""
        return cls(
            result.quantities,
            result.contacts,
            result.preloads,
            result.reactions if len(result.reactions) > 1 else {},
            result.errors,
            has_bars=bool(result.errors),
        )


def rows_of(
    numbers: Numbers, points: ContactPoints | None, units: UnitsRecord | None
) -> list[list[str]]:
    """Name, value, bar and unit of each, those of a contact, support or preload with its name.

    Args:
        numbers: Of an answer.
        points: Its contact points.
        units: Of the scene, if any.
    """
    idle = idle_quantities(numbers.contacts)
    if points is not None and points.friction_traction.any():
        idle = {name for name in idle if not _needs_friction(name)}
    rows = _Rows(units or NO_UNITS, numbers, idle)
    found = list(rows.of("", numbers.quantities, numbers.errors))
    for contact in numbers.contacts if len(numbers.contacts) > 1 else ():
        found += rows.of(contact.name, contact.quantities, contact.errors)
    for name, reaction in numbers.reactions.items():
        for key, value in reaction.quantities.items():
            said = f"{key.replace('_', ' ')} of {one_line(name)}"
            found.append(rows.row(said, table.measured_by(key), value, key, reaction.errors))
    for name, preload in numbers.preloads.items():
        for key in OF_PRELOADS:
            words = f"{key} of {one_line(name)}"
            found.append(
                rows.row(words, MEASURED_BY_PRELOADS[key], preload[key], key, preload.errors)
            )
    return found


def _needs_friction(name: str) -> bool:
    row = table.find(name)
    return row is not None and row.needs == "friction"


class _Rows:
    """Makes the rows of an answer."""

    def __init__(self, units: UnitsRecord, numbers: Numbers, idle: set[str]) -> None:
        self._units, self._numbers, self._idle = units, numbers, idle
        self._sizes = sizes_of(numbers.quantities, numbers.contacts)
        self._order = {one.name: place for place, one in enumerate(table.every())}

    def of(self, owner: str, quantities: Quantities, errors: Errors) -> Iterator[list[str]]:
        """Yield the rows of the whole model, or of a contact among several."""
        several = len(self._numbers.contacts) > 1
        last = len(self._order)
        for name in sorted(quantities, key=lambda name: self._order.get(name, last)):
            value = quantities[name]
            if value is None or name in self._idle or not has_true_value(name):
                continue
            if not owner and several and name in table.resultants_of_contacts():
                continue
            words = name.replace("_", " ") + (f" of {one_line(owner)}" if owner else "")
            yield self.row(words, measured_by(name), value, name, errors)

    def row(self, words: str, measured: str, value: Any, name: str, errors: Errors) -> list[str]:
        """One of them."""
        shown, bar = rounded(value, errors.get(name), self._sizes[measured])
        if not self._numbers.has_bars:
            bar = _LATER
        return [words, shown, f"± {bar}" if bar not in ("", "?") else bar, self._units.of(measured)]


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
        self._shape: BodyShape | None = None
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
            self._shape = BodyShape(run.problem, points, self._records)
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
