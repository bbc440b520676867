"""How much memory each solver needs: what it holds, part by part.

The constants below are measured by ``benchmarks/memory_use.py``, which runs scenes in processes of
their own, compares, and says by which factor each part would have to change.
"""

from __future__ import annotations

from math import log2, sqrt
from typing import Literal

import numpy as np

from fenics_contact.common.arrays import Flags
from fenics_contact.common.parallel import total
from fenics_contact.common.petsc import mumps
from fenics_contact.problem.problem import Problem

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
# dofs)². Of two bodies P couples every dof of a slave to every one of its master: that is in the
# tangent of ``full``, in bytes over (dofs of both surfaces)²; ``iterative`` only applies P.
_DENSE = {"condensed": 60.0, "full": 0.0, "iterative": 0.0}
_COUPLED = {"condensed": 0.0, "full": 75.0, "iterative": 0.0}

# Error bars: bytes for every dof of every cell, of the local problems (measured in space:
# 470-700).
_ERROR_BARS = {2: 150.0, 3: 500.0}


def memory_estimate(problem: Problem, name: Name) -> float:
    """Bytes that a run needs on all ranks together, above the program at rest; collective."""
    return sum(memory_terms(problem, name).values())


def memory_terms(problem: Problem, name: Name) -> dict[str, float]:
    """The same by what needs it (bytes); collective."""
    count, contact = unknowns(problem), contact_unknowns(problem)
    matrix = _matrix(problem)
    terms = {
        "program": _PROGRAM * problem.comm.size,
        "mesh": _CELL * _cells(problem) + _UNKNOWN * count,
        "dense": _DENSE[name] * (contact + _between_ranks(problem)) ** 2,
        "pairs": _COUPLED[name] * _coupled(problem),
    }
    if _has_error_bars(problem, name):
        local = _ERROR_BARS[problem.spaces.components] * _dofs_of_cell(problem)
        terms["error bars"] = local * _cells(problem)
    if name == "iterative":
        return terms | {"multigrid": _MULTIGRID * matrix, "zone": _ZONE * contact}
    return terms | {
        "matrix": _COPIES * matrix,
        "factor": 8 * _WORKSPACE * _factor_entries(problem, name),
    }


def _has_error_bars(problem: Problem, name: Name) -> bool:
    """Whether a run estimates the errors that the mesh makes."""
    wanted = problem.scene.solver.errors
    if wanted == "auto":
        return name == "condensed" or problem.scene.accuracy is not None
    return wanted == "all"


def _factor_entries(problem: Problem, name: Name) -> float:
    """Of MUMPS, of every body by itself: what touches another one is condensed onto or small."""
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
    acting = [contact for contact in problem.contacts if contact.forces.terms]
    dofs = [contact.trace.surface.dofs for contact in acting]
    dofs += [t.surface.dofs for c in acting if (t := c.sides.opposite) is not None]
    return len(np.unique(np.concatenate(dofs))) if dofs else 0


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
