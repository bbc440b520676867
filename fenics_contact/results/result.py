"""Results of a run: plain data, global, the same on any number of ranks; and their file."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from fenics_contact.analyses.fretting.record import FrettingPlaces
from fenics_contact.common.errors import InputError, StoppedError
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.records.record import described
from fenics_contact.results.records.run import Outcome, RunRecord
from fenics_contact.results.records.steps import CheckRecord, StepRecord


@dataclass(frozen=True)
class Check:
    """A physics check: passed while the value stays at or below its limit.

    Attributes:
        value: Dimensionless.
        limit: What a right solution keeps.
        contact: The contact that comes nearest to failing; empty where it is of the whole.
        place: The point there, undeformed, (3,) (length); empty where it is of no point.
        kind: Which of several comparisons it is, by its name in ``check_messages``.
        part: The connected part of the body that it is of.
        parts: The check of every part, where there are several.
        unmade: Why it could not be made, in words; then its value is not a number.

    >>> Check(value=1e-12, limit=1e-9).passed, Check(value=float("nan"), limit=1).passed
    (True, False)
    """

    value: float
    limit: float
    contact: str = ""
    place: tuple[float, ...] = ()
    kind: str = ""
    part: str = ""
    parts: tuple[Check, ...] = ()
    unmade: str = ""

    @property
    def passed(self) -> bool:
        """Whether it holds; a value that is not a number fails."""
        return bool(self.value <= self.limit)

    def record(self) -> CheckRecord:
        """For ``result.json``; what it compares and where it comes nearest is told once it fails.

        While it passes, that is often round-off, here or there.
        """
        parts = {part.part: part.record() for part in self.parts}
        found = CheckRecord(value=self.value, limit=self.limit, passed=self.passed, parts=parts)
        if self.passed:
            return found
        kind, contact, part = self.kind, self.contact, self.part
        return replace(found, kind=kind, contact=contact, part=part, place=list(self.place))

    def as_dict(self) -> dict[str, Any]:
        """Return the check as a dictionary."""
        return self.record().as_dict()


def check_of(record: CheckRecord) -> Check:
    """A check as ``result.json`` has it; a value that is not a number is null there."""
    value = math.nan if record.value is None else record.value
    return Check(
        value=value,
        limit=record.limit or 0.0,
        contact=record.contact,
        place=tuple(record.place),
        kind=record.kind,
        part=record.part,
    )


@described
@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Result(Outcome):
    """A run's outcome; its attributes are the keys of ``result.json``.

    There ``scene`` stands besides, the text of the scene that was solved, and ``passed``.

    Numbers are global: the same on every rank, and on any number of ranks.

    Attributes:
        points: The rows of ``contact.csv``; None if no load step was accepted.
        fretting_places: Those of ``fretting.csv``; None where there are none.
        interrupted: Whether the user stopped the run; not among the keys.
    """

    checks: Mapping[str, Check]
    points: ContactPoints | None = None
    fretting_places: FrettingPlaces | None = None
    interrupted: bool = False

    def __repr__(self) -> str:
        from fenics_contact.results.quantities import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show."""
        from fenics_contact.results.quantities import as_html

        return as_html(self)

    @property
    def passed(self) -> bool:
        """Whether it converged, to the accuracy asked for, and every check holds."""
        return (
            self.is_accurate
            and self.converged
            and all(check.passed for check in self.checks.values())
        )

    @property
    def is_accurate(self) -> bool:
        """Whether the accuracy was reached, if one was asked for."""
        return self.accuracy is None or self.accuracy.reached

    @property
    def exit_code(self) -> int:
        """0 passed, 3 not converged (or not to an accuracy), 4 a check failed, 130 interrupted."""
        if self.interrupted:
            return StoppedError.exit_code
        if not (self.converged and self.is_accurate):
            return 3
        return 0 if self.passed else 4

    def __iter__(self) -> Iterator[str]:
        """The keys of ``result.json`` that it has."""
        others = ("points", "fretting_places", "interrupted")
        return (key for key in super().__iter__() if key not in others)

    def record(self, scene: str) -> RunRecord:
        """Return the content of ``result.json``.

        Args:
            scene: Text of the scene that was solved.
        """
        found = {one.name: getattr(self, one.name) for one in fields(Outcome)}
        checks = {name: check.record() for name, check in self.checks.items()}
        return RunRecord(**found | {"checks": checks}, passed=self.passed, scene=scene)

    def as_dict(self) -> dict[str, Any]:
        """Return the content of ``result.json``, without the scene."""
        found = self.record(scene="").as_dict()
        del found["scene"]
        return found


@cache
def _reader_of(kind: Any) -> TypeAdapter[Any]:
    """Made when first needed: a run that reads no file does without."""
    return TypeAdapter(kind)


def read_result(folder: Path) -> RunRecord:
    """The content of a run's ``result.json``.

    Raises:
        InputError: There is none, or it is not one of this program; says what is wrong.
    """
    path = folder / "result.json"
    try:
        return record_of(json.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValidationError as error:
        raise InputError(f"{path}: not a result of this program: {_said(error)}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a result of this program: {error}") from None


def record_of(content: Any) -> RunRecord:
    """Return the record of the content of a ``result.json``.

    Raises:
        ValidationError: It is not one of this program.
    """
    reader: TypeAdapter[RunRecord] = _reader_of(RunRecord)
    return reader.validate_python(content)


def steps_of(content: list[dict[str, Any]]) -> list[StepRecord]:
    """Load steps as they stand in a file.

    Raises:
        ValidationError: They are not those of this program.
    """
    reader: TypeAdapter[list[StepRecord]] = _reader_of(list[StepRecord])
    return reader.validate_python(content)


def _said(error: ValidationError) -> str:
    """The first thing that is wrong, and where."""
    first = error.errors(include_url=False)[0]
    place = ".".join(map(str, first["loc"]))
    if first["type"] == "missing":
        return f"it lacks the key '{place}'"
    return f"{place or 'the whole'}: {first['msg'][0].lower()}{first['msg'][1:]}"
