"""What the page says in numbers: how many times longer a peer takes to the same error."""

from __future__ import annotations

import dataclasses

from problems import Problem
from rows import Point, Row, answered, mean_ratio, program_envelope, ratios

OURS = "fenics_contact"
BARE, WHOLE = "no error bars", "all of it (default)"
SOLVE, PROCESS = "solve_seconds", "process_seconds"


@dataclasses.dataclass(frozen=True)
class Comparison:
    """Of a peer's seconds with ours, at the errors of its envelope.

    Attributes:
        found: Ratios, from its coarsest point to its best; above 1 the peer takes longer.
        beyond: How many of its points are better than all of ours.
    """

    found: list[float]
    beyond: int

    def __str__(self) -> str:
        """Geometric mean and range."""
        words = []
        mean = mean_ratio(self.found)
        if mean is not None:
            words.append(f"**{mean:.2g}** ({min(self.found):.2g} to {max(self.found):.2g})")
        if self.beyond:
            words.append(f"at {self.beyond} of {self.beyond + len(self.found)} none of ours")
        return "; ".join(words)


def compare(
    problem: Problem, rows: list[Row], peer: str, quantity: str, setting: str, phase: str
) -> Comparison | None:
    """A peer with ours; None if one of them has no answer.

    Args:
        problem: That both solve.
        rows: All that were measured.
        peer: What it is called.
        quantity: Whose error is meant.
        setting: Of ours, ``BARE`` or ``WHOLE``.
        phase: ``SOLVE`` or ``PROCESS``.
    """

    def best(**keys: str) -> list[Point]:
        chosen = answered(rows, problem=problem.name, **keys)
        return program_envelope(chosen, quantity, problem.references[quantity], phase)

    ours, theirs = best(program=OURS, setting=setting), best(program=peer)
    if not ours or not theirs:
        return None
    found = ratios(ours, theirs)
    return Comparison(found, len(theirs) - len(found))
