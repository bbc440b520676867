"""All of ``result.json``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from fenics_contact.analyses.derivatives.record import Derivative, Uncertainty
from fenics_contact.analyses.fretting.record import FrettingRecord
from fenics_contact.analyses.stability.record import StabilityRecord
from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.results.records.contacts import (
    ContactRecord,
    PreloadRecord,
    ReactionRecord,
    SlipLimitRecord,
    SupportRecord,
)
from fenics_contact.results.records.cycles import CyclesRecord
from fenics_contact.results.records.model import AccuracyRecord, LevelRecord, Model, Seconds
from fenics_contact.results.records.record import Errors, Quantities, Record, UnitsRecord
from fenics_contact.results.records.steps import BranchRecord, CheckRecord, StepRecord


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(Record):
    """What a run found, but for its checks.

    Attributes:
        title: That of the scene.
        converged: Whether Newton's method and the loop on friction came to an end.
        verdict: In words: whether to trust it, or what went wrong and what to try.
        model: What was solved, and how.
        contacts: Each contact, in scene order.
        supports: Each support.
        reactions: Name → all supports of that name together.
        preloads: Name → preload, where there are any.
        quantities: Of the whole model, at the end; empty without an answer.
        steps: Each load step.
        cycles: What becomes of loads that come again and again, where they do.
        slip_limit: How near parts are to slipping as a whole, where friction may hold some.
        fretting: Where the stress near contacts is worst over a cycle, where it was asked for.
        checks: Name → check of the physics.
        branches: All answers that were found, where the scene asks for others.
        errors: Quantity → source → estimated absolute error, and their `total`; null where it was
            not estimated.
        levels: Meshes on the way; left out where the scene asks for no accuracy.
        accuracy: What it asked for, and whether that was reached.
        derivatives: Quantity → key of the scene → what it depends on it by, where it was asked for.
        uncertainty: Quantity → how far tolerances of the scene let it be off, and its error bar.
        modes: Natural modes about the last state, contacts stuck, where they were asked for.
        damping: What joints damp of them at each amplitude, likewise.
        stability: Whether steady sliding about the last state lasts, where it was asked for.
        further: Name → what an analysis found that is registered from outside.
        error_notes: Sentences that say which errors were not estimated, and why.
        timings: Where the time went.
        versions: Program or library → version.
        units: Of all numbers of its files, where the scene has units.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset(
        {
            *("accuracy", "cycles", "damping", "derivatives", "fretting", "further", "modes"),
            *("preloads", "slip_limit", "stability", "uncertainty", "units"),
        }
    )

    title: str
    converged: bool
    verdict: str
    model: Model
    contacts: list[ContactRecord]
    supports: list[SupportRecord]
    reactions: Mapping[str, ReactionRecord] = field(default_factory=dict)
    preloads: Mapping[str, PreloadRecord] = field(default_factory=dict)
    quantities: Quantities
    steps: list[StepRecord]
    cycles: CyclesRecord | None = None
    slip_limit: SlipLimitRecord | None = None
    fretting: FrettingRecord | None = None
    checks: Mapping[str, Any]
    branches: list[BranchRecord] = field(default_factory=list)
    errors: Errors = field(default_factory=dict)
    levels: list[LevelRecord] = field(default_factory=list)
    accuracy: AccuracyRecord | None = None
    derivatives: Mapping[str, Mapping[str, Derivative]] = field(default_factory=dict)
    uncertainty: Mapping[str, Uncertainty] = field(default_factory=dict)
    modes: list[ModeRecord] = field(default_factory=list)
    damping: list[DampingRecord] = field(default_factory=list)
    stability: StabilityRecord | None = None
    further: Mapping[str, Any] = field(default_factory=dict)
    error_notes: list[str] = field(default_factory=list)
    timings: Seconds
    versions: Mapping[str, str]
    units: UnitsRecord | None = None

    def is_written(self, name: str) -> bool:
        """Whether an attribute stands in the file: levels where an accuracy was asked for."""
        return super().is_written("accuracy" if name == "levels" else name)


@dataclass(frozen=True, eq=False, kw_only=True)
class RunRecord(Outcome):
    """The whole of `result.json`.

    Attributes:
        passed: Whether it converged, to the accuracy asked for, and every check holds.
        scene: Text of the scene that was solved.
    """

    passed: bool
    checks: Mapping[str, CheckRecord]
    scene: str

    def __iter__(self) -> Iterator[str]:
        """Iterate over the keys in the file's order, with ``passed`` after ``converged``."""
        return iter(dict.fromkeys(("title", "converged", "passed", *super().__iter__())))
