"""Runs whose memory is measured, each in a process of its own, which prints a row as JSON.

``python -m fenics_contact.verification.memory_worker CASE SOLVER ERRORS``, also under
``mpirun -n N``. What is run are blocks with a body pressed in and pulled sideways. The body is a
rounded obstacle, or another block with a rounded foot, whose mesh does not match; in full contact
it is flat and touches everywhere.
"""

from __future__ import annotations

import dataclasses
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    HalfSpace,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.parallel import total
from fenics_contact.scene.loading.support_axes import ComponentName
from fenics_contact.scene.values import AXES
from fenics_contact.scene.values import Path as LoadPath
from fenics_contact.simulation.scene_run import Run
from fenics_contact.solve.solver_choice import contact_unknowns, memory_terms, unknowns
from fenics_contact.verification.memory_check import (
    ELEMENTS,
    SCENES,
    BlockCase,
    Seat,
    body_of_seat,
    scene_of_seat,
)

# isort: split
import dolfinx
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

# The obstacle's radius, indentation and displacement over a block of width 1: the contact's
# radius is about 0.14, and the inner two thirds of it stick.
RADIUS, INDENTATION, SIDEWAYS = 1.0, 0.02, 0.004
# A plane in full contact is moved farther: the block slips below its edges, and sticks inside.
SIDEWAYS_OF_PLANE = 0.008
HALF_WIDTH = 0.25  # of the surface on which contact is possible, where it is not all of the top
# Two blocks: how far the upper one is brought down, and the surfaces that may touch. The contact
# covers .7 to .9 of these, and all where it is flat.
APPROACH, HALF_WIDTH_OF_PAIR = 0.03, 0.22
APART = 1.0  # the blocks, until their sides are told apart
# A piece of a half-space is three times as wide as other blocks, and has cells that are seven
# times as wide outside as in the middle, where they are those of the others.
EXTENT, MIDDLE = 3.0, 0.35


def scene_of(case: BlockCase, solver: Any) -> Scene:
    """The block of a case, held at its bottom, and what is pressed against it."""
    several = case.steps > 1
    further = tuple(1 + (step + 1) / (case.steps - 1) for step in range(case.steps - 1))
    held = Support("bottom", dict.fromkeys(AXES[: case.dimension], 0.0))
    supports = (held, _moved_top(case)) if case.upper else (held,)
    return Scene(
        kinematics="plane strain" if case.dimension == 2 else "3D",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(ELEMENTS[case.element][1]),
        support=() if case.half_space else supports,
        half_space=HalfSpace(on=("outer",)) if case.half_space else None,
        contact=(_contact_of_two(case) if case.upper else _contact_with_obstacle(case),),
        steps=Steps(times=(1.0, *further)) if several else Steps(),
        solver=SolverSettings(solver=solver),
    )


def _moved_top(case: BlockCase) -> Support:
    """The upper block, pressed down and pulled sideways by its top."""
    motion: dict[ComponentName, float] = dict.fromkeys(AXES[: case.dimension], 0.0)
    motion["x"] = SIDEWAYS
    motion[AXES[case.dimension - 1]] = -APPROACH
    return Support("top", motion)


def _contact_of_two(case: BlockCase) -> Contact:
    return Contact("upper", against="lower", friction_coefficient=case.coefficient)


def _contact_with_obstacle(case: BlockCase) -> Contact:
    several = case.steps > 1
    back = LoadPath(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, -1.0))
    obstacle = _plane(case) if case.full_contact else _rounded(case)
    return Contact(
        "contact",
        friction_coefficient=case.coefficient,
        law="incremental" if several else "static",
        obstacle=replace(obstacle, displacement_path=back) if several else obstacle,
    )


def _rounded(case: BlockCase) -> Obstacle:
    return Obstacle(
        "parabola" if case.dimension == 2 else "paraboloid",
        radius=RADIUS,
        position=_middle_of_top(case),
        indentation=INDENTATION,
        displacement=(SIDEWAYS, *[0.0] * (case.dimension - 1)),
    )


def _plane(case: BlockCase) -> Obstacle:
    return Obstacle(
        "plane",
        position=_middle_of_top(case),
        indentation=INDENTATION,
        displacement=(SIDEWAYS_OF_PLANE, *[0.0] * (case.dimension - 1)),
    )


def _middle_of_top(case: BlockCase) -> tuple[float, ...]:
    return (*[0.5] * (case.dimension - 1), case.heights[0])


def body_of(case: BlockCase, comm: MPI.Comm) -> Body:
    """The mesh of a case with the boundaries that its scene names; collective."""
    mesh = _two_blocks(case, comm) if case.upper else _block(case.element, case.cells, comm)
    last = case.dimension - 1
    sides = _sides(mesh, case)
    facets = np.concatenate(list(sides.values()))
    lengths = [len(side) for side in sides.values()]
    tags = np.repeat(np.arange(1, len(sides) + 1, dtype=np.int32), lengths)
    order = np.argsort(facets)
    cell_map = mesh.topology.index_map(case.dimension)
    cells = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    groups = {name: Group(last, (number + 1,)) for number, name in enumerate(sides)}
    if case.upper:
        _round_and_lower(mesh.geometry.x, case)
    if case.half_space:
        _widen(mesh.geometry.x, case)
    return Body(
        mesh,
        dolfinx.mesh.meshtags(mesh, case.dimension, cells, np.ones_like(cells)),
        dolfinx.mesh.meshtags(mesh, last, facets[order], tags[order]),
        groups | {"body": Group(case.dimension, (1,))},
        "two blocks" if case.upper else "a block",
    )


