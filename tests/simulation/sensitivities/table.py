"""A table of quantities and keys of small scenes, and how their derivatives compare with runs."""

import dataclasses

import numpy as np
from dolfinx.mesh import CellType

from fenics_contact import (
    ComplianceFriction,
    FormulaFriction,
    NonlocalFriction,
    Path,
    PressureDependentFriction,
    SlipDependentFriction,
    Steps,
    Study,
)
from fenics_contact.simulation.sensitivities.values import found_in
from fenics_contact.simulation.studies.changes import with_changes
from tests.scenes import box_body
from tests.simulation.studies.cases import (
    BALL,
    CASES,
    DEPTH,
    FORCE,
    MU,
    ON_A_FLOOR,
    PAD,
    of_contact,
    square,
)
from tests.solve.load_steps.histories import block, dragged


def by_depth(exponent, coefficient=3e5):
    return ComplianceFriction(kind="compliance", coefficient=coefficient, exponent=exponent)


NONLOCAL = NonlocalFriction(kind="nonlocal", averaging_radius=0.3)
EVERY = CASES | {
    "friction by depth": (
        of_contact(CASES["compliance"][0], friction_coefficient=0.0, friction_law=by_depth(2.2)),
        square,
        [],
    ),
    "friction by depth of springs": (
        of_contact(
            CASES["foundation"][0], friction_coefficient=0.0, friction_law=by_depth(1.5, 3e3)
        ),
        square,
        [],
    ),
    "friction by pressure": (
        of_contact(
            ON_A_FLOOR,
            friction_law=PressureDependentFriction(
                kind="pressure dependent", pressures=(0, 1, 3, 100), shares=(1, 0.9, 0.8, 0.3)
            ),
        ),
        square,
        [],
    ),
    "friction by slip": (
        of_contact(
            dragged(Steps(number=4)),
            friction_law=SlipDependentFriction(
                kind="slip dependent", slips=(0, 0.003, 0.02), shares=(1, 0.8, 0.5)
            ),
        ),
        block,
        [],
    ),
    "friction around points": (of_contact(ON_A_FLOOR, friction_law=NONLOCAL), square, []),
    "friction around points of rings": (
        of_contact(BALL, friction_law=NONLOCAL),
        CASES["half-space"][1],
        [],
    ),
    "friction by a formula": (
        of_contact(
            ON_A_FLOOR,
            friction_law=FormulaFriction(
                kind="formula", bound="mu * p / (1 + p / p0)", parameters={"p0": 4.0}
            ),
        ),
        square,
        [],
    ),
    "tetrahedra": (PAD, lambda: box_body((3, 3, 2), cell=CellType.tetrahedron), []),
}
AT_ONCE = Path((0, 1), (0, 1))
OBSTACLE, LAW = "contact.0.obstacle", "contact.0.friction_law"
E, NU = "material.0.youngs_modulus", "material.0.poissons_ratio"
# Of a run's quantities: what Newton's method leaves of forces.
ROUND_OFF = 1e-11
# Case of the studies' → changes that make it one load step under several things, quantities, keys.
TABLE = {
    "prescribed": (
        {},
        "friction_force_x external_work max_slip reaction_y x0.reaction_x",
        [MU, "contact.0.pressure", "load.0.traction.0", "load.0.traction.1", NU],
    ),
    "unilateral": (
        {},
        "normal_force friction_force_x reaction_x pressure_integral max_contact_pressure "
        "strain_energy external_work friction_work max_slip penalty_energy",
        [MU, "load.0.traction.0", "support.0.displacement.y", E, NU, "contact.0.penalty_parameter"],
    ),
    "foundation": (
        {},
        "normal_force strain_energy reaction_y",
        ["contact.0.foundation_stiffness", MU, E],
    ),
    "compliance": (
        {},
        "normal_force friction_force_x external_work",
        ["contact.0.normal_law.coefficient", "contact.0.normal_law.exponent", MU],
    ),
    "incremental": (
        {"steps": Steps(times=(0.5, 0.75, 1.0))},
        "normal_force friction_force_x strain_energy max_slip reaction_x",
        [
            MU,
            DEPTH,
            f"{OBSTACLE}.displacement.0",
            f"{OBSTACLE}.radius",
            f"{OBSTACLE}.position.0",
            E,
        ],
    ),
    "half-space": (
        {},
        "normal_force strain_energy external_work max_contact_pressure reaction_y",
        [MU, DEPTH, f"{OBSTACLE}.radius", f"{OBSTACLE}.position.1", E, NU],
    ),
    "in space": (
        {
            f"{OBSTACLE}.shape": "sphere",
            f"{OBSTACLE}.radius": 4.0,
            f"{OBSTACLE}.position": (0.4, 0.45, 0),
        },
        "friction_force_x contact_force_x strain_energy indentation max_contact_pressure",
        [MU, FORCE, "load.0.traction.0", f"{OBSTACLE}.radius", f"{OBSTACLE}.position.0", E],
    ),
    "tetrahedra": (
        {
            f"{OBSTACLE}.shape": "sphere",
            f"{OBSTACLE}.radius": 4.0,
            f"{OBSTACLE}.position": (0.4, 0.45, 0),
        },
        "normal_force friction_force_x strain_energy reaction_x",
        [MU, "load.0.traction.0", f"{OBSTACLE}.radius"],
    ),
    "two bodies": (
        {
            "steps": Steps(),
            "contact.0.law": "static",
            "contact.0.interference": 1e-3,
            "support.1.path": AT_ONCE,
            "support.2.path": AT_ONCE,
            "support.2.displacement.x": 2e-4,
        },
        "normal_force friction_force_x strain_energy external_work max_contact_pressure",
        [MU, "support.1.displacement.y", "support.2.displacement.x", "contact.0.interference", NU],
    ),
    "bolt": (
        {"steps": Steps(), "preload.0.locked_from": None, f"{OBSTACLE}.path": AT_ONCE},
        "seat.normal_force bolt.elongation strain_energy external_work bottom.reaction_y",
        ["preload.0.force", FORCE],
    ),
    "nearly incompressible": (
        {},
        "normal_force strain_energy friction_force_x",
        [MU, "support.0.displacement.y", E, NU],
    ),
    "friction by depth": (
        {},
        "friction_force_x normal_force strain_energy max_slip",
        [
            f"{LAW}.coefficient",
            f"{LAW}.exponent",
            "contact.0.normal_law.coefficient",
            "contact.0.normal_law.exponent",
        ],
    ),
    "friction by depth of springs": (
        {},
        "friction_force_x friction_work",
        [f"{LAW}.coefficient", f"{LAW}.exponent", "contact.0.foundation_stiffness"],
    ),
    "friction by pressure": (
        {},
        "friction_force_x strain_energy friction_work",
        [MU, *(f"{LAW}.{key}" for key in ("shares.1", "shares.2", "pressures.2", "pressures.3"))],
    ),
    "friction by slip": (
        {},
        "friction_force_x normal_force max_slip strain_energy",
        [
            *(f"{LAW}.{key}" for key in ("shares.0", "shares.1", "slips.1")),
            MU,
            DEPTH,
            f"{OBSTACLE}.displacement.0",
        ],
    ),
    "friction around points": (
        {},
        "friction_force_x strain_energy max_slip",
        [f"{LAW}.averaging_radius", MU],
    ),
    "friction around points of rings": (
        {},
        "normal_force strain_energy max_contact_pressure",
        [f"{LAW}.averaging_radius", MU, DEPTH],
    ),
    "friction by a formula": (
        {},
        "friction_force_x strain_energy friction_work",
        [f"{LAW}.parameters.p0", MU],
    ),
}


