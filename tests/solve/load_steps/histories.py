"""Scenes with load steps, for tests of histories and of restarts."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Obstacle,
    Path,
    Result,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
PRESSED = Path(time=(0, 0.5, 1), factor=(0, 1, 1))
DRAGGED = Path(time=(0, 0.5, 1), factor=(0, 0, 1))


def dragged(steps, law="incremental", path=PRESSED, solid=0.3, degree=2, driven=None, **solver):
    """A parabola pressed onto a block until time .5, then dragged along it."""
    obstacle = Obstacle(
        "parabola",
        radius=1,
        position=(0.5, 1),
        displacement=(0.004, 0),
        path=path,
        displacement_path=DRAGGED,
        **(driven or {"indentation": 0.02}),
    )
    return Scene(
        kinematics="plane strain",
        material=Material(1000, solid),
        discretisation=Discretisation(degree),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.3, law=law),),
        steps=steps,
        solver=SolverSettings(**solver),
    )


def block(comm=COMM):
    return box_body((8, 6), (1, 1), comm=comm)


def shoved(steps, **solver):
    """A block pressed onto another one until time .5, then shoved along it by a fifth."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"y": -0.01}, path=PRESSED),
            Support("upper.y1", {"x": 0.2}, path=DRAGGED),
        ),
        contact=(
            Contact("upper.y0", against="lower.y1", friction_coefficient=0.3, law="incremental"),
        ),
        steps=steps,
        solver=SolverSettings(**solver),
    )


def two_blocks(comm=COMM):
    lower, upper = Box("lower", (0, -1), (2, 0), (12, 5)), Box("upper", (0.1, 0), (1.1, 1), (4, 3))
    return boxes((lower, upper), comm=comm)


def times(result: Result) -> tuple[float, ...]:
    return tuple(step["load_factor"] for step in result.steps)


# Of a single step, the work is that of the final forces.
OF_THE_PATH = {"external_work", "energy_defect"}


def require_same(found: Result, expected: Result, tolerance: float = 1e-9) -> None:
    """The same numbers at the end, over the largest of their kind, and at every point."""
    alike = {len(found.steps), len(expected.steps)} == {1} or 1 not in map(
        len, (found.steps, expected.steps)
    )
    for key, value in expected.quantities.items():
        if key in OF_THE_PATH and not alike:
            continue
        if value is None:
            assert found.quantities[key] is None, key
            continue
        kind = ("normal_force", "max_contact_pressure") if "reaction" in key else (key,)
        kind = ("strain_energy",) if key == "energy_defect" else kind
        sizes = [expected.quantities[name] for name in (key, *kind)]
        size = max(np.abs(size).max() for size in sizes if size is not None)
        difference = np.abs(np.array(found.quantities[key]) - np.array(value)).max()
        assert difference <= tolerance * size, key
    assert found.points is not None and expected.points is not None
    for name in ("contact_pressure", "friction_traction", "slip"):
        ours, theirs = getattr(found.points, name), getattr(expected.points, name)
        size = np.abs(theirs).max(initial=0.0)
        assert np.abs(ours - theirs).max(initial=0.0) <= tolerance * size, name
    assert (found.points.status == expected.points.status).all()
