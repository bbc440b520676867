"""Laws of users: classes of modules that a command line or a script allows, and of no others.

A scene names such a law by ``module:Class``. It alone never makes anything run: the module must
have been allowed before.
"""

from __future__ import annotations

import importlib
import os
import sys
from types import ModuleType
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question

_modules: dict[str, ModuleType] = {}


def allow_laws(module: str) -> list[str]:
    """Allow scenes to name the laws of a module, for as long as this process lives.

    The module is imported, so what it does is done. It is looked for on Python's path and, after
    that, in the present folder.

    Args:
        module: Its name, as of ``import``; in a script of its own laws, ``__name__``.

    Returns:
        Names of its classes, of which those that are laws can be named by ``module:Class``.

    Raises:
        InputError: It cannot be imported.
    """
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        _modules[module] = importlib.import_module(module)
    except Exception as error:  # whatever a module of others does
        what = f"{type(error).__name__}: {error}"
        raise InputError(f"laws of '{module}': the module cannot be imported ({what})") from error
    return list(_classes(module, object))


def allowed_modules() -> list[str]:
    """Names of the modules that are allowed."""
    return list(_modules)


def own_law(name: str, of: type, where: str) -> Any:
    """The class that a scene names.

    Args:
        name: ``module:Class``.
        of: What it must be derived from.
        where: Of the key, for messages.

    Raises:
        InputError: The module is not allowed, or has no such class.
    """
    module, _, found = name.partition(":")
    said = f"{where} = '{name}'"
    if module not in _modules:
        raise InputError(
            f"{said}: laws of the module '{module}' are not allowed; if you trust it, say "
            f"--laws {module} (in Python: allow_laws('{module}'))"
        )
    known = _classes(module, of)
    if found not in known:
        hint = question(found, known) or f"; it has {', '.join(known) or 'none'}"
        raise InputError(f"{said}: '{module}' has no class '{found}' of {of.__name__}{hint}")
    return known[found]


def _classes(module: str, of: type) -> dict[str, Any]:
    """Classes that a module makes, not those that it imports."""
    return {
        name: made
        for name, made in vars(_modules[module]).items()
        if isinstance(made, type) and issubclass(made, of) and made.__module__ == module
    }
