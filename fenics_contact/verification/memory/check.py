"""Whether estimates of memory are near what runs take, each in a process of its own.

Measured is the peak of resident memory above that before there is a mesh, of all ranks together.
The estimate is that of ``fenics-contact check``.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from mpi4py import MPI

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.parallel import environment_alone, on_root
from fenics_contact.verification.case import Case, Finding
from fenics_contact.verification.memory.table import ALL, FEW, MemoryRun

LEAST, MOST = 0.7, 1.5  # of the estimate over what was measured
COUNTS_FROM = 200e6  # bytes
_WORKER = "fenics_contact.verification.memory.worker"


class UnmeasuredError(FenicsContactError):
    """A run whose memory was to be measured failed."""


def measured(
    case: str, solver: str, errors: str = "auto", start: Sequence[str] = (sys.executable,)
) -> dict[str, Any]:
    """Estimate and measurement of a run in a process of its own, and what it is of.

    Args:
        case: Of the table, by its name.
        solver: As a scene names it.
        errors: Which error bars are made.
        start: What starts Python.

    Raises:
        UnmeasuredError: The run failed.
    """
    command = [*start, "-m", _WORKER, case, solver, errors]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=environment_alone()
    )
    if done.returncode:
        raise UnmeasuredError(f"{case} by {solver} failed:\n{done.stderr}")
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return row


def compared(row: dict[str, Any]) -> Finding | None:
    """An estimate over what was measured; None where so little was that it does not count."""
    if row["measured"] < COUNTS_FROM:
        return None
    ratio = row["estimate"] / row["measured"]
    said = f"{row['case']}: {row['solver']}"
    middle = (LEAST + MOST) / 2
    note = "" if row["converged"] else f"{said} did not converge"
    return Finding(
        said, ratio if row["converged"] else float("nan"), middle, MOST - middle, True, note
    )


def findings_of(runs: Sequence[MemoryRun]) -> Iterator[Finding]:
    """Of runs on one rank; collective, rank 0 starts them."""
    for case, solver, ranks in runs:
        if ranks > 1:  # a program that runs already is not to start others under mpirun
            continue
        row = on_root(MPI.COMM_WORLD, lambda: measured(case.name, solver))  # noqa: B023
        finding = compared(row)
        if finding is not None:
            yield finding


def _check(quick: bool) -> Iterator[Finding]:
    return findings_of(FEW if quick else ALL)


MEMORY_CASES = (
    Case(
        "memory",
        "estimates of memory by each solver, over measured",
        "peak of resident memory of a process of its own, above that before the mesh; .7 to 1.5",
        _check,
    ),
)
