"""Load steps and their cycles, checks of the physics, and other answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from fenics_contact.analyses.wear_cycles.record import WornCycleEnd
from fenics_contact.results.records.contacts import (
    BranchContact,
    PreloadRecord,
    StepContact,
    SupportRecord,
)
from fenics_contact.results.records.record import ErrorRow, Quantities, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class CycleEnd(Record):
    """How the end of a cycle compares with that of the one before.

    Attributes:
        number: Of the cycle, counted from 1.
        change: Of the tractions, over the largest of the cycle; null where there is none to compare
            with.
        advance: Mean by which points that touched slipped on in the cycle, of the contact where it
            is largest; null likewise (length).
        kind: `shakedown` where friction loses nothing any more, `steady loop` where every cycle
            loses the same, `ratchetting` where slip grows by the same in each; empty as long as
            the loop is not closed.
        is_kept_changing: Whether what laws keep at the points, such as wear, has changed as well,
            so that the loop cannot be closed.
        worn: What it has brought, where cycles that wear are passed over.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"worn"})

    number: int
    change: float | None
    advance: float | None
    kind: str
    is_kept_changing: bool = False
    worn: WornCycleEnd | None = None

    @property
    def is_closed(self) -> bool:
        """Whether the next cycle repeats this one."""
        return bool(self.kind)


@dataclass(frozen=True, eq=False, kw_only=True)
class LoopRecord(Record):
    """Loop of force against displacement in a cycle, of one driven support, load or obstacle.

    Attributes:
        drive: What is moved, in words.
        displacement: How far, at its begin and after each load step (length).
        force: On the body there, likewise (force).
        work: Area of the loop: what this drive puts in (energy).
    """

    drive: str
    displacement: list[float]
    force: list[float]
    work: float


@dataclass(frozen=True, eq=False, kw_only=True)
class CycleRecord(CycleEnd):
    """A cycle of loads that was computed.

    Attributes:
        steps: Numbers of its first and last load step, counted from 1.
        loss: What friction dissipates in it (energy).
        work: What loads, supports and obstacles do in it; null where cycles are passed over
            (energy).
        contacts: Name of a contact → what friction dissipates there (energy).
        loops: Force against displacement of what is moved.
        errors: Estimated errors of the loss.
        contact_errors: Name of a contact → those of what friction dissipates there.
    """

    steps: list[int]
    loss: float
    work: float | None
    contacts: Quantities
    loops: list[LoopRecord] = field(default_factory=list)
    errors: ErrorRow = field(default_factory=dict)
    contact_errors: Mapping[str, ErrorRow] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class CyclesRecord(Record):
    """All cycles of a run.

    Attributes:
        kind: What becomes of the loop, as of its last cycle.
        closed_in: Number of the cycle that repeats the one before; null where none does.
        number: How many the scene has.
        computed: How many were computed; those after repeat the last, where none is passed over.
        loss: What friction dissipates in all of them, with those that repeat or are passed over
            (energy).
        each: Those that were computed.
        errors: Estimated errors of the loss of all: as far as their causes are the same in each
            cycle, they add up.
    """

    kind: str
    closed_in: int | None
    number: int
    computed: int
    loss: float
    each: list[CycleRecord]
    errors: ErrorRow = field(default_factory=dict)


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
        unstable_motions: In finite strains, how many motions would grow by themselves at its end,
            if any.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset(
        {"preloads", "loads", "cycle", "unstable_motions"}
    )
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
    unstable_motions: int | None = None

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
