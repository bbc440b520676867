"""What a solve with contact and friction costs, in linear elastic solves on the same mesh.

``python benchmarks/solve_cost.py [--quick] [--json FILE] [--plot DIR] [--case TEXT]``, also under
``mpirun -n N``.

An obstacle is pressed into a block and pulled sideways, so that a part of the contact sticks and
a part slips. Both solves of a row are timed in one process, with all forms compiled, and each is
the least of several: CPU time on one rank, wall time of the slowest on several. Set
``OMP_NUM_THREADS=1``, as ``./bootstrap`` does. ``docs/solve_cost.md`` shows what came out.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import json
import math
import time
import typing
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.bulk_forces import BulkForces
from fenics_contact.figures import new_figure, save
from fenics_contact.newton import Newton
from fenics_contact.parallel import largest, total
from fenics_contact.problem import Problem
from fenics_contact.quantities import contact_quantities, global_quantities, support_reactions
from fenics_contact.scene_values import Path as LoadPath
from fenics_contact.solution import Solution
from fenics_contact.solver_choice import (
    choose_solver,
    contact_unknowns,
    create_system,
    memory_estimate,
    unknowns,
)
from fenics_contact.strategy import solve_steps
from fenics_contact.timings import Timings

# isort: split
import dolfinx
import numpy as np
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from rich.console import Console
from rich.table import Table

T = TypeVar("T")

ELEMENTS = {
    "Q2": ("quadrilateral", 2),
    "P1 tets": ("tetrahedron", 1),
    "P2 tets": ("tetrahedron", 2),
    "Q1 hexes": ("hexahedron", 1),
    "Q2 hexes": ("hexahedron", 2),
}
MARKERS = {"Q2": "o", "P1 tets": "^", "P2 tets": "v", "Q1 hexes": "s", "Q2 hexes": "D"}
GREYS = {"Q2": "0.1", "P1 tets": "0.65", "P2 tets": "0.4", "Q1 hexes": "0.55", "Q2 hexes": "0.1"}

# Every solver that a scene may name, but for the choice among them.
SOLVERS = [
    name
    for name in typing.get_args(typing.get_type_hints(SolverSettings)["solver"])
    if name != "auto"
]
# Dofs from which and up to which a solver is measured, by dimension.
RANGES = {
    ("condensed", 2): (0, 300_000),
    ("condensed", 3): (0, 120_000),
    ("full", 2): (0, 20_000),
    ("full", 3): (0, 25_000),
    ("iterative", 3): (50_000, 500_000),
}
DIRECT = ("condensed", "full")  # the others are compared with an iterative linear solve

# The obstacle's radius, indentation and displacement over a block of width 1: the contact's
# radius is about 0.14, and the inner two thirds of it stick.
RADIUS, INDENTATION, SIDEWAYS, COEFFICIENT = 1.0, 0.02, 0.004, 0.3
HALF_WIDTH = 0.25  # of the surface on which contact is possible, where it is not all of the top
FURTHER = 20  # load steps after the first, in the case that has them: the pull is reversed

GAMG = {
    "ksp_type": "cg",
    "ksp_rtol": 1e-8,
    "pc_type": "gamg",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}


@dataclass(frozen=True)
class Case:
    """A block of cells.

    Attributes:
        element: Of ``ELEMENTS``.
        cells: Along each axis; the block is of width 1, and its cells are squares or cubes.
        all_of_top: Whether contact is possible on all of the top; else in its middle.
        steps: Load steps.
    """

    element: str
    cells: tuple[int, ...]
    all_of_top: bool = False
    steps: int = 1

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.cells)

    @property
    def dofs(self) -> int:
        """Number of displacements."""
        degree = ELEMENTS[self.element][1]
        return math.prod(degree * count + 1 for count in self.cells) * self.dimension

    @property
    def height(self) -> float:
        """Of the block, whose width is 1."""
        return self.cells[-1] / self.cells[0]

    @property
    def name(self) -> str:
        """Such as: 3D Q2 hexes 24k, all of the top."""
        parts = [f"{self.dimension}D {self.element} {self.dofs / 1000:.0f}k"]
        if self.all_of_top:
            parts.append("all of the top")
        if self.steps > 1:
            parts.append(f"{self.steps} steps")
        return ", ".join(parts)

    def solvers(self, quick: bool = False) -> list[str]:
        """Those measured on this mesh; quick ones only."""
        found = []
        for solver in SOLVERS:
            least, most = RANGES.get((solver, self.dimension), (0, 0))
            # A factorisation a Newton step: in 3D on one mesh only, and not where it is quick.
            solid = self.dimension == 3 and (quick or self.element != "P2 tets")
            slow = solver == "full" and (self.steps > 1 or solid)
            if least <= self.dofs <= most and not slow:
                found.append(solver)
        return found


def cases(quick: bool) -> list[Case]:
    """All, or what takes about a minute."""
    small = [Case("Q2", (43, 43)), Case("Q2", (43, 43), steps=1 + FURTHER)]
    if quick:
        return [
            *small,
            Case("Q2", (90, 90)),
            Case("P1 tets", (24, 24, 12)),
            Case("P2 tets", (12, 12, 6)),
        ]
    found = [*small, Case("Q2", (90, 90)), Case("Q2", (180, 180))]
    for element in ("P1 tets", "P2 tets", "Q1 hexes", "Q2 hexes"):
        degree = ELEMENTS[element][1]
        for points in (24, 32, 40):
            cells = points // degree
            found.append(Case(element, (cells, cells, cells // 2)))
    found += [
        Case("Q2 hexes", (12, 12, 6), all_of_top=True),
        Case("Q2 hexes", (20, 20, 6), all_of_top=True),
        Case("Q2", (90, 90), steps=1 + FURTHER),
        Case("P2 tets", (16, 16, 8), steps=1 + FURTHER),
    ]
    if "iterative" in SOLVERS:
        found += [
            Case("P1 tets", (48, 48, 24)),
            Case("P1 tets", (64, 64, 32)),
            Case("P2 tets", (24, 24, 12)),
            Case("P2 tets", (32, 32, 16)),
            Case("Q2 hexes", (24, 24, 12)),
        ]
    return found


def scene_of(case: Case, solver: str) -> Scene:
    """The block of a case, held at its bottom."""
    up = "xyz"[case.dimension - 1]
    axes = "xyz"[: case.dimension]
    apex = [0.5] * (case.dimension - 1) + [case.height]
    several = case.steps > 1
    back = LoadPath(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, -1.0))
    obstacle = Obstacle(
        "parabola" if case.dimension == 2 else "paraboloid",
        radius=RADIUS,
        position=tuple(apex),
        indentation=INDENTATION,
        displacement=(SIDEWAYS, *[0.0] * (case.dimension - 1)),
    )
    further = tuple(1 + (step + 1) / (case.steps - 1) for step in range(case.steps - 1))
    contact = Contact(
        "contact",
        friction_coefficient=COEFFICIENT,
        law="incremental" if several else "static",
        obstacle=replace(obstacle, displacement_path=back) if several else obstacle,
    )
    return Scene(
        kinematics="plane strain" if case.dimension == 2 else "3D",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(ELEMENTS[case.element][1]),
        support=(Support(f"{up}0", dict.fromkeys(axes, 0.0)),),
        contact=(contact,),
        steps=Steps(times=(1.0, *further)) if several else Steps(),
        solver=SolverSettings(solver=solver),
    )


def body_of(case: Case, comm: MPI.Comm) -> Body:
    """The mesh of a case with the boundaries that its scene names; collective."""
    last = case.dimension - 1
    kind = getattr(dolfinx.mesh.CellType, ELEMENTS[case.element][0])
    make = dolfinx.mesh.create_box if last == 2 else dolfinx.mesh.create_rectangle
    corner = np.array([*[1.0] * last, case.height])
    mesh = make(comm, [np.zeros(case.dimension), corner], list(case.cells), kind)

    def facets_at(height: float) -> NDArray[np.int32]:
        return dolfinx.mesh.locate_entities_boundary(
            mesh, last, lambda x: np.isclose(x[last], height)
        )

    bottom, top = facets_at(0.0), facets_at(case.height)
    aside = np.abs(dolfinx.mesh.compute_midpoints(mesh, last, top)[:, :last] - 0.5)
    middle = top if case.all_of_top else top[(aside < HALF_WIDTH).all(axis=1)]
    facets = np.concatenate([bottom, middle])
    tags = np.repeat(np.array([1, 2], dtype=np.int32), [len(bottom), len(middle)])
    order = np.argsort(facets)
    cell_map = mesh.topology.index_map(case.dimension)
    cells = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    return Body(
        mesh,
        dolfinx.mesh.meshtags(mesh, case.dimension, cells, np.ones_like(cells)),
        dolfinx.mesh.meshtags(mesh, last, facets[order], tags[order]),
        {
            f"{'xyz'[last]}0": Group(last, (1,)),
            "contact": Group(last, (2,)),
            "body": Group(case.dimension, (1,)),
        },
        "a block",
    )


@dataclass
class Stopwatch:
    """Seconds since it was made: of the CPU on one rank, of the slowest rank on several.

    Attributes:
        excluded: Seconds to leave out.
    """

    comm: MPI.Comm
    excluded: float = 0.0
    _started: float = field(init=False)

    def __post_init__(self) -> None:
        self.comm.Barrier()
        self._started = self._now()

    def _now(self) -> float:
        return time.process_time() if self.comm.size == 1 else time.perf_counter()

    def seconds(self) -> float:
        """Collective."""
        return float(self.comm.allreduce(self._now() - self._started - self.excluded, op=MPI.MAX))

    def exclude(self, action: Callable[[], None]) -> None:
        """Do something that is not to count; collective."""
        before = self._now()
        action()
        self.excluded += self._now() - before


def measured_memory(comm: MPI.Comm, action: Callable[[], T]) -> tuple[T, float]:
    """What an action returns, and by how much the processes grow for it (MB).

    The sum over the ranks of each one's peak; not a number where the system keeps none.
    Collective.
    """
    gc.collect()
    try:
        ctypes.CDLL(None).malloc_trim(0)  # what is free goes back to the system
        before = _memory("VmRSS")
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forget earlier peaks
    except (AttributeError, OSError):
        return action(), math.nan
    found = action()
    return found, float(total(comm, _memory("VmHWM") - before)) / 1000


def _memory(key: str) -> float:
    """Kilobytes, from Linux."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return float(next(line for line in lines if line.startswith(key)).split()[1]) * 1.024


