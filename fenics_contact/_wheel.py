"""The wheel of PyPI wants ``dolfinx_solver`` before dolfinx and PETSc: then, and no sooner."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

_AFTER_IT = ("dolfinx", "petsc4py", "slepc4py")


class _SolverFirst:
    """Finds no module; loads ``dolfinx_solver`` when one that must come after it is looked for."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Called by ``import`` for every module that is not loaded yet.

        Args:
            name: Of the module.
            path: Of its package.
            target: As ``importlib`` has it.
        """
        if name in _AFTER_IT:
            with suppress(ValueError):  # another thread was faster
                sys.meta_path.remove(cls)
            if PathFinder.find_spec("dolfinx_solver") is not None:
                import dolfinx_solver  # noqa: F401
        return None


def have_solver_first() -> None:
    """Let ``dolfinx_solver``, where there is one, be loaded before all that must come after it."""
    if not any(name in sys.modules for name in _AFTER_IT):
        sys.meta_path.insert(0, _SolverFirst)