def study_of(name, changes):
    """Of a case with its automatic parameters given as they are chosen."""
    scene, make, _ = EVERY[name]
    scene = with_changes(scene, changes)
    solver = dataclasses.replace(scene.solver, errors="none", tolerance=1e-13)
    scene = dataclasses.replace(scene, solver=solver)
    body = make()
    study = Study(scene, body=body)
    given = {}
    for number, contact in enumerate(study.solve().contacts):
        for key in ("penalty_parameter", "regularisation_parameter"):
            used = contact.parameters.get(key)
            if used and found_in(scene, f"contact.{number}.{key}") == "auto":
                given[f"contact.{number}.{key}"] = used
    study.scene = with_changes(scene, given)
    return study


def value_of(result, name):
    """A quantity of a result by its name."""
    owner, _, quantity = name.rpartition(".")
    axis = "xyz".find(quantity[-1]) if quantity[-2:] in ("_x", "_y", "_z") else None
    quantity = quantity if axis is None else quantity[:-2]
    found = dict(result.quantities)
    for contact in result.contacts:
        found |= contact.quantities if contact.name == owner else {}
    for support in result.supports:
        found |= {"reaction": support.reaction} if support.name == owner else {}
    if owner in result.preloads:
        found = vars(result.preloads[owner])
    return found[quantity] if axis is None else found[quantity][axis]


def differences(study, of, key, share=3e-4):
    """Central differences of whole runs; and what their round-off may be."""
    number = found_in(study.scene, key)
    step = share * (abs(number) or 1.0)
    ends = [study.solve({key: number + sign * step}) for sign in (1, -1)]
    values = np.array([[value_of(end, name) for name in of] for end in ends])
    return (values[0] - values[1]) / (2 * step), ROUND_OFF * np.abs(values).max(axis=0) / step


def errors(study, of, by):
    """Of derivatives, over 1e-6 of them, the differences' round-off or their scatter over steps."""
    found = study.derivatives(of, by)
    worst = {}
    for key in by:
        expected, noise = differences(study, of, key)
        off = np.abs(np.array([found[name][key] for name in of]) - expected)
        allowed = np.maximum(1e-6 * np.abs(expected), noise)
        if (off > allowed).any():
            scatter = 3 * np.abs(expected - differences(study, of, key, 1e-4)[0])
            allowed = np.maximum(allowed, scatter)
        worst |= {(name, key): error for name, error in zip(of, off / allowed, strict=True)}
    return worst
