"""Time of factorisations within a solve, from PETSc's own log."""

from __future__ import annotations

from petsc4py import PETSc


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
