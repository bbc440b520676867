"""What a step of motion costs: ``python benchmarks/motion_cost.py``; some minutes.

A block of linear cells flies against a round obstacle, is in touch with it for a while, and
rebounds: with all that its mesh can do, and in 20 of its modes. A step is what further steps of a
run take, with their checks and quantities, over a linear solve of the same block, held: assembly,
factorisation and one solve by MUMPS, the fastest of those in ``cost_solves``. Seconds are those of
the processor, on one rank.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import replace
from pathlib import Path as File
from typing import Any

from cost_solves import linear_seconds, linear_solvers

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Motion,
    MotionModes,
    Obstacle,
    Run,
    Scene,
    Support,
)
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.problem import Problem
from fenics_contact.verification.boxes import Box, boxes

# Cells along an edge.
_CELLS, _QUICK_CELLS = {"2D": 180, "3D": 20}, {"2D": 40, "3D": 8}
_MODES = 20
# Steps of the shorter run, which is in touch at its end, and of the longer one.
_SHORT, _LONG = 60, 260
_STEP, _SPEED = 4e-3, 0.1
# Linear solves a step that the project asks of itself.
_LIMITS = {"2D": 0.06, "3D": 0.03}


def moving(kind: str, modes: int | None, steps: int) -> Scene:
    """A block that touches the obstacle at time 0.

    Args:
        kind: 2D or 3D.
        modes: In which it moves, None for all that the mesh can do.
        steps: Their number.
    """
    is_plane = kind == "2D"
    low = (0.5, 0.0) if is_plane else (0.5, 0.5, 0.0)
    up = (0.0, 1.0) if is_plane else (0.0, 0.0, 1.0)
    shape = "cylinder" if is_plane else "sphere"
    return Scene(
        kinematics="plane strain" if is_plane else "3D",
        material=Material(1000.0, 0.3, density=1.0),
        discretisation=Discretisation(1),
        contact=(
            Contact(
                "block.y0" if is_plane else "block.z0",
                obstacle=Obstacle(shape, radius=2.0, position=low, normal=up),
            ),
        ),
        motion=Motion(
            step=_STEP,
            end=_STEP * steps,
            velocity={"block": tuple(-_SPEED * part for part in up)},
            modes=None if modes is None else MotionModes(number=modes, accuracy=1.0),
        ),
    )


def held(kind: str) -> Problem:
    """The same block, held and pushed, as a problem of statics."""
    top, components = ("block.y1", "xy") if kind == "2D" else ("block.z1", "xyz")
    at_rest = replace(
        moving(kind, None, 1),
        motion=None,
        contact=(),
        support=(Support(top[:-1] + "0", dict.fromkeys(components, 0.0)),),
        load=(Load(top, traction=tuple(float(axis == "x") for axis in components)),),
    )
    return Problem.on_mesh(at_rest, block(kind))


def block(kind: str) -> Body:
    """Its mesh."""
    count = CELLS[kind]
    dimension = int(kind[0])
    box = Box("block", (0.0,) * dimension, (1.0,) * dimension, (count,) * dimension)
    return boxes([box], "quadrilateral" if dimension == 2 else "hexahedron")


def seconds_a_step(kind: str, modes: int | None) -> tuple[float, float]:
    """CPU seconds of a further step, and of all before the first."""
    body, found = block(kind), []
    for steps in (_SHORT, _LONG):
        began = time.process_time()
        result = Run(moving(kind, modes, steps), body=body).solve(announce=lambda n, step: None)
        found.append(time.process_time() - began)
        assert result.passed, result.verdict
    step = (found[1] - found[0]) / (_LONG - _SHORT)
    return step, found[0] - _SHORT * step


def rows(kind: str) -> list[dict[str, Any]]:
    """With all that the mesh can do, and in few modes."""
    problem = held(kind)
    ways = linear_solvers(problem, "condensed").values()
    linear = min(linear_seconds(problem, way) for way in ways for _ in range(3))
    dofs = problem.spaces.displacement_space.dofmap.index_map.size_global * int(kind[0])
    found = []
    for modes in (None, _MODES):
        step, before = seconds_a_step(kind, modes)
        found.append(
            {
                "kind": kind,
                "unknowns": dofs,
                "modes": modes,
                "linear": linear,
                "step": step,
                "of_linear": step / linear,
                "before": before / linear,
                "limit": _LIMITS[kind],
            }
        )
    return found


def main() -> int:
    """Measure, print, and write if asked to."""
    asked = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    asked.add_argument("--quick", action="store_true", help="on coarse meshes")
    asked.add_argument("--json", type=File, help="file to write the rows to")
    chosen = asked.parse_args()
    CELLS.update(_QUICK_CELLS if chosen.quick else {})
    every = [row for kind in CELLS for row in rows(kind)]
    print("kind  unknowns  modes  linear   step      step/linear  limit  before/linear")
    for row in every:
        print(
            f"{row['kind']:4} {row['unknowns']:9,}  {row['modes'] or 'all':>5}  "
            f"{row['linear']:.3f} s {1e3 * row['step']:6.1f} ms {row['of_linear']:12.3f} "
            f"{row['limit']:6.2f} {row['before']:12.1f}"
        )
    if chosen.json:
        chosen.json.write_text(json.dumps(every, indent=1) + "\n", encoding="utf-8")
    return 0


CELLS = dict(_CELLS)

if __name__ == "__main__":
    sys.exit(main())
