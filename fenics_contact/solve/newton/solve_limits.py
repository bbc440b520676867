"""What solves by Newton's method may take, in steps, and did take, in seconds of factorisations."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from petsc4py import PETSc

from fenics_contact.common.errors import FenicsContactError, NotConvergedError


class BudgetExceededError(FenicsContactError):
    """More Newton steps would be needed than are allowed; other ways would need some, too."""

    exit_code = NotConvergedError.exit_code


class StepBudget:
    """Newton steps that solves may take together.

    Steps are counted, and not seconds: so the same is found on any number of ranks and by any
    machine.
    """

    def __init__(self) -> None:
        self._left: int | None = None
        self._words = ""

    @contextmanager
    def of(self, steps: int, words: str) -> Iterator[None]:
        """Allow so many steps inside, and any number afterwards.

        Args:
            steps: How many.
            words: What happened once they are used up.
        """
        self._left, self._words = steps, words
        try:
            yield
        finally:
            self._left = None

    def count(self, iteration: int) -> None:
        """Note that a solve tests its convergence.

        Args:
            iteration: Newton steps of this solve; none is taken before the first test.
        """
        if self._left is not None and iteration > 0:
            self._left -= 1

    @property
    def is_used_up(self) -> bool:
        """Whether no step is left."""
        return self._left is not None and self._left <= 0

    def require_left(self) -> None:
        """Refuse to go on without a step left.

        Raises:
            BudgetExceededError: On every rank.
        """
        if self.is_used_up:
            raise BudgetExceededError(self._words)


class FactorisationLog:
    """Seconds that PETSc spends on factorisations from now on."""

    _EVENTS = ("MatLUFactorSym", "MatLUFactorNum")

    def __init__(self) -> None:
        PETSc.Log.begin()
        self._before = self._read()

    def _read(self) -> float:
        return float(sum(PETSc.Log.Event(name).getPerfInfo()["time"] for name in self._EVENTS))

    def seconds(self) -> float:
        """Seconds that factorisations have taken since the start."""
        return self._read() - self._before
