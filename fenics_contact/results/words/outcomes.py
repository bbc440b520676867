"""Exit codes in a word or two."""

from __future__ import annotations

_WORDS = {
    0: "passed",
    1: "ended by a fault of the program",
    2: "refused",
    3: "not converged",
    4: "failed a check",
    5: "failed by the machine",
    130: "not done",
}


def outcome_of(exit_code: int) -> str:
    """Return the outcome of a run in words.

    Args:
        exit_code: Of it.
    """
    return _WORDS.get(exit_code, f"exit code {exit_code}")
