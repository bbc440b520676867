"""Results of a run: plain data, global, the same on any number of ranks."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from fenics_contact.analyses.fretting.places import FrettingPlaces
from fenics_contact.common.errors import StoppedError
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.records.record import described
from fenics_contact.results.records.run import Outcome, RunRecord
from fenics_contact.results.records.steps import CheckRecord


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
        from fenics_contact.results.words.headlines import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        """Return the HTML that notebooks show."""
        from fenics_contact.results.words.headlines import as_html

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
