"""What derivatives by all numbers of a scene cost, against what they are derivatives of.

``python benchmarks/derivative_cost.py [--quick] [--json FILE]``.

Blocks in the plane and in space with an obstacle pressed in and pulled sideways, a sphere on a
half-space, and a history of a hundred load steps with incremental friction. Each is solved, and
the derivatives of one quantity by all numbers that have one are found, several times. Those of one
load step are compared with one linear elastic solve on the same mesh, those of a history with the
history as a run has it, with the quantities and checks of every step. Times are CPU time of one
rank, the least of several; what is compiled once and kept is left out. With
``OMP_NUM_THREADS=1``, as ``./bootstrap`` sets it.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cost_solves import linear_seconds, linear_solvers
from mpi4py import MPI
from rich.console import Console
from rich.table import Table

from fenics_contact import Body, Contact, Scene, SolverSettings, Steps, load_scene
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import Path as LoadPath
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.kept_body import KeptBody, mesh_of
from fenics_contact.simulation.studies.solved_derivatives import solved_scene
from fenics_contact.solve.condensed.part_factors import KnownFactors
from fenics_contact.solve.solver_choice import contact_unknowns, unknowns
from fenics_contact.verification.memory_check import BlockCase, slab, square
from fenics_contact.verification.memory_worker import body_of, scene_of

DEMOS = Path(__file__).resolve().parent.parent / "demos"
COMM = MPI.COMM_WORLD
# Solves of each case, after one that compiles and loads.
TIMES = 3
# Of the issue: at most these shares of a linear solve, by dimension and from so many dofs on, and
# of a history.
LIMITS, FROM_DOFS, LIMIT_OF_HISTORY = {2: 0.3, 3: 0.15}, 50_000, 1.0
STEPS = 100


@dataclass(frozen=True)
class Asked:
    """A case.

    Attributes:
        name: For the table.
        make: Gives the scene and its mesh.
        of: The quantity.
    """

    name: str
    make: Callable[[], tuple[Scene, Body]]
    of: str = "normal_force"


def block(case: BlockCase, **changes: Any) -> Callable[[], tuple[Scene, Body]]:
    """A block of the benchmark of costs."""
    settings = SolverSettings(errors="none")
    return lambda: (
        replace(scene_of(case, "auto"), solver=settings, **changes),
        body_of(case, COMM),
    )


def sphere(*settings: str) -> Callable[[], tuple[Scene, Body]]:
    """The demo on a half-space, without error bars."""

    def make() -> tuple[Scene, Body]:
        scene = load_scene(DEMOS / "sphere.toml", ["solver.errors=none", *settings])
        return scene, mesh_of(scene, COMM, Timings())

    return make


def history(cells: int) -> Callable[[], tuple[Scene, Body]]:
    """A block of which the obstacle is pulled to and fro, with incremental friction."""
    case = square(cells)

    def make() -> tuple[Scene, Body]:
        scene = scene_of(case, "auto")
        (contact,) = scene.contact
        assert contact.obstacle is not None
        obstacle = replace(
            contact.obstacle,
            path=LoadPath((0, 0.1, 1), (0, 1, 1)),
            displacement_path=LoadPath((0, 0.1, 0.4, 0.8, 1), (0, 0, 1, -1, 0)),
        )
        rubbed: Contact = replace(contact, law="incremental", obstacle=obstacle)
        scene = replace(
            scene,
            contact=(rubbed,),
            steps=Steps(number=STEPS),
            solver=SolverSettings(errors="none"),
        )
        return scene, body_of(case, COMM)

    return make


FINE = ("mesh.parameters.size=0.088", "mesh.parameters.cells_outside=36")
QUICK = [
    Asked("block in the plane", block(square(90))),
    Asked("sphere on a half-space", sphere(*FINE)),
    Asked("block in space, P1 tetrahedra", block(slab("P1 tets", 24))),
    Asked(f"history of {STEPS} steps", history(20), "friction_force_x"),
]
FULL = [
    Asked("large block in the plane", block(square(180))),
    Asked("large block in space, P1 tetrahedra", block(slab("P1 tets", 40))),
    Asked("block in space, P2 tetrahedra", block(slab("P2 tets", 32))),
    Asked(f"history of {STEPS} steps, larger", history(90), "friction_force_x"),
]


@contextmanager
def timed(seconds: list[float]) -> Iterator[None]:
    """Add the CPU time of what is done to a list."""
    begun = time.process_time()
    yield
    seconds.append(time.process_time() - begun)


def measure(asked: Asked, times: int = TIMES) -> dict[str, Any]:
    """A row of one case.

    Args:
        asked: The case.
        times: Solves that are timed.
    """
    scene, body = asked.make()
    kept = KeptBody(scene, body, Timings(), KnownFactors())
    solves: list[float] = []
    derived: list[float] = []
    for _ in range(1 + times):
        begun = time.process_time()
        with solved_scene(kept, scene) as solved:
            solves.append(time.process_time() - begun)
            with timed(derived):
                found = solved.derivatives([asked.of], None)
            count = len(solved.steps)
            dofs, contact = unknowns(solved.system.problem), contact_unknowns(solved.system.problem)
    solve, derivatives = min(solves[1:]), min(derived[1:])
    linear = least_linear(dataclasses.replace(scene, steps=Steps()), body, times)
    several = count > 1
    history = least_run(scene, body, times) if several else None
    limit = LIMIT_OF_HISTORY if several else LIMITS[scene.dimension]
    return {
        "case": asked.name,
        "dimension": scene.dimension,
        "dofs": dofs,
        "contact_dofs": contact,
        "steps": count,
        "quantity": asked.of,
        "keys": sorted(found[asked.of]),
        "linear_seconds": linear,
        "solve_seconds": solve,
        "run_seconds": history,
        "derivative_seconds": derivatives,
        "ratio": derivatives / (linear if history is None else history),
        "limit": limit if several or dofs >= FROM_DOFS else None,
    }


def least_linear(scene: Scene, body: Body, times: int) -> float:
    """The least seconds of a linear elastic solve by whatever direct solver is fastest."""
    problem = Problem.on_mesh(scene, body)
    solvers = linear_solvers(problem, "condensed").values()
    return min(linear_seconds(problem, one) for one in solvers for _ in range(times))


def least_run(scene: Scene, body: Body, times: int) -> float:
    """The least seconds of all load steps as a run takes them, from its factorisation on."""
    seconds: list[float] = []
    for _ in range(times):
        prepared = Run(scene, COMM, body)
        with timed(seconds):
            prepared.solve()
    return min(seconds)


def print_table(rows: list[Mapping[str, Any]]) -> None:
    """Milliseconds and ratios beside their limits."""
    table = Table(title="Derivatives by all numbers of a scene (milliseconds of CPU time)")
    table.add_column("case")
    for heading in ("dofs", "contact dofs", "steps", "numbers", "linear", "kept body", "run"):
        table.add_column(heading, justify="right")
    for heading in ("derivatives", "ratio", "limit"):
        table.add_column(heading, justify="right")
    for row in rows:
        limit = row["limit"]
        over = limit is not None and row["ratio"] > limit
        table.add_row(
            row["case"],
            f"{row['dofs']:,}",
            str(row["contact_dofs"]),
            str(row["steps"]),
            str(len(row["keys"])),
            *(
                "" if row[f"{name}_seconds"] is None else f"{1000 * row[f'{name}_seconds']:.0f}"
                for name in ("linear", "solve", "run", "derivative")
            ),
            f"{row['ratio']:.2f}{' !' if over else ''}",
            "" if limit is None else f"{limit:g}",
        )
    Console(width=150).print(table)


def main() -> None:
    """Measure, print and, if asked, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer cases: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    options = parser.parse_args()
    rows = [measure(asked) for asked in (QUICK if options.quick else QUICK + FULL)]
    print_table(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