def linear_seconds(problem: Problem, kind: str) -> float:
    """Assemble K, hold the supports, factorise or set up, solve once; collective.

    Args:
        problem: Its bulk and supports are used, no contact.
        kind: ``lu`` by MUMPS with PETSc's defaults, or ``gamg``: conjugate gradients to 1e-8.
    """
    watch = Stopwatch(problem.comm)
    matrix = fem_petsc.assemble_matrix(problem.elastic.stiffness)
    matrix.assemble()
    first, last = matrix.getOwnershipRange()
    held = problem.constrained[problem.constrained < last - first]
    solution, load = matrix.createVecs()
    matrix.getDiagonal(load)
    mean = load.sum() / load.getSize()  # multigrid is not to see supports as soft or stiff
    matrix.zeroRowsColumns((first + held).astype(PETSc.IntType), diag=mean)
    load.set(1.0)
    with load as array:
        array[held] = 0.0
    solver = PETSc.KSP().create(problem.comm)
    motions = _near_nullspace(problem, matrix) if kind == "gamg" else []
    _set_up(solver, matrix, kind)
    solver.solve(load, solution)
    seconds = watch.seconds()
    if int(solver.getConvergedReason()) < 0:
        raise RuntimeError("the linear solve did not converge")
    for thing in (solver, matrix, load, solution, *motions):
        thing.destroy()
    return seconds


