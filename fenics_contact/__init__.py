"""Contact with friction in elastostatics, after Campos, Oden and Kikuchi (1982).

A scene is frozen data (``Scene``, or a TOML file through ``load_scene``); ``run``
solves it and returns a ``Result``. The names below are the public interface. They are loaded when
they are first used, so that ``fenics-contact --help`` does not wait for FEniCSx.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if find_spec("dolfinx_solver") is not None:  # the PyPI wheel: it must come before all of FEniCSx
    import dolfinx_solver  # noqa: F401

if TYPE_CHECKING:
    from fenics_contact.adaptivity import run
    from fenics_contact.cli import main, run_script
    from fenics_contact.errors import (
        FenicsContactError,
        InputError,
        NoEquilibriumError,
        NotConvergedError,
    )
    from fenics_contact.mesh import Body, Group
    from fenics_contact.result import Check, ContactPoints, Result
    from fenics_contact.scene import Discretisation, Load, MeshSource, Point, Scene, Support
    from fenics_contact.scene_accuracy import Accuracy
    from fenics_contact.scene_contact import Contact, HalfSpace, Obstacle
    from fenics_contact.scene_file import load_scene
    from fenics_contact.scene_material import Material
    from fenics_contact.scene_steps import SolverSettings, Steps
    from fenics_contact.scene_values import Path, Profile
    from fenics_contact.simulation import Run

__all__ = [
    "Accuracy",
    "Body",
    "Check",
    "Contact",
    "ContactPoints",
    "Discretisation",
    "FenicsContactError",
    "Group",
    "HalfSpace",
    "InputError",
    "Load",
    "Material",
    "MeshSource",
    "NoEquilibriumError",
    "NotConvergedError",
    "Obstacle",
    "Path",
    "Point",
    "Profile",
    "Result",
    "Run",
    "Scene",
    "SolverSettings",
    "Steps",
    "Support",
    "load_scene",
    "main",
    "run",
    "run_script",
]

# Where each of them is; a test compares this with the imports above.
_MODULES = {
    "adaptivity": ("run",),
    "cli": ("main", "run_script"),
    "errors": ("FenicsContactError", "InputError", "NoEquilibriumError", "NotConvergedError"),
    "mesh": ("Body", "Group"),
    "result": ("Check", "ContactPoints", "Result"),
    "scene": ("Discretisation", "Load", "MeshSource", "Point", "Scene", "Support"),
    "scene_accuracy": ("Accuracy",),
    "scene_contact": ("Contact", "HalfSpace", "Obstacle"),
    "scene_file": ("load_scene",),
    "scene_material": ("Material",),
    "scene_steps": ("SolverSettings", "Steps"),
    "scene_values": ("Path", "Profile"),
    "simulation": ("Run",),
}


def __getattr__(name: str) -> Any:
    module = next((module for module, names in _MODULES.items() if name in names), None)
    if module is None:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    found = getattr(import_module(f"{__name__}.{module}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
