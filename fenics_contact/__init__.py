"""Contact with friction in elastostatics, after Campos, Oden and Kikuchi (1982).

A scene is frozen data (``Scene``, or a TOML file through ``load_scene``); ``run``
solves it and returns a ``Result``. The names below are the public interface.
"""

from fenics_contact import compat  # noqa: F401  (loads FEniCSx in the right order)
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
from fenics_contact.scene import (
    Discretisation,
    Load,
    MeshSource,
    Point,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.scene_accuracy import Accuracy
from fenics_contact.scene_contact import Contact, HalfSpace, Obstacle
from fenics_contact.scene_file import load_scene
from fenics_contact.scene_material import Material
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
