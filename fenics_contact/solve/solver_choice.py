"""Which solver a problem gets, and whether the machine has the memory for it."""

from __future__ import annotations

from dataclasses import dataclass
from math import log2, sqrt
from typing import Literal

import numpy as np

from fenics_contact.common.errors import InputError, MachineError
from fenics_contact.common.failures import LESS_MEMORY
from fenics_contact.common.memory import free_memory_for, memory_limit
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.iterative.iterative_system import IterativeSystem
from fenics_contact.solve.systems.full_system import FullSystem
from fenics_contact.solve.systems.system import System

Name = Literal["condensed", "full", "iterative"]

# Entries of MUMPS' factors L and U of n unknowns, ordered by nested dissection: c n log2 n in two
# dimensions, c n^(4/3) in three (A. George, SIAM J. Numer. Anal. 10 (1973) 345-363). Measured
# with P1, P2, Q1 and Q2 on 7,000 to 120,000 unknowns: 10-12.3 and 30-38.
_ENTRIES_2D, _ENTRIES_3D = 12.5, 40.0
# MUMPS' working memory over that of its factors (measured: 1.15-1.37).
_WORKSPACE = 1.4
# K as assembled, and its copies in PETSc and MUMPS (which numbers rows and columns).
_COPIES = 6
# Memory of K, multigrid and Krylov vectors over 12 bytes for every entry of every cell's matrix
# (measured: .4 on P1 to .95 on P2 and Q1).
_ITERATIVE = 1.2
# Unknowns from which multigrid is faster in 3D, by degree (measured on one rank).
_ITERATIVE_FROM = {1: 50_000, 2: 100_000}
# S, its inverse and what a Newton step makes of them, where all of a large contact touches
# (measured: 9.6-9.9 times S).
_DENSE = 10
# Of two bodies, bytes for every pair of dofs of their surfaces, all of which P couples, where all
# displacements are unknowns (measured: 97).
_COUPLED = 110.0


@dataclass(frozen=True)
class SolverChoice:
    """A solver, and why.

    Attributes:
        name: ``condensed``, ``full`` or ``iterative``.
        reason: In words.
        memory: Estimate for all ranks together (bytes).
    """

    name: Name
    reason: str
    memory: float


def choose_solver(problem: Problem) -> SolverChoice:
    """The scene's solver, or the one that suits its sizes; collective.

    Raises:
        InputError: The solver that the scene asks for is not for its model.
        MachineError: The problem will not fit into the machine's memory.
    """
    wanted = problem.scene.solver.solver
    free = free_memory_for(problem.comm)
    if wanted == "auto":
        choice = _automatic(problem, free)
    else:
        if wanted == "iterative" and not _suits_multigrid(problem):
            raise InputError(
                "solver.solver = 'iterative' is for 3D models, and not for nearly incompressible "
                "materials; use 'condensed' or 'full'"
            )
        choice = SolverChoice(wanted, "as the scene says", memory_estimate(problem, wanted))
    if choice.memory > free:
        raise MachineError(
            f"the solver '{choice.name}' needs about {choice.memory / 1e9:.2g} GB of memory for "
            f"{unknowns(problem):,} unknowns, and {free / 1e9:.2g} GB are free "
            f"{memory_limit(problem.comm)}; {LESS_MEMORY}"
        )
    return choice


def _automatic(problem: Problem, free: float) -> SolverChoice:
    """What is expected to be fastest of what fits; collective."""

    def choice(name: Name, reason: str) -> SolverChoice:
        return SolverChoice(name, reason, memory_estimate(problem, name))

    if not any(contact.terms for contact in problem.contacts):
        return choice("full", "nothing to iterate on")
    condensed = choice("condensed", "one factorisation of the bulk")
    if not _suits_multigrid(problem):
        return condensed
    if condensed.memory > free:
        return choice("iterative", "a factorisation would not fit into memory")
    if problem.between_bodies:
        return condensed  # in multigrid's zone P couples all of a slave with all of its master
    # Each further step costs the iterative solver about half of the first, the other nothing.
    steps = 0.5 + 0.5 * len(problem.scene.steps.all_times)
    if unknowns(problem) > steps * _ITERATIVE_FROM[problem.spaces.degree]:
        return choice("iterative", "multigrid is faster than a factorisation of this size")
    return condensed


def _suits_multigrid(problem: Problem) -> bool:
    """Whether there is multigrid for K: none for a mean stress, none that is sure on the axis."""
    return problem.spaces.components == 3 and problem.elastic.mixed is None


def create_system(problem: Problem, choice: SolverChoice, timings: Timings) -> System:
    """What Newton's method is to solve; collective."""
    systems: dict[Name, type[CondensedSystem] | type[FullSystem] | type[IterativeSystem]] = {
        "condensed": CondensedSystem,
        "full": FullSystem,
        "iterative": IterativeSystem,
    }
    return systems[choice.name](problem, timings)


def unknowns(problem: Problem) -> int:
    """Displacements and mean stresses on all ranks."""
    spaces = [problem.spaces.displacement_space]
    if problem.elastic.mixed is not None:
        spaces.append(problem.elastic.mixed.mean_stress.function_space)
    return sum(
        int(space.dofmap.index_map.size_global) * int(space.dofmap.index_map_bs) for space in spaces
    )


def contact_unknowns(problem: Problem) -> int:
    """Displacements of the surfaces on which contacts act, on all ranks."""
    every = [
        trace
        for contact in problem.contacts
        if contact.terms
        for trace in (contact.trace, contact.sides.opposite)
        if trace is not None
    ]
    nodes = sum(int(trace.surface.space.dofmap.index_map.size_global) for trace in every)
    return nodes * problem.spaces.components


def memory_estimate(problem: Problem, name: Name) -> float:
    """Bytes that a solver needs on all ranks together; collective."""
    count = unknowns(problem)
    plane = problem.spaces.components == 2
    entries = _ENTRIES_2D * count * log2(count) if plane else _ENTRIES_3D * count ** (4 / 3)
    bytes_of_factors = 8 * _WORKSPACE * entries
    dofs_of_cell = (
        problem.spaces.displacement_space.dofmap.list.shape[1] * problem.spaces.components
    )
    cells = problem.body.mesh.topology.index_map(problem.body.dimension).size_global
    bytes_of_cells = 12.0 * cells * dofs_of_cell**2
    coupled = _COUPLED * contact_unknowns(problem) ** 2 if problem.between_bodies else 0.0
    if name == "iterative":
        return float(_ITERATIVE * bytes_of_cells + coupled)
    # Cells share entries: with m cells at a node about √m of them have the same one.
    cells_at_node = cells * dofs_of_cell / count
    bytes_of_matrix = bytes_of_cells / max(1.0, sqrt(cells_at_node))
    dense = coupled
    if name == "condensed":
        dense = _DENSE * 8.0 * (contact_unknowns(problem) + _between_ranks(problem)) ** 2
    return float(bytes_of_factors + _COPIES * bytes_of_matrix + dense)


def _between_ranks(problem: Problem) -> int:
    """Displacements that cells of several ranks share; collective."""
    space, topology = problem.spaces.displacement_space, problem.body.mesh.topology
    index_map, nodes = space.dofmap.index_map, space.dofmap.list
    touched = np.zeros(index_map.size_local + index_map.num_ghosts, dtype=bool)
    touched[nodes[: topology.index_map(topology.dim).size_local]] = True
    shared = int(touched[index_map.size_local :].sum())
    return int(total(problem.comm, shared)) * problem.spaces.components
