"""Analytic and published benchmarks: ``fenics-contact verify``.

A module of cases ends with tuples of them; the one below lists them all.
"""

from fenics_contact.verification.calculix.beams import CALCULIX_BEAM_CASES
from fenics_contact.verification.calculix.rings import CALCULIX_RING_CASES
from fenics_contact.verification.case import Case, Finding, Outcome
from fenics_contact.verification.cells import CELLS_CASES
from fenics_contact.verification.exact import EXACT_CASES
from fenics_contact.verification.exact_limits import EXACT_LIMIT_CASES
from fenics_contact.verification.finite.rubber import FINITE_CASES
from fenics_contact.verification.memory_check import MEMORY_CASES
from fenics_contact.verification.published.assemblies import JOINT_CASES, PRESS_FIT_CASES
from fenics_contact.verification.published.cycle import CYCLE_CASES, WEAR_CASES, WEAR_LIMIT_CASES
from fenics_contact.verification.published.fretting import FRETTING_CASES
from fenics_contact.verification.published.friction import FRICTION_CASES, INCLINE_CASES
from fenics_contact.verification.published.friction_bounds import (
    BY_PRESSURE_CASES,
    MICRO_SLIP_CASES,
    SLIP_WEAKENING_CASES,
)
from fenics_contact.verification.published.hertz_pair import (
    HERTZ_PAIR_CASES,
    NONLOCAL_FRICTION_CASES,
)
from fenics_contact.verification.published.indenters import LINE_CASES, POINT_CASES, PUNCH_CASES
from fenics_contact.verification.published.pair import PAIR_CASES, PAIR_WAYS_CASES
from fenics_contact.verification.published.rotors import (
    COUPLING_CASES,
    ROTOR_CASES,
    SHAFT_TORQUE_CASES,
)
from fenics_contact.verification.published.shear import SHEAR_CASES, SLAB_CASES
from fenics_contact.verification.published.sliding import MOTION_CASES, SQUEAL_CASES
from fenics_contact.verification.published.torque import (
    COMPLIANCE_CASES,
    ORTHOTROPIC_CASES,
    TORQUE_CASES,
)
from fenics_contact.verification.published.vibration import DAMPING_CASES, MODES_CASES
from fenics_contact.verification.thermal.heat import HEAT_CASES
from fenics_contact.verification.thermal.temperatures import TEMPERATURE_CASES

CASES: tuple[Case, ...] = (
    *SLAB_CASES,
    *POINT_CASES,
    *LINE_CASES,
    *PUNCH_CASES,
    *FRICTION_CASES,
    *SHEAR_CASES,
    *CYCLE_CASES,
    *PAIR_CASES,
    *PAIR_WAYS_CASES,
    *CELLS_CASES,
    *HERTZ_PAIR_CASES,
    *INCLINE_CASES,
    *NONLOCAL_FRICTION_CASES,
    *PRESS_FIT_CASES,
    *JOINT_CASES,
    *COMPLIANCE_CASES,
    *BY_PRESSURE_CASES,
    *SLIP_WEAKENING_CASES,
    *MICRO_SLIP_CASES,
    *ORTHOTROPIC_CASES,
    *TORQUE_CASES,
    *SHAFT_TORQUE_CASES,
    *COUPLING_CASES,
    *ROTOR_CASES,
    *TEMPERATURE_CASES,
    *HEAT_CASES,
    *EXACT_CASES,
    *EXACT_LIMIT_CASES,
    *FINITE_CASES,
    *WEAR_CASES,
    *WEAR_LIMIT_CASES,
    *FRETTING_CASES,
    *MOTION_CASES,
    *SQUEAL_CASES,
    *MODES_CASES,
    *DAMPING_CASES,
    *CALCULIX_BEAM_CASES,
    *CALCULIX_RING_CASES,
    *MEMORY_CASES,
)

__all__ = ["CASES", "Case", "Finding", "Outcome"]
