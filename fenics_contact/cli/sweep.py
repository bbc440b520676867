"""Action and output of ``fenics-contact sweep``."""

from __future__ import annotations

import argparse
import logging
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from fenics_contact.cli.progress import counting
from fenics_contact.common.errors import InputError, StoppedError, outcome_of
from fenics_contact.common.failures import Interrupts
from fenics_contact.common.memory import cores
from fenics_contact.common.wording import one_line
from fenics_contact.report.page.sweep import write_sweep_page
from fenics_contact.scene.reading import SceneFile
from fenics_contact.simulation.output.run_folder import require_writable
from fenics_contact.simulation.sweeps.journal import NAME, PAGE, STATES_FILE, SUMMARY, TABLE, Done
from fenics_contact.simulation.sweeps.sweep import Sweep

logger = logging.getLogger(__name__)

_SHOWN = 5  # of the points that failed, on the terminal
# Exit codes in the order in which a summary counts them.
_ORDER = (0, 4, 3, 2, 5, 1)


def sweep(options: argparse.Namespace) -> int:
    """Solve a scene for all combinations of values, and return the exit code.

    Args:
        options: Of the command line.

    Raises:
        InputError: It is wrong, or no point can be solved; nothing is written.
        MachineError: The machine failed; points that are done are kept.
    """
    if MPI.COMM_WORLD.size > 1:
        raise InputError(
            "sweep: it runs on one rank, and solves points side by side on the cores (--jobs); "
            "start it without mpirun"
        )
    if not options.vary:
        raise InputError("sweep: --vary KEY=VALUES is missing; to solve one scene there is run")
    folder = options.out or Path("results") / f"{options.scene.stem}_sweep"
    require_writable(folder, MPI.COMM_SELF)
    file = SceneFile(options.scene)
    made = Sweep(file, options.overrides, options.vary, folder, options.resume)
    _solve(made, options.jobs, options.quiet)
    _draw(folder)
    code = made.exit_code
    if not options.quiet or code:
        print("\n".join(_said(made, folder)))
    return code


def _solve(made: Sweep, jobs: int | None, quiet: bool) -> None:
    """Solve it, or what there is time for until the user asks to stop."""
    total, bodies = len(made.points), len(made.groups)
    before = total - made.left
    logger.info("%s", _plan(total, made.left, bodies, jobs or cores()))
    heard: set[str] = set()
    failed = sum(done.exit_code != 0 for done in made.done.values())
    with Interrupts("point") as interrupts, counting(total, quiet) as count:
        count(before, _so_far(before, total, failed))

        def announce(number: int, done: Done) -> None:
            nonlocal failed
            failed += done.exit_code != 0
            count(len(made.done), _so_far(len(made.done), total, failed))
            logger.debug("point %d: exit code %d", number, done.exit_code)
            for words in done.warnings:
                if words not in heard:
                    heard.add(words)
                    logger.warning("point %d: %s", number, words)

        try:
            made.solve(jobs, announce, interrupts.requested)
        except StoppedError:
            if not made.has_files:
                raise


def _draw(folder: Path) -> None:
    """The page: the table stands without it."""
    try:
        write_sweep_page(folder)
    except InputError as error:
        logger.warning("no page: %s", error)


def _plan(total: int, left: int, bodies: int, jobs: int) -> str:
    """Return the plan of a sweep in words."""
    words = _count(total, "point")
    if left < total:
        words += f", {left} of them to be solved"
    return (
        f"{words}: {_count(bodies, 'body', 'bodies')}, up to {_count(jobs, 'process', 'processes')}"
    )


def _so_far(done: int, total: int, failed: int) -> str:
    return f"{done} of {_count(total, 'point')}" + (f", {failed} failed" if failed else "")


def _said(made: Sweep, folder: Path) -> Sequence[str]:
    """Return lines on a sweep: numbers of outcomes, the first failure, and the files."""
    found = Counter(done.exit_code for done in made.done.values())
    outcomes = [f"{found[code]} {outcome_of(code)}" for code in _ORDER if found[code]]
    if made.left:
        outcomes.append(f"{made.left} left; --resume goes on")
    lines = [f"{_count(len(made.points), 'point')}: {', '.join(outcomes)}"]
    failed = [(n, done) for n, done in sorted(made.done.items()) if done.exit_code]
    lines += [f"  row {n}, exit code {done.exit_code}: {done.said}" for n, done in failed[:_SHOWN]]
    if len(failed) > _SHOWN:
        lines.append(f"  … and {len(failed) - _SHOWN} more, in {SUMMARY}")
    lines.append(f"{_count(made.factorisations, 'factorisation')} of bodies")
    names = (TABLE, SUMMARY, STATES_FILE, PAGE, NAME)
    written = [name for name in names if (folder / name).exists()]
    lines.append(f"Wrote {', '.join(written)} in {folder}")
    return [one_line(line) for line in lines]


def _count(number: int, one: str, several: str = "") -> str:
    return f"{number} {one if number == 1 else several or f'{one}s'}"