def _sides(mesh: Any, case: BlockCase) -> dict[str, NDArray[np.int32]]:
    """Facets of the sides that scenes name, as meshed."""
    lower = case.heights[0]
    if case.half_space:
        top = _facets_at(mesh, lower)
        every = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: np.full(x.shape[1], True))
        return {"outer": np.setdiff1d(every, top), "contact": _inner(mesh, case, top)}
    bottom = _facets_at(mesh, 0.0)
    if not case.upper:
        return {"bottom": bottom, "contact": _inner(mesh, case, _facets_at(mesh, lower))}
    foot = lower + APART
    return {
        "bottom": bottom,
        "lower": _inner(mesh, case, _facets_at(mesh, lower)),
        "upper": _inner(mesh, case, _facets_at(mesh, foot)),
        "top": _facets_at(mesh, foot + case.heights[1]),
    }


def _inner(mesh: Any, case: BlockCase, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Facets of a side that may touch: all of them, or those in the middle."""
    if case.all_of_top or case.full_contact:
        return facets
    last = case.dimension - 1
    half = HALF_WIDTH_OF_PAIR if case.upper else HALF_WIDTH
    aside = np.abs(dolfinx.mesh.compute_midpoints(mesh, last, facets)[:, :last] - 0.5)
    return np.asarray(facets[(aside < half).all(axis=1)])


def _block(element: str, cells: tuple[int, ...], comm: MPI.Comm) -> Any:
    last = len(cells) - 1
    kind = getattr(dolfinx.mesh.CellType, ELEMENTS[element][0])
    make = dolfinx.mesh.create_box if last == 2 else dolfinx.mesh.create_rectangle
    corner = np.array([*[1.0] * last, cells[-1] / cells[0]])
    return make(comm, [np.zeros(last + 1), corner], list(cells), kind)


def _two_blocks(case: BlockCase, comm: MPI.Comm) -> Any:
    """One mesh of two parts, the upper one still flat and above the lower one; collective."""
    meshes = [_block(case.element, cells, MPI.COMM_SELF) for cells in case.blocks]
    lower, upper = (mesh.geometry.x[:, : case.dimension].copy() for mesh in meshes)
    upper[:, -1] += case.heights[0] + APART
    numbers = [compat.geometry_nodes(mesh).astype(np.int64) for mesh in meshes]
    points, cells = np.vstack([lower, upper]), np.vstack([numbers[0], numbers[1] + len(lower)])
    given = slice(None) if comm.rank == 0 else slice(0)
    return compat.create_mesh(comm, ELEMENTS[case.element][0], 1, points[given], cells[given])


def _round_and_lower(points: NDArray[np.float64], case: BlockCase) -> None:
    """Bring the upper block down; in place.

    Where its foot is rounded, each node stays higher by r²/2R than where it is flat.
    """
    last = case.dimension - 1
    above = points[:, last] > case.heights[0] + 0.5 * APART
    squares = ((points[above, :last] - 0.5) ** 2).sum(axis=1)
    points[above, last] -= APART
    if not case.full_contact:
        points[above, last] += squares / (2 * RADIUS)


def _widen(points: NDArray[np.float64], case: BlockCase) -> None:
    """Make the cells larger with their distance from the middle of the top; in place."""
    middle = np.array(_middle_of_top(case))
    from_middle = (points - middle) / 0.5  # -1 to 1, as the block is half as high as wide
    points[:] = middle + 0.5 * EXTENT * from_middle * (MIDDLE + (1 - MIDDLE) * from_middle**2)


def _facets_at(mesh: Any, height: float) -> NDArray[np.int32]:
    last = mesh.topology.dim - 1
    return np.asarray(
        dolfinx.mesh.locate_entities_boundary(mesh, last, lambda x: np.isclose(x[last], height))
    )


def resident(key: str) -> float:
    """Bytes of this process, from Linux: ``VmRSS`` now, ``VmHWM`` at the peak."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return 1024 * float(next(line for line in lines if line.startswith(key)).split()[1])


def row_of(name: str, solver: Any, errors: Any) -> dict[str, object]:
    """Solve a case as ``fenics-contact run`` does, and compare; collective."""
    comm = MPI.COMM_WORLD
    case = SCENES[name]
    before = resident("VmRSS")
    if isinstance(case, Seat):
        scene, body = scene_of_seat(case, solver), body_of_seat(case, comm)
    else:
        scene, body = scene_of(case, solver), body_of(case, comm)
    settings = dataclasses.replace(scene.solver, errors=errors)
    run = Run(dataclasses.replace(scene, solver=settings), comm, body)
    terms = memory_terms(run.problem, run.choice.name)
    sizes = {"dofs": unknowns(run.problem), "contact_dofs": contact_unknowns(run.problem)}
    result = run.solve()
    measured = total(comm, np.array(resident("VmHWM") - before))
    return {
        "case": name,
        "solver": solver,
        "ranks": comm.size,
        "errors": errors,
        **sizes,
        "converged": result.converged,
        "estimate": sum(terms.values()),
        "measured": float(measured),
        "terms": terms,
    }


if __name__ == "__main__":
    found = row_of(*sys.argv[1:4])
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))
