"""What becomes of scenes at random."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI

from fenics_contact import FenicsContactError, Result, Run
from tests.random.balances import Balance, balance_of
from tests.random.heat_balances import heat_faults
from tests.random.scenes import RandomScene

ANSWERED, UNTRUSTED = 0, 4


@dataclass(frozen=True, eq=False)
class Outcome:
    """How a scene ended, the same on every rank.

    Attributes:
        code: Exit code.
        words: Verdict, or the message of a typed error.
        seconds: Of this rank, mesh and compilation included.
        mixed: Whether some contact slips and sticks at once.
        result: None after an error.
        balance: Of an answer with couplings, temperatures or heat.
    """

    code: int
    words: str
    seconds: float
    mixed: bool = False
    result: Result | None = None
    balance: Balance = field(default_factory=Balance)

    @property
    def finite(self) -> bool:
        """Whether all that was found are numbers; a gap may be infinite, before no obstacle."""
        if self.result is None:
            return True
        found = [*self.result.quantities.values(), *(c.value for c in self.result.checks.values())]
        points = self.result.points
        if points is not None:
            found += [points.contact_pressure, points.friction_traction, points.slip]
        return all(np.isfinite(value).all() for value in found if value is not None)


def outcome_of(random: RandomScene, comm: MPI.Comm = MPI.COMM_WORLD) -> Outcome:
    """Solve a scene; an error that is not typed goes through; collective."""
    start = time.monotonic()
    try:
        solved = Run(random.scene, comm, random.body(comm))
        result = solved.solve()
    except FenicsContactError as error:
        words = f"{type(error).__name__}: {error}"
        return Outcome(error.exit_code, words, time.monotonic() - start)
    seconds = time.monotonic() - start
    mixed, balance = slips_and_sticks(result), Balance()
    if (random.scene.coupling or random.scene.temperature) and result.exit_code == ANSWERED:
        balance = balance_of(solved, result, random.stress)
    elif random.scene.heat and result.exit_code == ANSWERED:
        balance = Balance(tuple(heat_faults(solved, result)))
    return Outcome(result.exit_code, result.verdict, seconds, mixed, result, balance)


def slips_and_sticks(result: Result) -> bool:
    """Whether some contact does both at once."""
    points = result.points
    if points is None:
        return False
    by_contact = [points.status[points.of(number)] for number in range(len(result.contacts))]
    return any({"STICK", "SLIP"} <= set(status.tolist()) for status in by_contact)
