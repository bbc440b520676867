"""Cycles of loads: what each lost, and what becomes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from fenics_contact.analyses.wear_cycles.record import WornCycleEnd
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
    """What is moved in a cycle against the force that it takes, of its load steps.

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
