"""Contact with friction in elastostatics, after Campos, Oden and Kikuchi (1982).

A scene is frozen data (``Scene``, or a TOML file through ``load_scene``); ``run``
solves it and returns a ``Result``. The names below are the public interface. They are loaded when
they are first used, so that ``fenics-contact --help`` does not wait for FEniCSx.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fenics_contact._wheel import have_solver_first
from fenics_contact.common import program

have_solver_first()
__version__ = program.VERSION

if TYPE_CHECKING:
    from fenics_contact.analyses.derivatives.table import DerivativeRequest
    from fenics_contact.analyses.fretting.table import FatigueLimits, Fretting, StrainLifeLine
    from fenics_contact.analyses.stability.table import Stability
    from fenics_contact.analyses.stress_lines.table import Line
    from fenics_contact.analyses.vibration.table import Damping, Modes
    from fenics_contact.analyses.wear_cycles.table import CycleJump
    from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
    from fenics_contact.cli.program import main, run_script
    from fenics_contact.common.errors import (
        FenicsContactError,
        InputError,
        NoEquilibriumError,
        NotConvergedError,
    )
    from fenics_contact.contact.laws.allowed import allow_laws
    from fenics_contact.contact.laws.friction.coulomb import UserFriction
    from fenics_contact.contact.laws.normal.energy_law import UserContactEnergy
    from fenics_contact.explore.exploration import Exploration
    from fenics_contact.mesh.tagged_mesh import Body, Group
    from fenics_contact.results.contact_points import ContactPoints
    from fenics_contact.results.result import Check, Result
    from fenics_contact.scene.body import Material, ModulusTable
    from fenics_contact.scene.contact import Contact, Wear
    from fenics_contact.scene.laws.friction_laws import (
        ComplianceFriction,
        CoulombFriction,
        FormulaFriction,
        MicroSlipFriction,
        NonlocalFriction,
        OrthotropicFriction,
        OwnFrictionLaw,
        PressureDependentFriction,
        SlipDependentFriction,
        SpeedDependentFriction,
    )
    from fenics_contact.scene.laws.law_tables import (
        NormalCompliance,
        OwnNormalLaw,
        PressureFormula,
    )
    from fenics_contact.scene.loading.conditions import Load, Point, Preload
    from fenics_contact.scene.loading.couplings import Coupling, Spring
    from fenics_contact.scene.loading.cycles import Cycles
    from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry
    from fenics_contact.scene.loading.heat import Conductance, Film, Heat
    from fenics_contact.scene.loading.inertia_kinds import Rotation
    from fenics_contact.scene.loading.motion import Motion, MotionModes, Rayleigh
    from fenics_contact.scene.loading.support_axes import SupportAxes
    from fenics_contact.scene.loading.supports import FaceRotation, Support
    from fenics_contact.scene.loading.temperatures import Temperature
    from fenics_contact.scene.obstacle import HalfSpace, Obstacle, ObstacleRotation
    from fenics_contact.scene.reading import load_scene
    from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
    from fenics_contact.scene.settings import Accuracy, SolverSettings, Steps
    from fenics_contact.scene.units.table import Units
    from fenics_contact.scene.values import Path, Profile
    from fenics_contact.simulation.fits.curves import Objective
    from fenics_contact.simulation.fits.fit import Fit, fit
    from fenics_contact.simulation.fits.measured import Measured
    from fenics_contact.simulation.runs import run, run_with_fields
    from fenics_contact.simulation.scene_run import Run
    from fenics_contact.simulation.studies.study import Study

    OwnEnergy, OwnFriction = UserContactEnergy, UserFriction
    AskedDerivatives, Jumps, WornCycle = DerivativeRequest, CycleJump, WearCycle
    run_and_keep = run_with_fields

__all__ = [
    "Accuracy",
    "Body",
    "Check",
    "ComplianceFriction",
    "Conductance",
    "Contact",
    "ContactPoints",
    "CoulombFriction",
    "Coupling",
    "CycleJump",
    "Cycles",
    "CyclicSymmetry",
    "Damping",
    "DerivativeRequest",
    "Discretisation",
    "Exploration",
    "FaceRotation",
    "FatigueLimits",
    "FenicsContactError",
    "Film",
    "Fit",
    "FormulaFriction",
    "Fretting",
    "Group",
    "HalfSpace",
    "Heat",
    "InputError",
    "Line",
    "Load",
    "Material",
    "Measured",
    "MeshSource",
    "MicroSlipFriction",
    "Modes",
    "ModulusTable",
    "Motion",
    "MotionModes",
    "NoEquilibriumError",
    "NonlocalFriction",
    "NormalCompliance",
    "NotConvergedError",
    "Objective",
    "Obstacle",
    "ObstacleRotation",
    "OrthotropicFriction",
    "OwnFrictionLaw",
    "OwnNormalLaw",
    "Path",
    "Point",
    "Preload",
    "PressureDependentFriction",
    "PressureFormula",
    "Profile",
    "Rayleigh",
    "Result",
    "Rotation",
    "Run",
    "Scene",
    "SlipDependentFriction",
    "SolverSettings",
    "SpeedDependentFriction",
    "Spring",
    "Stability",
    "Steps",
    "StrainLifeLine",
    "Study",
    "Support",
    "SupportAxes",
    "Temperature",
    "Units",
    "UserContactEnergy",
    "UserFriction",
    "Wear",
    "WearCycle",
    "allow_laws",
    "fit",
    "load_scene",
    "main",
    "run",
    "run_script",
    "run_with_fields",
]

# Where each of them is; a test compares this with the imports above.
_MODULES = {
    "simulation.runs": ("run", "run_with_fields"),
    "cli.program": ("main", "run_script"),
    "common.errors": (
        "FenicsContactError",
        "InputError",
        "NoEquilibriumError",
        "NotConvergedError",
    ),
    "contact.laws.allowed": ("allow_laws",),
    "contact.laws.friction.coulomb": ("UserFriction",),
    "contact.laws.normal.energy_law": ("UserContactEnergy",),
    "explore.exploration": ("Exploration",),
    "mesh.tagged_mesh": ("Body", "Group"),
    "results.contact_points": ("ContactPoints",),
    "results.result": ("Check", "Result"),
    "scene.scene": ("Discretisation", "Scene"),
    "scene.loading.conditions": ("Load", "Point", "Preload"),
    "scene.loading.couplings": ("Coupling", "Spring"),
    "scene.loading.cyclic_symmetry": ("CyclicSymmetry",),
    "scene.loading.support_axes": ("SupportAxes",),
    "scene.loading.supports": ("FaceRotation", "Support"),
    "scene.loading.temperatures": ("Temperature",),
    "scene.loading.inertia_kinds": ("Rotation",),
    "scene.settings": ("Accuracy", "SolverSettings", "Steps"),
    "scene.loading.cycles": ("Cycles",),
    "scene.loading.heat": ("Conductance", "Film", "Heat"),
    "analyses.wear_cycles.table": ("CycleJump",),
    "scene.loading.motion": ("Motion", "MotionModes", "Rayleigh"),
    "analyses.derivatives.table": ("DerivativeRequest",),
    "analyses.fretting.table": ("FatigueLimits", "Fretting", "StrainLifeLine"),
    "analyses.stability.table": ("Stability",),
    "analyses.stress_lines.table": ("Line",),
    "analyses.vibration.table": ("Damping", "Modes"),
    "scene.contact": ("Contact", "Wear"),
    "scene.obstacle": ("HalfSpace", "Obstacle", "ObstacleRotation"),
    "scene.laws.friction_laws": (
        "ComplianceFriction",
        "CoulombFriction",
        "MicroSlipFriction",
        "NonlocalFriction",
        "FormulaFriction",
        "OrthotropicFriction",
        "OwnFrictionLaw",
        "PressureDependentFriction",
        "SlipDependentFriction",
        "SpeedDependentFriction",
    ),
    "scene.laws.law_tables": ("NormalCompliance", "OwnNormalLaw", "PressureFormula"),
    "scene.reading": ("load_scene",),
    "scene.body": ("Material", "MeshSource", "ModulusTable"),
    "scene.units.table": ("Units",),
    "scene.values": ("Path", "Profile"),
    "simulation.fits.curves": ("Objective",),
    "simulation.fits.fit": ("Fit", "fit"),
    "simulation.fits.measured": ("Measured",),
    "simulation.scene_run": ("Run",),
    "simulation.studies.study": ("Study",),
    "analyses.wear_cycles.wear_cycle": ("WearCycle",),
}

# Names that users have in their scripts, and what they are called now.
_EARLIER_NAMES = {
    "AskedDerivatives": "DerivativeRequest",
    "Jumps": "CycleJump",
    "OwnEnergy": "UserContactEnergy",
    "OwnFriction": "UserFriction",
    "WornCycle": "WearCycle",
    "run_and_keep": "run_with_fields",
}


def __getattr__(name: str) -> Any:
    if name in _EARLIER_NAMES:
        return __getattr__(_EARLIER_NAMES[name])
    module = next((module for module, names in _MODULES.items() if name in names), None)
    if module is None:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    found = getattr(import_module(f"{__name__}.{module}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
