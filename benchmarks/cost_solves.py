"""The two solves that are compared, each timed: a linear one, and one with contact and friction."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from fenics_contact.common import mumps
from fenics_contact.common.parallel import largest
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import global_quantities, support_records
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.solve.load_steps.accepted_step import AtEachStep
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.solve.solver_choice import unknowns
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.budget import error_budget

# isort: split
import numpy as np
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from petsc4py import PETSc

GAMG = {
    "ksp_type": "cg",
    "ksp_rtol": 1e-8,
    "pc_type": "gamg",
    "mg_levels_ksp_type": "chebyshev",
    "mg_levels_pc_type": "jacobi",
}

ORDERINGS = {mumps.MINIMUM_DEGREE: "minimum degree", mumps.AUTOMATIC: "automatic"}

Settings = dict[str, Any]


def linear_solvers(problem: Problem, solver: str) -> dict[str, Settings]:
    """What the linear solve may be done by, by names for the table; the fastest of them counts.

    For direct solvers LU and Cholesky, in the ordering that the condensed solver has for a body of
    this size, and in the one that MUMPS would choose.

    Args:
        problem: The problem.
        solver: What solves it with friction: ``condensed``, ``full`` or ``iterative``.
    """
    if solver == "iterative":
        return {"GAMG": GAMG}
    chosen = mumps.fastest(problem.spaces.components == 2, unknowns(problem)).ordering
    orderings = sorted({chosen, mumps.AUTOMATIC})
    return {
        f"{name}, {ORDERINGS[ordering]}": {
            "ksp_type": "preonly",
            "pc_type": name.lower(),
            "pc_factor_mat_solver_type": "mumps",
            "mat_mumps_icntl_7": ordering,
        }
        for name in ("LU", "Cholesky")
        for ordering in orderings
    }


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


def linear_seconds(problem: Problem, settings: Settings) -> float:
    """Assemble K, hold the supports, factorise or set up, solve once; collective.

    Args:
        problem: Its bulk and supports are used, no contact.
        settings: One of ``linear_solvers``; ``GAMG`` is conjugate gradients to 1e-8.
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
    motions = _near_nullspace(problem, matrix) if settings is GAMG else []
    solver = PETSc.KSP().create(problem.comm)
    solver.setOperators(matrix)
    _configure(solver, settings)
    solver.solve(load, solution)
    seconds = watch.seconds()
    if int(solver.getConvergedReason()) < 0:
        raise RuntimeError("the linear solve did not converge")
    for thing in (solver, matrix, load, solution, *motions):
        thing.destroy()
    return seconds


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


def _configure(solver: Any, settings: Settings) -> None:
    """PETSc's options hold for the levels of multigrid until these are set up."""
    prefix, options = "linear_", PETSc.Options()
    for name, value in settings.items():
        options.setValue(prefix + name, value)
    solver.setOptionsPrefix(prefix)
    solver.setFromOptions()
    solver.setUp()
    for name in settings:
        options.delValue(prefix + name)


@dataclass
class Frictional:
    """A solve with friction: what came out, and what it took.

    Attributes:
        solution: For the last load step.
        seconds: For all load steps, with pairing, results not read.
        first: For the first of them, with all set-up.
        pairing: For finding what faces what of two bodies.
        reading: For reading the results of all.
        newton: Newton steps in all.
        outer: Passes of the loop on the pressure in all.
        set_ups: Factorisations, or by an iterative solver set-ups of its preconditioner.
    """

    solution: Solution
    seconds: float
    first: float
    pairing: float
    reading: float
    newton: int
    outer: int
    set_ups: int


def frictional_solve(problem: Problem) -> Frictional:
    """Find what faces what, choose a solver, set it up, solve all load steps; collective."""
    watch = Stopwatch(problem.comm)
    pair_again(problem)
    pairing = watch.seconds()
    timings = Timings()
    firsts: list[float] = []
    iterations: list[tuple[int, int]] = []

    def accepted(_: float, solution: Solution) -> None:
        firsts.append(watch.seconds())
        iterations.append((solution.newton_iterations, solution.outer_iterations))
        watch.exclude(lambda: read_results(problem, solution))

    with stepping(problem, timings) as load_steps:
        solution = load_steps.solve(AtEachStep(accepted))
        seconds, reading = watch.seconds(), largest(problem.comm, np.array([watch.excluded]))
        system = load_steps.newton.system
    newton, outer = (sum(column) for column in zip(*iterations, strict=True))
    return Frictional(
        solution, seconds, firsts[0], pairing, reading, newton, outer, system.factorisations
    )


def seconds_of_errors(problem: Problem) -> float:
    """What a run's error bars take after its last load step, by default settings; collective."""
    timings = Timings()
    history = StepHistory(problem, timings, partial(BulkForces, problem))
    history.begin([])
    with stepping(problem, timings) as load_steps:
        load_steps.keep_ends()
        load_steps.solve(AtEachStep(history.add))
        watch = Stopwatch(problem.comm)
        error_budget(load_steps, history.steps)
        return watch.seconds()


def pair_again(problem: Problem) -> None:
    """What facing bodies cost where the problem is made, with forms and spaces; collective."""
    for contact in problem.contacts:
        if contact.kinematics.pairing is not None:
            contact.kinematics.pairing.update()


def read_results(problem: Problem, solution: Solution) -> None:
    """What a run reads from every load step; collective."""
    forces = BulkForces(problem, solution)
    support_records(forces)
    by_contact = [
        contact_quantities(problem, solution, number) for number in range(len(problem.contacts))
    ]
    global_quantities(forces, by_contact)
