"""The names and keys that users have in their scripts and scenes are kept."""

import dataclasses

import pytest

import fenics_contact
from fenics_contact import Scene
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.values import Profile

NAMES = """
Accuracy AskedDerivatives Body Check ComplianceFriction Contact ContactPoints CoulombFriction
CycleJump Cycles Damping DerivativeRequest Discretisation Exploration FatigueLimits
FenicsContactError Fit FormulaFriction Fretting Group HalfSpace InputError Jumps Load Material
Measured MeshSource MicroSlipFriction Modes Motion MotionModes NoEquilibriumError NonlocalFriction
NormalCompliance NotConvergedError Objective Obstacle OrthotropicFriction OwnEnergy OwnFriction
OwnFrictionLaw OwnNormalLaw Path Point Preload PressureDependentFriction PressureFormula Profile
Rayleigh Result Rotation Run Scene SlipDependentFriction SolverSettings SpeedDependentFriction
Stability Steps StrainLifeLine Study Support Units UserContactEnergy UserFriction Wear WearCycle
WornCycle allow_laws fit load_scene main run run_and_keep run_script run_with_fields
"""
# Keys of the tables of a scene, in the order in which Python takes their values.
KEYS = """
Accuracy: main normal_force pressure_integral friction_force contact_force reaction
    max_contact_pressure contact_area stick_area slip_area contact_radius stick_radius max_slip
    indentation strain_energy external_work friction_work of max_levels max_dofs
DerivativeRequest: of by
ComplianceFriction: kind coefficient exponent
Contact: on pressure pressure_path name contact obstacle against slave penalty_parameter
    foundation_stiffness normal_law interference interference_path wear law friction_coefficient
    friction_law regularisation_parameter axis moment_about
CoulombFriction: kind
Cycles: end begin number increments until tolerance keep jumps
Damping: amplitudes modes by increments cycles tolerance
Discretisation: degree
FatigueLimits: torsion tension
FormulaFriction: kind bound parameters
Fretting: depth begin limits life
HalfSpace: on
CycleJump: pressure_change error fixed
Load: on traction pressure body_force path force moment at distribution acceleration rotation
Material: youngs_modulus poissons_ratio stiffness on density name
MeshSource: file parameters cell order size sizes curvature time_limit groups name
MicroSlipFriction: kind elastic_slip
Modes: number
Motion: step end velocity start rayleigh absorbing modes
MotionModes: number accuracy
NonlocalFriction: kind averaging_radius
NormalCompliance: kind coefficient exponent
Obstacle: shape radius inner_radius gap position normal along direction indentation force
    displacement path displacement_path
OrthotropicFriction: kind along across direction
OwnFrictionLaw: kind parameters
OwnNormalLaw: kind parameters
Path: time factor cycles
Point: name at
Preload: on axis force path locked_from name between
PressureDependentFriction: kind pressures shares
PressureFormula: kind pressure parameters
Profile: along at values
Rayleigh: mass stiffness
Rotation: speed axis at
Scene: kinematics material mesh title thickness discretisation support load preload contact point
    symmetry half_space accuracy derivatives tolerances fretting modes damping stability steps
    cycles motion solver units
SlipDependentFriction: kind slips shares
SolverSettings: strategy solver branches errors outer_tolerance max_outer_iterations tolerance
    max_iterations stabilisation
SpeedDependentFriction: kind speeds shares
Stability: number up_to points rayleigh
Steps: number end times automatic smallest largest area_change
StrainLifeLine: strength strength_exponent ductility ductility_exponent
Support: on displacement path name rotation moment_about
Units: length force
Wear: coefficient threshold share
"""


def tables_below(table):
    """Scene classes by their names, from one on."""
    found = {table.__name__: table}
    for key in keys_of(table):
        for inner in key.tables:
            found |= tables_below(inner)
    return found


def test_every_public_name_is_kept():
    """What is given another name keeps the old one as an alias."""
    assert [name for name in NAMES.split() if not hasattr(fenics_contact, name)] == []


@pytest.mark.parametrize(
    ("earlier", "present"),
    [
        ("AskedDerivatives", "DerivativeRequest"),
        ("Jumps", "CycleJump"),
        ("OwnEnergy", "UserContactEnergy"),
        ("OwnFriction", "UserFriction"),
        ("WornCycle", "WearCycle"),
        ("run_and_keep", "run_with_fields"),
    ],
)
def test_an_earlier_name_is_that_of_the_same_thing(earlier, present):
    assert getattr(fenics_contact, earlier) is getattr(fenics_contact, present)
    assert earlier not in fenics_contact.__all__


def test_a_study_wears_by_the_earlier_name():
    assert fenics_contact.Study.worn is fenics_contact.Study.wear_cycles


def test_every_key_of_a_scene_is_kept_in_its_order():
    """More keys may follow, or stand between those that are given by their names."""
    tables = tables_below(Scene) | {"Profile": Profile, "Path": fenics_contact.Path}
    for line in KEYS.strip().replace("\n    ", " ").splitlines():
        name, keys = line.split(": ")
        found = [field.name for field in dataclasses.fields(tables[name])]
        assert [key for key in found if key in keys.split()] == keys.split(), name
