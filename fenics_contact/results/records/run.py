"""All of ``result.json``; the model, the solver, the meshes and the time that they took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from fenics_contact.analyses.derivatives.record import Derivative, Uncertainty
from fenics_contact.analyses.fretting.record import FrettingRecord
from fenics_contact.analyses.stability.record import StabilityRecord
from fenics_contact.analyses.stress_lines.record import StressLineRecord
from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.results.records.contacts import (
    ContactRecord,
    CouplingRecord,
    PreloadRecord,
    ReactionRecord,
    SectorRecord,
    SlipLimitRecord,
    SupportRecord,
)
from fenics_contact.results.records.record import Errors, Quantities, Record, UnitsRecord
from fenics_contact.results.records.steps import BranchRecord, CheckRecord, CyclesRecord, StepRecord
from fenics_contact.scene.values import Kinematics, Strains


@dataclass(frozen=True, eq=False, kw_only=True)
class RigidMotion(Record):
    """A rigid motion that the supports leave free.

    Attributes:
        motion: What moves how, in words.
        bodies: Connected parts that take part.
        resisted_by: Contacts and stabilisations that may resist it.
    """

    motion: str
    bodies: list[str]
    resisted_by: list[str]


@dataclass(frozen=True, eq=False, kw_only=True)
class Model(Record):
    """The model of a run, and the solver that it had.

    Attributes:
        kinematics: As in the scene.
        degree: Of the displacement's polynomials.
        cell: Shape of the cells.
        bodies: Names of the connected parts.
        cells: Number of cells.
        dofs: Number of displacement unknowns.
        contact_points: Number of rows of `contact.csv`.
        ranks: Number of MPI ranks.
        solver: The linear solver: condensed, full or iterative.
        solver_reason: Why it was chosen.
        solver_memory_mb: Memory that it was expected to need (MB).
        strategy: How friction and pressure are brought together.
        scalar_unknowns: Names of unknowns beside displacements, as the depth of an obstacle.
        terms: The energy terms modelled.
        free_rigid_motions: Number of rigid motions that the supports leave free.
        rigid_motions: These motions.
        stabilised_motions: Those that nothing resisted, and that a stabilisation holds.
        used_share_of_limit_load: Share of all friction that it takes to hold the loads, 1 at the
            limit load.
        symmetry: Planes of symmetry that the model ends in, or `none`.
        time_step: Length of each step of a motion (time).
        free_modes: Number of modes, rigid motions beside, that a motion moves in.
        free_modes_error: How far its contact forces and kinetic energy may be off for lack of
            others, over the largest: the check `free_modes`.
        bulk_factorisations: How often the stiffness of the bodies was factorised.
        strains: `small` or `finite`, as in the scene.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset(
        {"time_step", "free_modes", "free_modes_error", "bulk_factorisations"}
    )

    kinematics: Kinematics
    degree: int = 1
    cell: str = ""
    bodies: list[str] = field(default_factory=list)
    cells: int = 0
    dofs: int = 0
    contact_points: int
    ranks: int = 1
    solver: str = ""
    solver_reason: str = ""
    solver_memory_mb: int = 0
    strategy: str = ""
    scalar_unknowns: list[str] = field(default_factory=list)
    terms: list[str] = field(default_factory=list)
    free_rigid_motions: int = 0
    rigid_motions: list[RigidMotion] = field(default_factory=list)
    stabilised_motions: list[str] = field(default_factory=list)
    used_share_of_limit_load: float = 0.0
    symmetry: str = "none"
    time_step: float | None = None
    free_modes: int | None = None
    free_modes_error: float | None = None
    bulk_factorisations: int | None = None
    strains: Strains = "small"


@dataclass(frozen=True, eq=False, kw_only=True)
class LevelRecord(Record):
    """A mesh on the way to an accuracy.

    Attributes:
        dofs: Number of displacement unknowns.
        cells: Number of cells.
        seconds: What it took (s).
        energy_error: Error of the displacement over it, in the energy norm; null where it is not
            known.
        errors: Quantity asked for → estimated relative error in all.
        sources: Quantity asked for → source → estimated relative error.
    """

    dofs: int
    cells: int
    seconds: float
    energy_error: float | None = None
    errors: Mapping[str, float | None]
    sources: Errors = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class AccuracyRecord(Record):
    """Accuracy that a scene asks for, and whether the run reached it.

    Attributes:
        asked: Quantity → relative error that is allowed.
        reached: Whether all estimated errors are below.
        reason: Why they are not.
        by_energy: Quantities for which meshes were refined by errors in the energy norm, as they
            have no adjoint that would weigh these → why.
    """

    asked: Mapping[str, float]
    reached: bool
    reason: str = ""
    by_energy: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Seconds(Record):
    """Where the time went, of the slowest rank in each phase.

    Attributes:
        mesh: Making or reading meshes (s).
        compile: Compiling forms (s).
        assemble: Assembling matrices and vectors (s).
        factorise: Factorising matrices (s).
        solve: All else of solving (s).
        output: Quantities, checks and files (s).
        errors: Estimating errors (s).
        derivatives: Finding derivatives that the scene asks for (s).
        vibration: Finding modes that the scene asks for, and driving them (s).
        stability: Finding modes of steady sliding that the scene asks for (s).
        total: From the start to the end (s).
    """

    mesh: float = 0.0
    compile: float = 0.0
    assemble: float = 0.0
    factorise: float = 0.0
    solve: float = 0.0
    output: float = 0.0
    errors: float = 0.0
    derivatives: float = 0.0
    vibration: float = 0.0
    stability: float = 0.0
    total: float


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
        couplings: Each face that moves with a point, in scene order, where there are any.
        quantities: Of the whole model, at the end; empty without an answer.
        steps: Each load step.
        cycles: What becomes of loads that come again and again, where they do.
        slip_limit: How near parts are to slipping as a whole, where friction may hold some.
        fretting: Where the stress near contacts is worst over a cycle, where it was asked for.
        lines: Stress along lines in the last load step, where it was asked for.
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
        bias: Quantity → the exact answer, without penalty and smoothing of friction, less this one,
            a number or a list; null where it was not found; left out where it was not looked for.
        error_notes: Sentences that say which errors were not estimated, and why.
        timings: Where the time went.
        versions: Program or library → version.
        units: Of all numbers of its files, where the scene has units.
        cyclic_symmetry: Of a sector of a ring, what acts across its cut, and numbers of the whole.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset(
        {
            *(
                "accuracy",
                "bias",
                "cycles",
                "damping",
                "derivatives",
                "fretting",
                "further",
                "modes",
            ),
            "cyclic_symmetry",
            *("couplings", "lines", "preloads", "slip_limit", "stability", "uncertainty", "units"),
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
    couplings: list[CouplingRecord] = field(default_factory=list)
    quantities: Quantities
    steps: list[StepRecord]
    cycles: CyclesRecord | None = None
    slip_limit: SlipLimitRecord | None = None
    fretting: FrettingRecord | None = None
    lines: list[StressLineRecord] = field(default_factory=list)
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
    bias: Mapping[str, Any] = field(default_factory=dict)
    error_notes: list[str] = field(default_factory=list)
    timings: Seconds
    versions: Mapping[str, str]
    units: UnitsRecord | None = None
    cyclic_symmetry: SectorRecord | None = None

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