def _set_up(solver: Any, matrix: Any, kind: str) -> None:
    solver.setOperators(matrix)
    solver.setOptionsPrefix("linear_")
    options = PETSc.Options()
    if kind == "gamg":
        for name, value in GAMG.items():
            options.setValue("linear_" + name, value)
    else:
        solver.setType("preonly")
        solver.getPC().setType("lu")
        solver.getPC().setFactorSolverType("mumps")
    solver.setFromOptions()
    for name in GAMG:
        options.delValue("linear_" + name)
    solver.setUp()


def _near_nullspace(problem: Problem, matrix: Any) -> list[Any]:
    """Tell GAMG of the rigid motions."""
    spaces = problem.spaces
    coordinates, _ = matrix.createVecs()
    coordinates.setBlockSize(spaces.components)
    with coordinates as array:
        array[:] = spaces.coordinates[: spaces.owned_nodes, : spaces.components].reshape(-1)
    motions = PETSc.NullSpace().createRigidBody(coordinates)
    matrix.setNearNullSpace(motions)
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    return [coordinates, motions]


@dataclass
class Frictional:
    """A solve with friction: what came out, and what it took.

    Attributes:
        seconds: For all load steps, results not read.
        first: For the first of them, with all set-up.
        reading: For reading the results of all.
    """

    solution: Solution
    seconds: float
    first: float
    reading: float
    newton: int
    outer: int
    factorisations: int
    preconditioner_setups: int


