"""GetFEM's own Newton's method with its line search, by MUMPS."""

from __future__ import annotations

from typing import Any

from problems import Block, Indentation

_RESIDUAL, _MOST = 1e-7, 100


def solved(model: Any, residual: float = _RESIDUAL) -> int:
    """From what is there; how many steps it took.

    Args:
        model: Of GetFEM.
        residual: At which it stops.
    """
    taken, converged = model.solve("max_res", residual, "max_iter", _MOST, "lsolver", "mumps")
    if not converged:
        raise RuntimeError(f"no convergence in {_MOST} Newton steps")
    return int(taken)


def pressed(model: Any, problem: Indentation | Block) -> int:
    """All load steps; how many of Newton's method they took.

    Args:
        model: With a depth ``d``, and an ``old`` displacement.
        problem: Of an obstacle that is pressed in.
    """
    newton = 0
    for step in range(1, problem.steps + 1):
        model.set_variable("d", [problem.indentation * step / problem.steps])
        model.set_variable("old", model.variable("u"))
        newton += solved(model)
    return newton
