"""The choice of a solver for a problem, with the memory each needs and what the machine has.

How much memory each solver needs: what it holds, part by part. The constants below are measured by
``benchmarks/memory_use.py``, which runs scenes in processes of their own, compares, and says by
which factor each part would have to change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log2, sqrt
from typing import Literal

import numpy as np

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Flags
from fenics_contact.common.errors import InputError, MachineError
from fenics_contact.common.failures import LESS_MEMORY
from fenics_contact.common.memory import free_memory_for, memory_limit
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import held_by_points_alone, is_part_free
from fenics_contact.scene.loading.load_paths import moduli_change
from fenics_contact.solve.at_points.point_laws import why_not
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem, acting_sides
from fenics_contact.solve.condensed.elimination import pays
from fenics_contact.solve.finite.finite_system import FiniteSystem
from fenics_contact.solve.glued_system import GluedSystem, is_glueable
from fenics_contact.solve.iterative.contact_zone import cannot_be_carried
from fenics_contact.solve.iterative.iterative_system import IterativeSystem
from fenics_contact.solve.near_system import NearSystem
from fenics_contact.solve.systems.contact_dofs import dofs_of, slaves_of
from fenics_contact.solve.systems.full_system import FullSystem
from fenics_contact.solve.systems.near_nodes import NearNodes, near_nodes
from fenics_contact.solve.systems.system import System

Name = Literal["condensed", "full", "iterative"]

# Bytes of libraries and code that every rank loads on the way, whatever the body.
_PROGRAM = 50e6
# Bytes a cell and an unknown: topology, geometry, spaces, and functions on them.
_CELL, _UNKNOWN = 500.0, 300.0
# Entries of MUMPS' factors L and U of n unknowns of a body, ordered by nested dissection:
# c n log2 n in two dimensions, c n^(4/3) in three (A. George, SIAM J. Numer. Anal. 10 (1973)
# 345-363). Measured with P1, P2, Q1 and Q2 on 7,000 to 120,000 unknowns: 10-12.3 and 30-38.
_ENTRIES_2D, _ENTRIES_3D = 11.5, 33.0
# MUMPS' working memory over that of its factors (measured: 1.15-1.37).
_WORKSPACE = 1.2
# K as assembled, and its copies in PETSc and MUMPS, which numbers rows and columns, over K.
_COPIES = 5.0
# ``iterative``: K, multigrid and Krylov vectors over K (measured: 2.3-2.5); and factors of the zone
# of cells at the contacts, in bytes over contact dofs (measured: 14,000-16,000).
_MULTIGRID, _ZONE = 2.4, 15_000.0
# What is dense. ``condensed``: S and what it and a Newton step make of it, in bytes over (contact
# dofs)²; less of dofs on which no contact acts. Of two bodies P couples every dof of a slave to
# every one of its master: that is in the tangent of ``full``, in bytes over (dofs of both
# surfaces)²; ``iterative`` only applies P.
_DENSE = {"condensed": 60.0, "full": 0.0, "iterative": 0.0}
_ELIMINATED = {"condensed": 14.0, "full": 0.0, "iterative": 0.0}
_COUPLED = {"condensed": 0.0, "full": 75.0, "iterative": 0.0}

# Jumps from which S is not formed. Then all bodies glued have one factor, over those of the bodies,
# copies of K beside it, and bytes over jumps of zones at contacts and of directions. Measured by
# ``benchmarks/assemblies.py --large`` on 51,000 to 304,000 unknowns: it is .95 to 1.04 of that.
_MOST_JUMPS = 10_000
_GLUED, _GLUED_COPIES, _AT_JUMPS = 0.63, 3.0, 60_000.0

# Error bars: bytes for every dof of every cell, of the local problems (measured in space:
# 470-700).
_ERROR_BARS = {2: 150.0, 3: 500.0}


def memory_estimate(problem: Problem, name: Name, is_kept: bool = False) -> float:
    """Bytes that a run needs on all ranks together, above the program at rest; collective."""
    return sum(memory_terms(problem, name, is_kept).values())


def memory_terms(problem: Problem, name: Name, is_kept: bool = False) -> dict[str, float]:
    """Memory by what needs it (bytes); collective.

    Args:
        problem: The problem.
        name: Of the solver.
        is_kept: Whether the body is condensed for many problems, onto all that may touch.
    """
    count, contact = unknowns(problem), contact_unknowns(problem)
    matrix = _matrix(problem)
    near = [None] * len(acting_sides(problem)) if is_kept else near_nodes(problem)
    every, acted_on = condensed_onto(problem, near)
    is_glued = name == "condensed" and not is_kept and solves_glued(problem, near)
    between = _between_ranks(problem)
    dense = _DENSE[name] * acted_on**2 + _ELIMINATED[name] * ((every + between) ** 2 - acted_on**2)
    dense = _AT_JUMPS * acted_on if is_glued else dense
    terms = {
        "program": _PROGRAM * problem.comm.size,
        "mesh": _CELL * _cells(problem) + _UNKNOWN * count,
        "dense": dense,
        "pairs": _COUPLED[name] * _coupled(problem),
    }
    if _has_error_bars(problem, name):
        local = _ERROR_BARS[problem.spaces.components] * _dofs_of_cell(problem)
        terms["error bars"] = local * _cells(problem)
    if name == "iterative":
        return terms | {"multigrid": _MULTIGRID * matrix, "zone": _ZONE * contact}
    return terms | {
        "matrix": (_GLUED_COPIES if is_glued else _COPIES) * matrix,
        "factor": (_GLUED if is_glued else 1.0) * 8 * _WORKSPACE * _factor_entries(problem, name),
    }


def _has_error_bars(problem: Problem, name: Name) -> bool:
    """Whether a run estimates the errors that the mesh makes."""
    wanted = problem.scene.solver.errors
    if wanted == "auto":
        return name == "condensed" or problem.scene.accuracy is not None
    return wanted == "all"


def _factor_entries(problem: Problem, name: Name) -> float:
    """Entries of MUMPS' factors, of every body by itself: contacts are condensed onto, or small."""
    parts = problem.spaces.parts
    nodes = parts.sums(np.ones(problem.spaces.owned_nodes))
    share = nodes / nodes.sum() * unknowns(problem)
    if problem.spaces.components == 3:
        return float(_ENTRIES_3D * (share ** (4 / 3)).sum())
    half = name == "condensed" and mumps.fastest(True, unknowns(problem)).kind == "cholesky"
    return float((0.5 if half else 1.0) * _ENTRIES_2D * sum(n * log2(n) for n in share))