def frictional_solve(problem: Problem) -> Frictional:
    """Choose a solver, set it up, solve all load steps; collective."""
    watch = Stopwatch(problem.comm)
    timings = Timings()
    system = create_system(problem, choose_solver(problem), timings)
    firsts: list[float] = []
    iterations: list[tuple[int, int]] = []

    def accepted(_: float, solution: Solution) -> None:
        firsts.append(watch.seconds())
        iterations.append((solution.newton_iterations, solution.outer_iterations))
        watch.exclude(lambda: read_results(problem, solution))

    try:
        solution = solve_steps(Newton(problem, system, timings), accepted)
        seconds, reading = watch.seconds(), largest(problem.comm, np.array([watch.excluded]))
    finally:
        system.destroy()
    newton, outer = (sum(column) for column in zip(*iterations, strict=True))
    counted = system.factorisations
    counts = (counted, 0) if system.name in DIRECT else (0, counted)
    return Frictional(solution, seconds, firsts[0], reading, newton, outer, *counts)


def read_results(problem: Problem, solution: Solution) -> None:
    """What a run reads from every load step; collective."""
    forces = BulkForces(problem, solution)
    reactions, _ = support_reactions(forces)
    by_contact = [
        contact_quantities(problem, solution, number) for number in range(len(problem.contacts))
    ]
    global_quantities(forces, reactions, by_contact)


@dataclass
class Measured:
    """A case by one solver, the least seconds of several runs.

    Attributes:
        row: As in the JSON file.
        solution: For the last load step.
        quantities: Of the contact, for the last load step.
        linear: Seconds of linear solves by kind, ``lu`` or ``gamg``.
        linear_memory: Of the kind that the solver is compared with (MB).
        estimated_memory: As the solver foresees it (MB).
        further: Seconds of each load step after the first, results not read; and with them.
    """

    row: dict[str, Any]
    solution: Solution
    quantities: dict[str, Any]
    linear: dict[str, float]
    linear_memory: float
    estimated_memory: float
    further: tuple[float, float] | None


class _Series:
    """Runs of the same, each after the linear solves that it is compared with.

    Attributes:
        runs: With friction.
        linear: Seconds of the linear solves by kind.
        memory: By how much the processes grew for the first run with friction (MB).
        linear_memory: Likewise for the first kind of linear solve.
    """

    def __init__(self) -> None:
        self.runs: list[Frictional] = []
        self.linear: dict[str, list[float]] = {}
        self.memory = self.linear_memory = math.nan
        self._spent = 0.0

    def add(self, problem: Problem, kinds: list[str]) -> None:
        """Solve once, linear and with friction; collective."""
        first = not self.runs
        for kind in kinds:
            action = partial(linear_seconds, problem, kind)
            seconds, grown = measured_memory(problem.comm, action)
            self.linear.setdefault(kind, []).append(seconds)
            self._spent += seconds
            if first and kind == kinds[0]:
                self.linear_memory = grown
        run, grown = measured_memory(problem.comm, partial(frictional_solve, problem))
        self.runs.append(run)
        self._spent += run.seconds
        if first:
            self.memory = grown

    def is_enough(self, wanted: int | None) -> bool:
        """Whether as many runs as wanted were made; by default up to 12 in about 6 s."""
        made = len(self.runs)
        if wanted is not None:
            return made >= wanted
        return made >= 12 or (made >= 2 and self._spent > 6.0) or self._spent > 60.0

    def further(self, steps: int) -> tuple[float, float] | None:
        """Seconds of each of some steps after the first, results not read; and with them."""
        if steps == 0:
            return None
        alone = min(run.seconds - run.first for run in self.runs) / steps
        return alone, alone + min(run.reading for run in self.runs) / (steps + 1)


