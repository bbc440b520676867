"""Export problems of contact with friction, with an answer each, in FCLIB's format.

``python benchmarks/exact_problems.py FOLDER [--number 1200] [--seed 1] [--quick]``.

A file a problem, ``FAMILY-NUMBER.hdf5``: half-spaces, blocks of elements and demos, each with other
depths, ways along the contact and coefficients of friction from .01 to 6; obstacles that a force
drives; dense matrices at random; and problems on a block on which plain semismooth Newton cycles.
Ends with 1 where a problem has no answer with a residual below 1e-11 of the forces; its best state
is written all the same.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from exact_bodies import cases
from exact_format import write_problem

from fenics_contact.solve.exact import solve


def export(folder: Path, number: int, seed: int, quick: bool) -> tuple[int, int]:
    """Write problems; their number, and how many of them have no answer.

    Args:
        folder: Where to.
        number: Of problems.
        seed: Of what is drawn.
        quick: Only bodies that need no elements.
    """
    folder.mkdir(parents=True, exist_ok=True)
    failed = count = 0
    for count, case in enumerate(cases(number, seed, quick), 1):
        answer = solve(case.problem)
        failed += not answer.converged
        name = case.family.replace(",", "").replace(" ", "-")
        problem = case.problem
        described = (
            f"{problem.points} points in {problem.dimension}D, "
            f"coefficient of friction {problem.laws.coefficient.max():.4g}, seed {seed}"
        )
        write_problem(folder / f"{name}-{count:05d}.hdf5", answer, case.family, described)
    return count, failed


def main() -> int:
    """Export; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--number", type=int, default=1200, metavar="N")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--quick", action="store_true", help="only bodies without elements")
    given = parser.parse_args()
    count, failed = export(given.folder, given.number, given.seed, given.quick)
    print(f"{count} problems in {given.folder}, {failed} without an answer")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