def _cells(problem: Problem) -> int:
    """On all ranks."""
    return int(problem.body.mesh.topology.index_map(problem.body.dimension).size_global)


def _dofs_of_cell(problem: Problem) -> int:
    space = problem.spaces.displacement_space
    return int(space.dofmap.list.shape[1]) * problem.spaces.components


def _matrix(problem: Problem) -> float:
    """Bytes of K. Cells share entries: with m cells at a node about √m of them have the same."""
    cells_at_node = _cells(problem) * _dofs_of_cell(problem) / unknowns(problem)
    of_cells = 12.0 * _cells(problem) * _dofs_of_cell(problem) ** 2
    return of_cells / max(1.0, sqrt(cells_at_node))


def unknowns(problem: Problem) -> int:
    """Displacements and mean stresses on all ranks."""
    spaces = [problem.spaces.displacement_space]
    if problem.elastic.mixed is not None:
        spaces.append(problem.elastic.mixed.mean_stress.function_space)
    return sum(
        int(space.dofmap.index_map.size_global) * int(space.dofmap.index_map_bs) for space in spaces
    )


def contact_unknowns(problem: Problem) -> int:
    """Displacements of the surfaces on which contacts act, on all ranks; collective.

    Those that contacts share count once.
    """
    return condensed_onto(problem, [None] * len(acting_sides(problem)))[0]


def solves_glued(problem: Problem, near: Sequence[NearNodes | None]) -> bool:
    """Whether S is so large that it is applied, and not formed; collective.

    Args:
        problem: The problem.
        near: The nodes of each contact that can touch.
    """
    return condensed_onto(problem, near)[1] > _MOST_JUMPS and is_glueable(problem, near)


def condensed_onto(problem: Problem, near: Sequence[NearNodes | None]) -> tuple[int, int]:
    """Numbers of contact dofs, and of those on which contacts act; collective.

    Args:
        problem: The problem.
        near: The nodes of each contact that can touch.
    """
    pairs = list(zip(acting_sides(problem), near, strict=True))
    every, slaves = (
        len(np.unique(np.concatenate([np.zeros(0, np.int64), *dofs])))
        for dofs in (
            [dofs_of(sides, which) for sides, which in pairs],
            [slaves_of(sides, which) for sides, which in pairs],
        )
    )
    has_scalars = len(problem.unknowns) > len(problem.body_scalars)
    return every, every if has_scalars or not pays(every, every - slaves) else slaves


