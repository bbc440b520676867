"""Compliances of bodies at their contact points, and problems on them at random.

Half-planes and half-spaces by formulas; blocks of elements and demos by the program, condensed onto
their contact. Points at which no area counts, such as those on an axis of revolution, are left out.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

# The half-spaces stand with the tests.
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from mpi4py import MPI

# isort: split
import numpy as np
from exact_plain import plain_newton

from fenics_contact import Body, Scene, Study, load_scene
from fenics_contact.common.arrays import Array
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.exact import LocalProblem, PointLaws
from fenics_contact.verification.memory_check import BlockCase, flat, slab, square
from fenics_contact.verification.memory_worker import body_of, scene_of
from tests.solve.exact.problems import half_plane, half_space, pressed

DEMOS = Path(__file__).resolve().parent.parent / "demos"
# Demos with rigid obstacles, contact at nodes, Coulomb's law, and supports that hold their bodies:
# W of others has rigid motions in it, which leave few digits of anything else.
OF_DEMOS = ("annulus", "cattaneo", "sphere")
BLOCKS: dict[str, BlockCase] = {
    "square of Q2": square(43),
    "block of P1 tets": slab("P1 tets", 16),
    "flat block of Q1 hexes": flat(8, 4),
}
# Problems on which plain Newton cycles, in addition to the others.
CYCLING = 45
# Coefficients of friction, from the first to the second, evenly in their logarithm.
COEFFICIENTS = (0.01, 6.0)


@dataclass(frozen=True)
class Case:
    """A problem, and what it is of.

    Attributes:
        family: The body.
        problem: W, q and μ.
    """

    family: str
    problem: LocalProblem


def cases(number: int, seed: int, quick: bool = False) -> Iterator[Case]:
    """Problems on all bodies in turn.

    Args:
        number: How many.
        seed: Of what is drawn.
        quick: Only bodies that need no elements.
    """
    random = np.random.default_rng(seed)
    bodies = dict(_half_spaces() if quick else [*_half_spaces(), *_blocks(), *_demos()])
    every = [(name, problem) for name, problem in bodies.items()]
    for count in range(number):
        if count % (len(every) + 2) < len(every):
            name, problem = every[count % (len(every) + 2)]
            yield Case(name, _varied(problem, random))
        elif count % (len(every) + 2) == len(every):
            yield Case("half-plane, driven by a force", _driven(random))
        else:
            yield Case("dense at random", _dense(random))
    if not quick:
        yield from _cycling(bodies["square of Q2"], CYCLING, random)


def _cycling(problem: LocalProblem, number: int, random: np.random.Generator) -> Iterator[Case]:
    """Problems on which plain Newton does not converge."""
    found = 0
    while found < number:
        varied = _varied(problem, random)
        if not plain_newton(varied)[2]:
            found += 1
            yield Case("square of Q2, plain Newton cycles", varied)


def _half_spaces() -> list[tuple[str, LocalProblem]]:
    found = []
    for name, body, side in (("half-plane", half_plane, 60), ("half-space", half_space, 8)):
        compliance, places = body(side)
        laws = PointLaws(np.full(len(places), 0.3))
        found.append((name, pressed(compliance, places, 0.02, 0.004, laws)))
    return found


def _blocks() -> list[tuple[str, LocalProblem]]:
    comm = MPI.COMM_SELF
    scenes = {name: scene_of(case, "condensed") for name, case in BLOCKS.items()}
    return [(name, problem_of(scenes[name], body_of(BLOCKS[name], comm))) for name in BLOCKS]


def _demos() -> list[tuple[str, LocalProblem]]:
    found = []
    for name in OF_DEMOS:
        scene = load_scene(DEMOS / f"{name}.toml")
        scene = replace(scene, solver=replace(scene.solver, solver="condensed"))
        found.append((f"demo {name}", problem_of(scene)))
    return found


def _varied(problem: LocalProblem, random: np.random.Generator) -> LocalProblem:
    """Another depth, way along the contact and coefficient."""
    size, free = problem.dimension, problem.free.copy()
    across = free[::size]
    deepest = max(-across.min(), 1e-3 * np.ptp(across))
    across -= random.uniform(-0.9, 1.0) * deepest
    for along in range(1, size):
        free[along::size] -= random.uniform(-1, 1) * random.choice([0.05, 0.3, 1]) * deepest
    laws = PointLaws(np.full(problem.points, _coefficient(random)))
    return problem.with_laws(laws).with_free(free)


def _driven(random: np.random.Generator) -> LocalProblem:
    """A half-plane under an obstacle that a force drives."""
    compliance, places = half_plane(40)
    laws = PointLaws(np.full(40, _coefficient(random)))
    aside = random.uniform(-0.03, 0.03) * random.choice([0.05, 0.3, 1])
    problem = pressed(compliance, places, 0.0, aside, laws)
    whole = np.zeros((81, 81))
    whole[:80, :80] = compliance
    whole[:80:2, 80] = whole[80, :80:2] = -1.0
    force = 10 ** random.uniform(-1, 1.2)
    return LocalProblem(whole, np.append(problem.free, force), laws, scalars=1)


def _dense(random: np.random.Generator) -> LocalProblem:
    """A positive definite W whose points act on each other strongly."""
    size, points = int(random.choice([2, 3])), int(random.integers(1, 21))
    root = random.normal(size=(size * points, size * points + 2))
    laws = PointLaws(np.full(points, _coefficient(random)))
    return LocalProblem(root @ root.T, random.normal(size=size * points), laws)


def _coefficient(random: np.random.Generator) -> float:
    low, high = np.log(COEFFICIENTS)
    return float(np.exp(random.uniform(low, high)))


def problem_of(scene: Scene, body: Body | None = None) -> LocalProblem:
    """The problem of a scene with one rigid obstacle or several, at the end of its load steps.

    Args:
        scene: For the condensed solver, on one rank.
        body: Its mesh, if the scene names none.
    """
    study = Study(scene, MPI.COMM_SELF, body)
    with study._body_of(scene).stepping(scene, Timings()) as (load_steps, system):
        load_steps.solve()
        system.follow_loads()
        parts = [_rows(system, contact) for contact in system.problem.contacts]
        rows, gaps = (np.concatenate([part[i] for part in parts]) for i in range(2))
        coefficients, weights = (np.concatenate([part[i] for part in parts]) for i in range(2, 4))
        load = np.array(system._loads.condensed)
        found = np.linalg.solve(system.body.bulk.schur, np.column_stack([rows.T, load]))
    compliance = rows @ found[:, :-1]
    free = gaps + rows @ found[:, -1]
    return LocalProblem((compliance + compliance.T) / 2, free, PointLaws(coefficients), weights)


def _rows(system: CondensedSystem, contact: ContactSurface) -> tuple[Array, Array, Array, Array]:
    """Gaps and slips as rows over the free contact dofs, those at rest, coefficients and areas."""
    trace, kinematics, free = contact.trace, contact.kinematics, system.body.dofs.free
    size = system.problem.spaces.components
    counted = np.flatnonzero(trace.weights > 1e-9 * trace.weights.max())
    normals = trace.normals[counted, :size]
    index_map = system.problem.spaces.displacement_space.dofmap.index_map
    nodes = index_map.local_to_global(np.asarray(trace.nodes, dtype=np.int32))[counted]
    dofs = nodes[:, None] * size + np.arange(size)
    places = np.minimum(np.searchsorted(free, dofs), len(free) - 1)
    moves = free[places] == dofs
    frame = np.concatenate([-normals[:, None], _tangents(normals)], axis=1)
    rows = np.zeros((len(counted), size, len(free)))
    for axis in range(size):
        of_axis = frame[:, :, axis] * moves[:, axis : axis + 1]
        rows[np.arange(len(counted))[:, None], np.arange(size), places[:, axis : axis + 1]] += (
            of_axis
        )
    gaps = -np.einsum("pij,j->pi", frame, kinematics.displacement[:size])
    gaps[:, 0] = (kinematics.gap - kinematics.indentation)[counted]
    coefficients = contact.friction.bound_slope(contact.pressure())[counted]
    flat_rows = rows.reshape(-1, len(free))
    return flat_rows, gaps.ravel(), coefficients, trace.weights[counted]


def _tangents(normals: Array) -> Array:
    """Unit vectors along the surface, (points, along, components)."""
    if normals.shape[1] == 2:
        return np.stack([normals[:, 1], -normals[:, 0]], axis=1)[:, None]
    steep = np.abs(normals[:, :1]) < 0.9
    axis = np.where(steep, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = axis - np.einsum("ij,ij->i", axis, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normals, first)], axis=1)
