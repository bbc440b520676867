"""What wear over many cycles costs: ``python benchmarks/wear_cost.py``; some minutes.

A parabola is pressed onto a block, and moved to and fro by so little that the middle sticks: 10,000
cycles of 40 load steps, about 200 contact dofs. Seconds are those of the processor.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path as File
from typing import Any

from mpi4py import MPI

from fenics_contact import (
    Contact,
    CycleJump,
    Cycles,
    Material,
    Obstacle,
    Path,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    Wear,
)
from fenics_contact.verification.boxes import Box, boxes

_CELLS, _QUICK_CELLS = (48, 16), (24, 8)
_CYCLES, _QUICK_CYCLES = 10_000, 100


def scene(cycles: int, coefficient: float) -> Scene:
    """Of so many cycles.

    Args:
        cycles: How many.
        coefficient: Of wear (1/stress).
    """
    obstacle = Obstacle(
        "parabola",
        radius=1,
        position=(0.5, 1),
        indentation=0.02,
        path=Path(time=(0, 1), factor=(0, 1)),
        displacement=(0.006, 0),
        displacement_path=Path(time=(1, 2, 4, 5), factor=(0, 1, -1, 0)),
    )
    contact = Contact(
        "block.y1",
        obstacle=obstacle,
        friction_coefficient=0.5,
        law="incremental",
        wear=Wear(coefficient),
    )
    return Scene(
        kinematics="plane strain",
        material=(Material(1000, 0.3),),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(contact,),
        steps=Steps(number=2, end=1),
        cycles=Cycles(begin=1, end=5, number=cycles, increments=40, until="end"),
        solver=SolverSettings(errors="none"),
    )


def measure(cells: tuple[int, int], cycles: int, coefficient: float) -> dict[str, Any]:
    """Solve it, and count.

    Args:
        cells: Along the block and across it.
        cycles: How many.
        coefficient: Of wear (1/stress).
    """
    body = boxes((Box("block", (0, 0), (1, 1), cells),), comm=MPI.COMM_SELF)
    begin = time.process_time()
    study = Study(scene(cycles, coefficient), MPI.COMM_SELF, body)
    every = list(study.wear_cycles(jumps=CycleJump()))
    first, last = every[0], every[-1]
    stuck = [one.contacts[0]["stick_area"] for one in (first, last)]
    return {
        "case": f"fretting, {cells[0]} x {cells[1]} cells",
        "contact_dofs": 2 * len(last.points.gap),
        "cycles": last.number,
        "increments": 40,
        "shown_cycles": len(every),
        "seconds": time.process_time() - begin,
        "worn_volume": last.worn_volume,
        "worn_volume_error": last.errors["worn_volume"] / last.worn_volume,
        "max_wear_depth": last.max_wear_depth,
        "max_wear_depth_error": last.errors["max_wear_depth"] / last.max_wear_depth,
        "stick_area_of_first_and_last": stuck,
    }


def main() -> int:
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="100 cycles on a coarse mesh")
    parser.add_argument("--json", type=File, help="write the row to this file")
    asked = parser.parse_args()
    sizes = (_QUICK_CELLS, _QUICK_CYCLES, 5e-4) if asked.quick else (_CELLS, _CYCLES, 1e-5)
    row = measure(*sizes)
    for name, value in row.items():
        print(f"{name:30} {value}")
    if asked.json:
        asked.json.write_text(json.dumps([row], indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