def _coupled(problem: Problem) -> float:
    """Squares of the dofs of both surfaces, of all contacts between bodies; collective."""
    pairs = [contact for contact in problem.contacts if contact.forces.terms]
    sides = [(c.trace, c.sides.opposite) for c in pairs]
    return float(
        sum(
            (len(one.surface.dofs) + len(other.surface.dofs)) ** 2
            for one, other in sides
            if other is not None
        )
    )


def _between_ranks(problem: Problem) -> int:
    """Displacements that cells of several ranks share; collective."""
    space, topology = problem.spaces.displacement_space, problem.body.mesh.topology
    index_map, nodes = space.dofmap.index_map, space.dofmap.list
    touched: Flags = np.zeros(index_map.size_local + index_map.num_ghosts, dtype=bool)
    touched[nodes[: topology.index_map(topology.dim).size_local]] = True
    shared = int(touched[index_map.size_local :].sum())
    return int(total(problem.comm, shared)) * problem.spaces.components


# Unknowns from which multigrid is faster in 3D, by degree (measured on one rank).
_ITERATIVE_FROM = {1: 50_000, 2: 100_000}
# Dofs of contacts from which it is, with obstacles and between bodies, both surfaces counted: the
# Schur complement of ``condensed`` grows with them (likewise).
_LARGE_CONTACT, _LARGE_PAIR = 2_000, 2_500


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


def choose_solver(problem: Problem, is_kept: bool = False) -> SolverChoice:
    """The scene's solver, or the one that suits its sizes; collective.

    Args:
        problem: The problem.
        is_kept: Whether the body is to serve many problems, so that it is condensed.

    Raises:
        InputError: The solver that the scene asks for is not for its model.
        MachineError: The problem will not fit into the machine's memory.
    """
    wanted = problem.scene.solver.solver
    free = free_memory_for(problem.comm)
    points_hold = held_by_points_alone(problem)
    if points_hold and (wanted == "condensed" or (is_kept and wanted == "auto")):
        raise InputError(
            "coupling: one with kind = 'distributing' is all that holds a motion of the body, for "
            "which only solver.solver = 'full' is there; studies and sweeps, which keep the body, "
            "need a support, a contact or kind = 'rigid' beside it"
        )
    if problem.scene.is_exact and (left_out := why_not(problem)):
        raise InputError(
            f"{left_out}: not beside contacts that are solved exactly; take parameters above 0, or "
            'leave them out, and a strategy other than "exact"'
        )
    if wanted == "auto" and points_hold:
        reason = "a coupling in the mean is all that holds a motion of the body"
        choice = SolverChoice("full", reason, memory_estimate(problem, "full"))
    elif wanted == "auto" and problem.conduction is not None:
        reason = "temperatures are found together with contact pressures"
        choice = SolverChoice("condensed", reason, memory_estimate(problem, "condensed"))
    elif wanted == "auto" and moduli_change(problem.scene):
        reason = "moduli follow temperatures that change"
        choice = SolverChoice("condensed", reason, memory_estimate(problem, "condensed"))
    elif wanted == "auto" and problem.scene.is_exact:
        reason = "contacts are solved without penalty and smoothing"
        choice = SolverChoice("condensed", reason, memory_estimate(problem, "condensed"))
    elif wanted == "auto":
        choice = _of_kept_body(problem) if is_kept else _automatic(problem, free)
    else:
        if wanted == "iterative" and problem.elastic.ties:
            raise InputError(
                "solver.solver = 'iterative' is not for a coupling with kind = 'distributing'; use "
                "'condensed' or 'full'"
            )
        if wanted == "iterative" and not _suits_multigrid(problem):
            raise InputError(
                "solver.solver = 'iterative' is for 3D models, and not for nearly incompressible "
                "materials; use 'condensed' or 'full'"
            )
        if wanted == "iterative" and (why := cannot_be_carried(problem)):
            raise InputError(
                f"solver.solver = 'iterative' is not for this model: {why}; "
                f"solver.solver = 'condensed' would do{_or_other_slaves(problem)}"
            )
        choice = SolverChoice(wanted, "as the scene says", memory_estimate(problem, wanted))
    if choice.memory > free:
        raise MachineError(
            f"the solver '{choice.name}' needs about {choice.memory / 1e9:.2g} GB of memory for "
            f"{unknowns(problem):,} unknowns, and {free / 1e9:.2g} GB are free "
            f"{memory_limit(problem.comm)}; {_that_would_do(problem, choice, free)}{LESS_MEMORY}"
        )
    return choice


