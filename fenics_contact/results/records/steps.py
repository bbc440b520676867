"""Load steps, checks of the physics, and other answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from fenics_contact.results.records.contacts import (
    BranchContact,
    PreloadRecord,
    StepContact,
    SupportRecord,
)
from fenics_contact.results.records.cycles import CycleEnd
from fenics_contact.results.records.record import Quantities, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class Largest(Record):
    """A largest value, and where it is.

    Attributes:
        value: A share, or an angle in radian.
        on: The surface that has it.
        part: Or the connected part or material that has it.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"on", "part"})

    value: float | None
    on: str | None = None
    part: str | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadRecord(Record):
    """A given load at the end of a load step: its work is ∫ force d(displacement).

    Attributes:
        name: Kind, and what it acts on.
        force: Sum of the sizes of its nodal forces, < 0 where its factor is (force).
        displacement: Mean of the displacements along these, weighed by them (length).
    """

    name: str
    force: float
    displacement: float


@dataclass(frozen=True, eq=False, kw_only=True)
class StepRecord(Record):
    """A load step; of one that has no answer, only how far it came.

    Attributes:
        load_factor: Pseudo-time at its end.
        newton_iterations: Steps of Newton's method since the load step before: of all ways that
            were tried, also of load steps that were cut.
        outer_iterations: Passes of the loop on the pressure.
        outer_contraction: What a pass multiplies differences by; null where there is no loop.
        attempts: Strategies that did not converge before, each with what happened.
        residual_history: Imbalance of forces before each iteration, and at the end (force).
        imbalance_limit: Imbalance that is accepted (force).
        quantities: Of the whole model; empty without an answer.
        contacts: Each contact at its end.
        supports: Each support at its end.
        preloads: Name → preload at its end, where there are any.
        loads: Each given load at its end, where there are any and several load steps.
        linear_range: What linear theory takes to be small → its largest value: `strain`,
            `rotation`, `turned` and others.
        cycle: What the cycle of loads that ends with it has brought, if one does.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"preloads", "loads", "cycle"})
    _OF_ANSWERS: ClassVar[frozenset[str]] = frozenset(
        {"outer_contraction", "imbalance_limit", "contacts", "supports", "linear_range"}
    )

    load_factor: float
    newton_iterations: int
    outer_iterations: int
    outer_contraction: float | None = None
    attempts: list[str] = field(default_factory=list)
    residual_history: list[float | None] = field(default_factory=list)
    imbalance_limit: float | None = None
    quantities: Quantities
    contacts: list[StepContact] = field(default_factory=list)
    supports: list[SupportRecord] = field(default_factory=list)
    preloads: Mapping[str, PreloadRecord] = field(default_factory=dict)
    loads: list[LoadRecord] = field(default_factory=list)
    linear_range: Mapping[str, Largest] = field(default_factory=dict)
    cycle: CycleEnd | None = None

    @property
    def imbalances(self) -> list[float]:
        """The residual history without what was not a number, which is null in the file."""
        return [size for size in self.residual_history if size is not None]

    def is_written(self, name: str) -> bool:
        """Whether an attribute stands in the file: those of an answer where there is one."""
        has_answer = bool(self.quantities)
        return super().is_written(name) and (has_answer or name not in self._OF_ANSWERS)


@dataclass(frozen=True, eq=False, kw_only=True)
class CheckRecord(Record):
    """A check of the physics; what it compares and where is written of one that failed.

    Attributes:
        value: Dimensionless; null where it is not a number.
        limit: What a right solution keeps.
        passed: Whether the value is at or below its limit.
        parts: The check of every connected part, where there are several.
        kind: Which of several comparisons it is.
        contact: The contact that comes nearest to failing.
        part: The connected part that it is of.
        place: The point there, undeformed, a vector (length).
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"parts", "kind", "contact", "part", "place"})

    value: float | None
    limit: float | None
    passed: bool
    parts: Mapping[str, CheckRecord] = field(default_factory=dict)
    kind: str = ""
    contact: str = ""
    part: str = ""
    place: list[float] = field(default_factory=list)


@dataclass(frozen=True, eq=False, kw_only=True)
class BranchRecord(Record):
    """One of several answers of the last load step, the first of which is that of the run.

    Attributes:
        start: Where it was found from, in words.
        newton_iterations: Steps of Newton's method.
        passed: Whether every check holds.
        quantities: Of the whole model.
        contacts: Each contact.
    """

    start: str
    newton_iterations: int
    passed: bool
    quantities: Quantities
    contacts: list[BranchContact] = field(default_factory=list)
