"""Errors, each with the exit code that users' scripts rely on, and exit codes in words."""

from __future__ import annotations


class FenicsContactError(Exception):
    """A failure that one sentence explains to the user.

    Attributes:
        exit_code: With which ``fenics-contact`` ends.
    """

    exit_code = 1


class InputError(FenicsContactError):
    """The scene, its mesh or the output folder cannot be used as given."""

    exit_code = 2


class SceneError(InputError, ValueError):
    """A part of a scene, made in Python, cannot be as it is; a ``ValueError``, too."""


class NoEquilibriumError(InputError):
    """The loads exceed what friction and supports can carry (paper, (2.4)).

    A block that friction can hold up to .5 × 20 is pulled by 30:

    >>> from fenics_contact import load_scene, main, run
    >>> main(["new", "own", "--quiet"])  # writes own.toml and own.geo
    0
    >>> try:
    ...     run(load_scene("own.toml", ["load.1.traction=[30, 0]"]))
    ... except NoEquilibriumError as error:
    ...     print(error.exit_code)
    2
    """


class NotConvergedError(FenicsContactError):
    """The nonlinear solver stopped without an answer.

    Args:
        message: What happened and what to try, in words.
        residual_history: Force imbalance after every Newton step (force units).
        attempts: Every strategy that was tried, with what happened.

    ``run`` turns it into a result that has not converged.
    """

    exit_code = 3

    def __init__(
        self,
        message: str,
        residual_history: tuple[float, ...] = (),
        attempts: tuple[str, ...] = (),
    ) -> None:
        super().__init__(message, residual_history, attempts)
        self.residual_history = residual_history
        self.attempts = attempts

    def __str__(self) -> str:
        return str(self.args[0])


class StoppedError(FenicsContactError):
    """The user, or the machine's keeper, asked to stop."""

    exit_code = 130


class MachineError(FenicsContactError):
    """The machine has not what the scene needs, such as memory."""

    exit_code = 5


_OUTCOMES = {
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
    return _OUTCOMES.get(exit_code, f"exit code {exit_code}")