def _or_other_slaves(problem: Problem) -> str:
    """Advice on slaves that the scene names, without which there may be a choice that would do."""
    named = [f"'{contact.label}'" for contact in problem.scene.contact if contact.slave != "auto"]
    if not named:
        return ""
    return f", or perhaps contact.slave = 'auto' at {', '.join(named)}"


def _that_would_do(problem: Problem, refused: SolverChoice, free: float) -> str:
    """Advice to take another solver, if one fits that is for the model; collective."""
    names: list[Name] = []
    is_carried = not cannot_be_carried(problem) and not is_part_free(problem).any()
    if not problem.inertia.moves and _suits_multigrid(problem) and is_carried:
        names.append("iterative")
    names += ["condensed"] if problem.inertia.moves else ["condensed", "full"]
    for name in names:
        memory = memory_estimate(problem, name)
        if name != refused.name and memory <= free:
            needs = f"about {memory / 1e9:.2g} GB"
            return f"solver.solver = '{name}' needs {needs} and would do; or "
    return ""


def _of_kept_body(problem: Problem) -> SolverChoice:
    """The solver that costs least once it is there."""
    memory = memory_estimate(problem, "condensed", is_kept=True)
    return SolverChoice("condensed", "one factorisation of the bulk for all answers", memory)


def _automatic(problem: Problem, free: float) -> SolverChoice:
    """The solver expected to be fastest of those that fit; collective."""

    def choice(name: Name, reason: str) -> SolverChoice:
        return SolverChoice(name, reason, memory_estimate(problem, name))

    if problem.inertia.moves:
        return choice("condensed", "one factorisation of the bulk for all steps of the motion")
    if not any(contact.forces.terms for contact in problem.contacts):
        return choice("full", "nothing to iterate on")
    condensed = choice("condensed", "one factorisation of the bulk")
    if not _suits_multigrid(problem):
        return condensed
    if cannot_be_carried(problem):
        return condensed
    # Multigrid takes ever more cycles for bodies that contacts alone hold: rather none than no end.
    if is_part_free(problem).any():
        return choice("condensed", "one factorisation of bodies that contacts alone hold")
    if condensed.memory > free:
        return choice("iterative", "a factorisation would not fit into memory")
    # Each further step costs the iterative solver about half of the first, the other nothing.
    steps = 0.5 + 0.5 * len(problem.scene.load_steps.all_times)
    large = _LARGE_PAIR if problem.between_bodies else _LARGE_CONTACT
    if contact_unknowns(problem) > steps * large:
        return choice("iterative", "multigrid is faster than condensing onto so large a contact")
    if problem.between_bodies:
        return condensed
    if unknowns(problem) > steps * _ITERATIVE_FROM[problem.spaces.degree]:
        return choice("iterative", "multigrid is faster than a factorisation of this size")
    return condensed


def _suits_multigrid(problem: Problem) -> bool:
    """Whether there is multigrid for K: none for a mean stress, none that is sure on the axis."""
    elastic = problem.elastic
    joined = elastic.ties or problem.discrete.cut is not None  # of a sector a face follows another
    return problem.spaces.components == 3 and elastic.mixed is None and not joined


# Gives a body that is kept, condensed for a problem, None where it cannot serve; collective.
Condense = Callable[[Problem, Timings], CondensedBody | None]


def create_system(
    problem: Problem, choice: SolverChoice, timings: Timings, condense: Condense | None = None
) -> System:
    """The system that Newton's method is to solve; collective.

    Args:
        problem: The problem.
        choice: The solver.
        timings: Seconds so far.
        condense: Gives the body condensed, if one is kept for several problems.
    """
    if not problem.elastic.is_linear:
        return FiniteSystem(problem, timings)
    if choice.name == "condensed":
        body = condense and condense(problem, timings)
        near = near_nodes(problem) if body is None else []
        if body is None and solves_glued(problem, near):
            return GluedSystem(problem, timings, near)
        return (
            NearSystem(problem, timings, near)
            if any(near)
            else CondensedSystem(problem, timings, body)
        )
    return {"full": FullSystem, "iterative": IterativeSystem}[choice.name](problem, timings)
