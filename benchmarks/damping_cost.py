"""What damping over amplitude costs: ``python benchmarks/damping_cost.py``; some minutes.

Two layers of blocks of hexahedra, clamped at one end and pressed on each other over a part of their
length: about 100,000 unknowns and 500 contact dofs, and 20 amplitudes of the first mode. Seconds
are those of the processor, of the factorisation, of the modes and of all amplitudes.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path as File
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Damping,
    Discretisation,
    Load,
    Material,
    Modes,
    Scene,
    SolverSettings,
    Study,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes

# Of a layer: its length, width and height; and the length of the piece that touches the other.
_SIZE, _LAP = (100.0, 20.0, 5.0), 20.0
# Cells of the lap along, across and through; those of the rest are as many along a length.
_CELLS, _QUICK_CELLS = (6, 6, 10), (3, 3, 2)
_NAMES = ("lower", "upper")


def layers(cells: tuple[int, int, int]) -> tuple[Box, ...]:
    """Two layers, each of a piece that touches and one that does not.

    Args:
        cells: Of the piece that touches.
    """
    length, width, height = _SIZE
    along = round(cells[0] * (length - _LAP) / _LAP)
    found = []
    for name, low, begin in (("lower", -height, 0.0), ("upper", 0.0, length - _LAP)):
        lap = (length - _LAP, length)
        rest = (begin, begin + length - _LAP) if name == "lower" else (length, 2 * length - _LAP)
        for part, (left, right), count in ((name, lap, cells[0]), (f"{name}_rest", rest, along)):
            ends = (left, 0.0, low), (right, width, low + height)
            found.append(Box(part, *ends, (count, *cells[1:])))
    return tuple(found)


def scene(amplitudes: tuple[float, ...]) -> Scene:
    """A lap joint that a pressure holds together, clamped at one end.

    Args:
        amplitudes: Of the first mode (length).
    """
    return Scene(
        kinematics="3D",
        material=(Material(210e3, 0.3, density=7.85e-9),),
        support=(Support("lower_rest.x0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("lower.z0", pressure=2.0), Load("upper.z1", pressure=2.0)),
        contact=(
            Contact("upper.z0", against="lower.z1", friction_coefficient=0.3, law="incremental"),
        ),
        discretisation=Discretisation(2),
        modes=Modes(1),
        damping=Damping(amplitudes, increments=24),
        solver=SolverSettings(errors="none"),
    )


def measure(cells: tuple[int, int, int], amplitudes: tuple[float, ...]) -> dict[str, Any]:
    """Solve it, and count.

    Args:
        cells: Of the piece that touches.
        amplitudes: Of the first mode (length).
    """
    welded = [(name, f"{name}_rest") for name in _NAMES]
    body = boxes(layers(cells), "hexahedron", MPI.COMM_SELF, welded=welded)
    asked = scene(amplitudes)
    study = Study(asked, MPI.COMM_SELF, body)
    begin = time.process_time()
    state = study.solve({"damping": None, "modes": None})
    solved = time.process_time()
    study.vibration({"damping": None})
    modes = time.process_time()
    found = study.vibration()
    end = time.process_time()
    ratios = [row.damping_ratio for row in found.damping]
    return {
        "case": "lap joint",
        "dofs": state.model.dofs,
        "contact_dofs": 3 * state.model.contact_points,
        "amplitudes": len(found.damping),
        "increments": 24,
        "seconds_factorise_and_preload": solved - begin,
        "seconds_modes": modes - solved,
        "seconds_amplitudes": end - modes,
        "natural_frequency": found.modes[0].natural_frequency,
        "softest": min(row.natural_frequency for row in found.damping),
        "damping_ratio_first_and_largest": [ratios[0], max(ratios)],
        "notes": list(found.notes),
    }


def main() -> int:
    """Measure, print, and write if asked to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="3 amplitudes on a coarse mesh")
    parser.add_argument("--json", type=File, help="write the row to this file")
    asked = parser.parse_args()
    count = 3 if asked.quick else 20
    amplitudes = tuple(np.geomspace(0.02, 0.5, count).tolist())
    row = measure(_QUICK_CELLS if asked.quick else _CELLS, amplitudes)
    for name, value in row.items():
        print(f"{name:32} {value}")
    if asked.json:
        asked.json.write_text(json.dumps([row], indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