def measure(case: Case, solver: str, body: Body, repeat: int | None = None) -> Measured:
    """Time a case and the linear solves that it is compared with, by turns; collective.

    Args:
        case: The case.
        solver: As a scene names it.
        body: The mesh of the case.
        repeat: Least of how many runs; by default up to 12, fewer where each takes longer.
    """
    comm, scene = body.mesh.comm, scene_of(case, solver)
    compile_forms(case, solver, comm)
    compared = "lu" if solver in DIRECT else "gamg"
    kinds = [compared]
    if compared == "lu" and case.dimension == 3 and case.dofs >= RANGES["iterative", 3][0]:
        kinds.append("gamg")
    series = _Series()
    while not series.is_enough(repeat or (1 if solver == "full" else None)):
        problem = Problem(scene, body)
        series.add(problem, kinds)
    run = min(series.runs, key=lambda run: run.seconds)
    linear = {kind: min(seconds) for kind, seconds in series.linear.items()}
    row = {
        "case": case.name,
        "dimension": case.dimension,
        "element": case.element,
        "dofs": unknowns(problem),
        "contact_dofs": contact_unknowns(problem),
        "solver": solver,
        "ranks": comm.size,
        "linear_seconds": linear[compared],
        "frictional_seconds": run.seconds,
        "ratio": run.seconds / linear[compared],
        "steps": case.steps,
        "newton": run.newton,
        "outer": run.outer,
        "factorisations": run.factorisations,
        "preconditioner_setups": run.preconditioner_setups,
        "peak_memory_mb": round(series.memory, 1),
    }
    return Measured(
        row,
        run.solution,
        contact_quantities(problem, run.solution, 0),
        linear,
        series.linear_memory,
        memory_estimate(problem, solver) / 1e6,
        series.further(case.steps - 1),
    )


def compile_forms(case: Case, solver: str, comm: MPI.Comm) -> None:
    """Solve the case on a few cells, so that nothing is left to compile or load."""
    few = replace(case, cells=(8,) * (case.dimension - 1) + (2,), steps=min(case.steps, 2))
    problem = Problem(scene_of(few, solver), body_of(few, comm))
    for kind in ("lu", "gamg"):
        linear_seconds(problem, kind)
    frictional_solve(problem)


def limit_of(row: dict[str, Any]) -> float | None:
    """What the project asks of itself: the ratio at the most, in one load step."""
    if row["solver"] not in DIRECT:
        return 3.0
    if row["solver"] == "full" or row["steps"] > 1:
        return None
    if row["ranks"] > 1:
        return 2.4
    if row["dimension"] == 2:
        return 1.5
    return 1.4 if row["contact_dofs"] <= 0.025 * row["dofs"] else 2.0


def limits_of(rows: list[dict[str, Any]]) -> set[float]:
    """All limits that some rows have."""
    return {limit for row in rows if (limit := limit_of(row)) is not None}


def print_table(found: list[Measured]) -> None:
    """Ratios beside their limits."""
    table = Table(title="What friction costs, in linear solves")
    for heading in ("case", "contact dofs", "solver", "linear", "GAMG", "frictional", "ratio"):
        table.add_column(heading, justify="left" if heading in ("case", "solver") else "right")
    for heading in ("limit", "Newton", "outer", "set-ups", "MB", "linear MB", "estimated MB"):
        table.add_column(heading, justify="right")
    for one in found:
        row = one.row
        limit = limit_of(row)
        missed = limit is not None and row["ratio"] > limit
        gamg = one.linear.get("gamg")
        table.add_row(
            row["case"],
            f"{row['contact_dofs']} ({row['contact_dofs'] / row['dofs']:.1%})",
            row["solver"],
            f"{row['linear_seconds']:.2f} s",
            "" if gamg is None else f"{gamg:.2f} s",
            f"{row['frictional_seconds']:.2f} s",
            f"{row['ratio']:.2f}{' !' if missed else ''}",
            "" if limit is None else f"{limit:g}",
            str(row["newton"]),
            str(row["outer"]),
            str(row["factorisations"] + row["preconditioner_setups"]),
            *(
                f"{memory:.0f}"
                for memory in (row["peak_memory_mb"], one.linear_memory, one.estimated_memory)
            ),
        )
    Console(width=170).print(table)


