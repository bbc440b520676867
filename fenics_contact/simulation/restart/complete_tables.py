"""Fingerprints in state files of format 1: tables with keys that have their defaults.

Which keys these are is fixed, since that format is no longer written; a key that a scene class gets
later does not belong here.
"""

from __future__ import annotations

from typing import Any

from fenics_contact.simulation.restart.fingerprint import keys_of_state

# Of each table, the keys that were in its fingerprint whatever their value.
_KEYS = {
    name: keys.split()
    for name, keys in {
        "Accuracy": "main normal_force pressure_integral friction_force contact_force reaction "
        "max_contact_pressure contact_area stick_area slip_area contact_radius stick_radius "
        "max_slip indentation strain_energy external_work friction_work of max_levels max_dofs",
        "Contact": "pressure pressure_path name contact obstacle against slave penalty_parameter "
        "foundation_stiffness law friction_coefficient regularisation_parameter",
        "Cycles": "begin",
        "Discretisation": "degree",
        "FormulaFriction": "parameters",
        "Load": "traction pressure body_force path",
        "Material": "youngs_modulus poissons_ratio stiffness on",
        "Motion": "velocity modes",
        "MotionModes": "number accuracy",
        "Obstacle": "shape radius inner_radius gap position normal along direction indentation "
        "force displacement path displacement_path",
        "OwnFrictionLaw": "parameters",
        "OwnNormalLaw": "parameters",
        "Path": "cycles",
        "Preload": "path locked_from name",
        "PressureFormula": "parameters",
        "Rayleigh": "mass stiffness",
        "Scene": "thickness discretisation support load contact point symmetry half_space accuracy",
        "Support": "path",
        "Wear": "threshold",
    }.items()
}


def keys_in_format_1(table: Any) -> dict[str, Any]:
    """Return the keys of a table that count in format 1, with their values.

    Args:
        table: Of a scene.
    """
    always = {key: getattr(table, key) for key in _KEYS.get(type(table).__name__, ())}
    return always | keys_of_state(table)
