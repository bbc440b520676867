"""Analytic and published benchmarks: ``fenics-contact verify``.

A module of cases ends with a tuple ``CASES``; the one below lists them all.
"""

from fenics_contact.verification.case import Case, Finding, Outcome
from fenics_contact.verification.fretting import cases as fretting_cases
from fenics_contact.verification.laws import by_pressure as by_pressure_cases
from fenics_contact.verification.laws import compliance as compliance_cases
from fenics_contact.verification.laws import micro_slip as micro_slip_cases
from fenics_contact.verification.laws import orthotropic as orthotropic_cases
from fenics_contact.verification.laws import slip_weakening as slip_weakening_cases
from fenics_contact.verification.laws import torque as torque_cases
from fenics_contact.verification.laws import wear as wear_cases
from fenics_contact.verification.laws import wear_limit as wear_limit_cases
from fenics_contact.verification.memory import check as memory_check
from fenics_contact.verification.motion import cases as motion_cases
from fenics_contact.verification.motion import squeal as squeal_cases
from fenics_contact.verification.published import cycle as cycle_cases
from fenics_contact.verification.published import friction as friction_cases
from fenics_contact.verification.published import hertz_pair as hertz_pair_cases
from fenics_contact.verification.published import incline as incline_cases
from fenics_contact.verification.published import joint as joint_cases
from fenics_contact.verification.published import line as line_cases
from fenics_contact.verification.published import nonlocal_friction as nonlocal_cases
from fenics_contact.verification.published import pair as pair_cases
from fenics_contact.verification.published import pair_ways as pair_ways_cases
from fenics_contact.verification.published import point as point_cases
from fenics_contact.verification.published import press_fit as press_fit_cases
from fenics_contact.verification.published import punch as punch_cases
from fenics_contact.verification.published import shear as shear_cases
from fenics_contact.verification.published import slab as slab_cases
from fenics_contact.verification.vibration import damping as damping_cases
from fenics_contact.verification.vibration import modes as modes_cases

CASES: tuple[Case, ...] = (
    *slab_cases.CASES,
    *point_cases.CASES,
    *line_cases.CASES,
    *punch_cases.CASES,
    *friction_cases.CASES,
    *shear_cases.CASES,
    *cycle_cases.CASES,
    *pair_cases.CASES,
    *pair_ways_cases.CASES,
    *hertz_pair_cases.CASES,
    *incline_cases.CASES,
    *nonlocal_cases.CASES,
    *press_fit_cases.CASES,
    *joint_cases.CASES,
    *compliance_cases.CASES,
    *by_pressure_cases.CASES,
    *slip_weakening_cases.CASES,
    *micro_slip_cases.CASES,
    *orthotropic_cases.CASES,
    *torque_cases.CASES,
    *wear_cases.CASES,
    *wear_limit_cases.CASES,
    *fretting_cases.CASES,
    *motion_cases.CASES,
    *squeal_cases.CASES,
    *modes_cases.CASES,
    *damping_cases.CASES,
    *memory_check.CASES,
)

__all__ = ["CASES", "Case", "Finding", "Outcome"]