def print_further(found: list[Measured]) -> None:
    """What load steps after the first cost, where there are any."""
    several = [one for one in found if one.further is not None]
    if not several:
        return
    table = Table(
        "case", "solver", "a step", "with results", f"{FURTHER} steps", title="Further load steps"
    )
    for one in several:
        assert one.further is not None
        alone, with_results = (seconds / one.row["linear_seconds"] for seconds in one.further)
        table.add_row(
            one.row["case"],
            one.row["solver"],
            f"{alone:.3f}{' !' if alone > 0.1 else ''} linear solves",
            f"{with_results:.3f}",
            f"{FURTHER * alone:.2f}; {FURTHER * with_results:.2f}",
        )
    Console(width=170).print(table)


def plot(rows: list[dict[str, Any]], path: Path) -> None:
    """Ratio over dofs, a panel a dimension, with the limits."""
    from matplotlib.ticker import LogLocator

    shown = [row for row in rows if row["solver"] != "full" and row["steps"] == 1]
    dimensions = sorted({row["dimension"] for row in shown})
    figure, panels = new_figure(
        "", (4.8 * len(dimensions), 4.2), ncols=len(dimensions), sharey=True
    )
    figure.suptitle("Frictional solve over linear solve", fontsize=11)
    for panel, dimension in zip(panels, dimensions, strict=True):
        chosen = [row for row in shown if row["dimension"] == dimension]
        for label, points in _series(chosen).items():
            panel.semilogx(*points, markersize=7, linewidth=1.0, label=label, **_style(label))
        for limit in sorted(limits_of(chosen)):
            panel.axhline(limit, color="0.3", linewidth=0.8, linestyle=":", zorder=0)
            panel.annotate(
                f"limit {limit:g}{_applies_to(limit, chosen)}",
                (1.01, limit),
                xycoords=("axes fraction", "data"),
                va="center",
                fontsize=8,
                color="0.3",
            )
        panel.set_title(f"{dimension}D", fontsize=10)
        panel.set_xlabel("dofs")
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        panel.xaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}k")
        panel.xaxis.set_minor_formatter("")
        panel.legend(frameon=False, fontsize=8, loc="lower right")
    panels[0].set_ylabel("ratio")
    panels[0].set_ylim(0.0, 1.05 * max([3.0, *(row["ratio"] for row in shown)]))
    save(figure, path)


def _series(rows: list[dict[str, Any]]) -> dict[str, tuple[list[float], list[float]]]:
    """Dofs and ratios by what a line is called."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    for row in sorted(rows, key=lambda row: row["dofs"]):
        label = row["element"]
        if row["contact_dofs"] > 0.025 * row["dofs"]:
            label += ", 8 % contact"
        if row["solver"] != "condensed":
            label += f", {row['solver']}"
        points = found.setdefault(label, ([], []))
        points[0].append(row["dofs"])
        points[1].append(row["ratio"])
    return found


def _style(label: str) -> dict[str, Any]:
    element, *special = label.split(", ")
    filled = not special
    return {
        "marker": MARKERS[element],
        "color": GREYS[element],
        "markerfacecolor": GREYS[element] if filled else "white",
        "linestyle": "-" if filled else "--",
    }


def _applies_to(limit: float, rows: list[dict[str, Any]]) -> str:
    """What a limit is for, where there are several."""
    if len(limits_of(rows)) == 1:
        return ""
    return {1.4: ",\ncontact ≤ 2.5 %", 2.0: ",\ncontact 8 %", 3.0: ",\niterative"}[limit]


def main() -> None:
    """Measure, print and, if asked, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer meshes: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw, with matplotlib")
    parser.add_argument("--case", default="", metavar="TEXT", help="only those with it in the name")
    parser.add_argument("--repeat", type=int, metavar="N", help="least of N runs of each")
    options = parser.parse_args()
    comm = MPI.COMM_WORLD
    repeat = options.repeat or (3 if options.quick else None)
    found = []
    for case in cases(options.quick):
        if options.case not in case.name:
            continue
        body = body_of(case, comm)
        for solver in case.solvers(options.quick):
            found.append(measure(case, solver, body, repeat))
            if comm.rank == 0:
                ratio = found[-1].row["ratio"]
                print(f"{case.name:35} {solver:10} {ratio:6.2f}", flush=True)
                if options.json:
                    rows = json.dumps([one.row for one in found], indent=2)
                    options.json.write_text(rows + "\n", encoding="utf-8")
    if comm.rank > 0:
        return
    print_table(found)
    print_further(found)
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        plot([one.row for one in found], options.plot / "solve_cost.png")


if __name__ == "__main__":
    main()
