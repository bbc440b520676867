"""Small scenes of all laws, drivers and dimensions: their quantities, and keys to derive by."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

from dolfinx.mesh import CellType

from fenics_contact import (
    Body,
    ComplianceFriction,
    Contact,
    FormulaFriction,
    Load,
    Material,
    MicroSlipFriction,
    NonlocalFriction,
    Obstacle,
    Path,
    Point,
    PressureDependentFriction,
    PressureFormula,
    Profile,
    Scene,
    SlipDependentFriction,
    Steps,
)
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.scenes import box_body
from tests.simulation.studies.cases import (
    BALL,
    CASES,
    DEPTH,
    FORCE,
    MU,
    ON_A_FLOOR,
    PAD,
    PRESCRIBED,
    of_contact,
    square,
)
from tests.solve.load_steps.histories import DRAGGED, PRESSED, block, dragged, shoved, two_blocks

AT_ONCE = Path((0, 1), (0, 1))
OBSTACLE, LAW = "contact.0.obstacle", "contact.0.friction_law"
E, NU = "material.0.youngs_modulus", "material.0.poissons_ratio"
RADIUS, MOVED = f"{OBSTACLE}.radius", f"{OBSTACLE}.displacement.0"
DOWN, ASIDE, PULL = "support.0.displacement.y", "support.0.displacement.x", "load.0.traction.0"


@dataclasses.dataclass(frozen=True)
class Derived:
    """A scene of the table.

    Attributes:
        scene: With automatic parameters, as its answers choose them.
        make: Its body.
        of: Quantities.
        by: Keys.
    """

    scene: Scene
    make: Callable[[], Body]
    of: list[str]
    by: list[str]


def derived(scene: Scene, make: Callable[[], Body], of: str, *by: str) -> Derived:
    """Quantities in one text, and keys."""
    return Derived(scene, make, of.split(), list(by))


def case(name: str, changes: Mapping[str, Any], of: str, *by: str) -> Derived:
    """A case of the studies with changes, which make it one load step under several things."""
    scene, make, _ = CASES[name]
    return derived(with_changes(scene, changes), make, of, *by)


def law(scene: Scene, table: Any, **more: Any) -> Scene:
    """With another friction law."""
    return of_contact(scene, friction_law=table, **more)


def of_law(*names: str) -> list[str]:
    """Keys of the friction law."""
    return [f"{LAW}.{name}" for name in names]


def ring() -> Body:
    """Cells of a ball's half-space."""
    return box_body((6, 6), (1, 1))


BY_DEPTH = ComplianceFriction(kind="compliance", coefficient=3e5, exponent=2.2)
BY_PRESSURE = PressureDependentFriction(
    kind="pressure dependent", pressures=(0, 1, 3, 100), shares=(1, 0.9, 0.8, 0.3)
)
BY_SLIP = SlipDependentFriction(kind="slip dependent", slips=(0, 0.003, 0.02), shares=(1, 0.8, 0.5))
MICRO = MicroSlipFriction(kind="micro-slip", elastic_slip=1e-3)
NONLOCAL = NonlocalFriction(kind="nonlocal", averaging_radius=0.3)
SATURATED = FormulaFriction(kind="formula", bound="mu * p / (1 + p / p0)", parameters={"p0": 4.0})
ON_ASPERITIES = PressureFormula(
    kind="formula", pressure="p0 * (exp(d / h) - 1)", parameters={"p0": 2.0, "h": 1e-3}
)
SPHERE = {
    f"{OBSTACLE}.shape": "sphere",
    RADIUS: 4.0,
    f"{OBSTACLE}.position": (0.4, 0.45, 0),
}
TWO = {
    "steps": Steps(),
    "contact.0.law": "static",
    "contact.0.interference": 1e-3,
    "support.1.path": AT_ONCE,
    "support.2.path": AT_ONCE,
    "support.2.displacement.x": 2e-4,
}
BOLT = {"steps": Steps(), "preload.0.locked_from": None, f"{OBSTACLE}.path": AT_ONCE}
THREE = Steps(times=(0.5, 0.75, 1.0))
ROLLED = dataclasses.replace(
    PRESCRIBED,
    load=(Load("x1", traction=(-30, 0), path=DRAGGED),),
    contact=(
        Contact(
            "y1",
            pressure=Profile("x", (0, 1), (30, 20)),
            pressure_path=PRESSED,
            friction_coefficient=0.3,
            law="incremental",
        ),
    ),
    steps=Steps(number=4),
)
HARD_ON_SOFT = dataclasses.replace(
    with_changes(CASES["two bodies"][0], TWO),
    material=(Material(1000, 0.3, on="lower"), Material(3000, 0.2, on="upper")),
)
SWEPT = dataclasses.replace(
    PAD,
    load=(Load("x0", traction=(1, 0.5, 0), path=DRAGGED),),
    contact=(
        dataclasses.replace(
            PAD.contact[0], law="incremental", obstacle=Obstacle("plane", force=10, path=PRESSED)
        ),
    ),
    steps=Steps(number=4),
)
GRADED = of_contact(
    ON_A_FLOOR,
    friction_coefficient=Profile("x", (0, 0.5, 1), (0.2, 0.3, 0.4)),
    obstacle=Obstacle(gap=Profile("x", (0, 1), (0, 5e-4))),
)
GLUED = of_contact(ON_A_FLOOR, contact="bonded", friction_coefficient=0.0)
POINTED = dataclasses.replace(ON_A_FLOOR, point=(Point("middle", (0.3, 0.4)),))

TURNED = {f"{OBSTACLE}.normal": (0.1, -1.0), f"{OBSTACLE}.direction": (0.05, -2.0)}
LINES = {
    f"{OBSTACLE}.shape": "parabola",
    RADIUS: 4.0,
    f"{OBSTACLE}.position": (0.4, 0.45, 0),
    f"{OBSTACLE}.along": (1.0, 0.2, 0.0),
    f"{OBSTACLE}.normal": (0.0, 0.0, 2.0),
}

TABLE = {
    "prescribed": case(
        "prescribed",
        {},
        "friction_force_x external_work max_slip reaction_y x0.reaction_x",
        *(MU, "contact.0.pressure", PULL, "load.0.traction.1", NU),
    ),
    "unilateral": case(
        "unilateral",
        {},
        "normal_force friction_force_x reaction_x pressure_integral max_contact_pressure "
        "strain_energy external_work friction_work max_slip penalty_energy",
        *(MU, PULL, DOWN, E, NU, "contact.0.penalty_parameter"),
    ),
    "foundation": case(
        "foundation",
        {},
        "normal_force strain_energy reaction_y",
        *("contact.0.foundation_stiffness", MU, E),
    ),
    "compliance": case(
        "compliance",
        {},
        "normal_force friction_force_x external_work",
        *("contact.0.normal_law.coefficient", "contact.0.normal_law.exponent", MU),
    ),
    "incremental": case(
        "incremental",
        {"steps": THREE},
        "normal_force friction_force_x strain_energy max_slip reaction_x",
        *(MU, DEPTH, MOVED, RADIUS, f"{OBSTACLE}.position.0", E),
    ),
    "half-space": case(
        "half-space",
        {},
        "normal_force strain_energy external_work max_contact_pressure reaction_y",
        *(MU, DEPTH, RADIUS, f"{OBSTACLE}.position.1", E, NU),
    ),
    "in space": case(
        "in space",
        SPHERE,
        "friction_force_x contact_force_x strain_energy indentation max_contact_pressure",
        *(MU, FORCE, PULL, RADIUS, f"{OBSTACLE}.position.0", E),
    ),
    "tetrahedra": derived(
        with_changes(PAD, SPHERE),
        lambda: box_body((3, 3, 2), cell=CellType.tetrahedron),
        "normal_force friction_force_x strain_energy reaction_x max_contact_pressure",
        *(MU, PULL, RADIUS),
    ),
    "two bodies": case(
        "two bodies",
        TWO,
        "normal_force friction_force_x strain_energy external_work max_contact_pressure",
        *(MU, "support.1.displacement.y", "support.2.displacement.x", "contact.0.interference", NU),
    ),
    "bolt": case(
        "bolt",
        BOLT,
        "seat.normal_force bolt.elongation strain_energy external_work bottom.reaction_y",
        *("preload.0.force", FORCE),
    ),
    "a plate with a bolt": derived(
        dataclasses.replace(
            with_changes(CASES["bolt"][0], BOLT), kinematics="plane stress", thickness=0.4
        ),
        CASES["bolt"][1],
        "seat.normal_force bolt.elongation strain_energy external_work bottom.reaction_y "
        "max_contact_pressure penalty_energy",
        *("thickness", "preload.0.force", FORCE),
    ),
    "a plate, in load steps": derived(
        dataclasses.replace(
            dragged(THREE, driven={"force": 2.0}), kinematics="plane stress", thickness=0.4
        ),
        block,
        "friction_force_x indentation max_contact_pressure strain_energy normal_force max_slip",
        *("thickness", FORCE, MU, MOVED),
    ),
    "nearly incompressible": case(
        "nearly incompressible",
        {},
        "normal_force strain_energy friction_force_x",
        *(MU, DOWN, E, NU),
    ),
    "friction by depth": derived(
        law(CASES["compliance"][0], BY_DEPTH, friction_coefficient=0.0),
        square,
        "friction_force_x normal_force strain_energy max_slip",
        *of_law("coefficient", "exponent"),
        *("contact.0.normal_law.coefficient", "contact.0.normal_law.exponent"),
    ),
    "friction by depth of springs": derived(
        law(
            CASES["foundation"][0],
            dataclasses.replace(BY_DEPTH, coefficient=3e3, exponent=1.5),
            friction_coefficient=0.0,
        ),
        square,
        "friction_force_x friction_work",
        *of_law("coefficient", "exponent"),
        "contact.0.foundation_stiffness",
    ),
    "friction by pressure": derived(
        law(ON_A_FLOOR, BY_PRESSURE),
        square,
        "friction_force_x strain_energy friction_work",
        *of_law("shares.1", "shares.2", "pressures.2", "pressures.3"),
        MU,
    ),
    "friction by slip": derived(
        law(dragged(Steps(number=4)), BY_SLIP),
        block,
        "friction_force_x normal_force max_slip strain_energy",
        *of_law("shares.0", "shares.1", "slips.1"),
        *(MU, DEPTH, MOVED),
    ),
    "friction around points": derived(
        law(ON_A_FLOOR, NONLOCAL),
        square,
        "friction_force_x strain_energy max_slip",
        *of_law("averaging_radius"),
        MU,
    ),
    "friction around points of rings": derived(
        law(BALL, NONLOCAL),
        ring,
        "normal_force strain_energy max_contact_pressure",
        *of_law("averaging_radius"),
        *(MU, DEPTH),
    ),
    "friction by a formula": derived(
        law(ON_A_FLOOR, SATURATED),
        square,
        "friction_force_x strain_energy friction_work",
        *of_law("parameters.p0"),
        MU,
    ),
    "friction by a formula, in load steps": derived(
        law(dragged(THREE), dataclasses.replace(SATURATED, parameters={"p0": 50.0})),
        block,
        "friction_force_x normal_force strain_energy",
        *of_law("parameters.p0"),
        *(MU, MOVED, NU),
    ),
    "friction around points, in space": derived(
        law(with_changes(PAD, SPHERE), dataclasses.replace(NONLOCAL, averaging_radius=0.6)),
        CASES["in space"][1],
        "friction_force_x strain_energy max_slip",
        *of_law("averaging_radius"),
        *(MU, FORCE, PULL),
    ),
    "micro-slip": derived(
        law(ON_A_FLOOR, MICRO),
        square,
        "friction_force_x normal_force strain_energy external_work max_slip",
        *of_law("elastic_slip"),
        *(MU, DOWN, PULL),
    ),
    "micro-slip, in load steps": derived(
        law(dragged(Steps(number=4)), dataclasses.replace(MICRO, elastic_slip=3e-4)),
        block,
        "friction_force_x normal_force strain_energy max_slip",
        *of_law("elastic_slip"),
        *(MU, DEPTH, MOVED, E),
    ),
    "pressure by a formula": derived(
        of_contact(ON_A_FLOOR, normal_law=ON_ASPERITIES),
        square,
        "normal_force friction_force_x strain_energy penalty_energy",
        *("contact.0.normal_law.parameters.p0", "contact.0.normal_law.parameters.h", MU, DOWN),
    ),
    "glued": derived(
        GLUED,
        square,
        "normal_force reaction_x strain_energy external_work",
        *("contact.0.penalty_parameter", PULL, DOWN, ASIDE, E, NU),
    ),
    "points of supports that meet": case(
        "corners",
        {},
        "displacement_middle_x displacement_middle_y reaction_x normal_force",
        *(MU, "load.0.traction.0", "load.1.body_force.1", E, NU),
    ),
    "a point inside": derived(
        POINTED,
        square,
        "displacement_middle_x displacement_middle_y strain_energy",
        *(MU, PULL, DOWN, ASIDE, E, NU),
    ),
    "two materials": derived(
        HARD_ON_SOFT,
        two_blocks,
        "normal_force friction_force_x strain_energy",
        *(E, NU, "material.1.youngs_modulus", "material.1.poissons_ratio", MU),
    ),
    "a coefficient and a gap that vary": derived(
        GRADED,
        square,
        "normal_force friction_force_x strain_energy",
        *(f"{MU}.values.{number}" for number in range(3)),
        *(f"{OBSTACLE}.gap.values.1", DOWN),
    ),
    "a pressure that comes and goes": derived(
        ROLLED,
        square,
        "friction_force_x max_slip reaction_x strain_energy",
        *(MU, "contact.0.pressure.values.0", PULL, E, NU),
    ),
    "pressed by a force, in load steps": derived(
        dragged(THREE, driven={"force": 6.0}),
        block,
        "friction_force_x indentation max_contact_pressure strain_energy",
        *(FORCE, MU, MOVED, RADIUS, NU),
    ),
    "half-space under a force": case(
        "half-space",
        {DEPTH: None, FORCE: 8.0, "contact.0.law": "incremental", "steps": Steps(number=3)},
        "indentation strain_energy max_contact_pressure reaction_y",
        *(FORCE, MU, RADIUS, E, NU),
    ),
    "two bodies, in load steps": derived(
        with_changes(shoved(THREE), {"support.2.displacement.x": 2e-4}),
        two_blocks,
        "normal_force friction_force_x strain_energy max_contact_pressure",
        *(MU, "support.1.displacement.y", "support.2.displacement.x", E, NU),
    ),
    "in space, in load steps": derived(
        SWEPT,
        CASES["in space"][1],
        "friction_force_x indentation strain_energy max_slip",
        *(MU, FORCE, PULL, "load.0.traction.1", E),
    ),
    "an obstacle that turns, in load steps": derived(
        with_changes(dragged(THREE), TURNED),
        block,
        "normal_force friction_force_x reaction_x strain_energy max_slip",
        *(f"{OBSTACLE}.normal.0", f"{OBSTACLE}.normal.1"),
        *(f"{OBSTACLE}.direction.0", f"{OBSTACLE}.direction.1", DEPTH),
    ),
    "a force that turns with its obstacle": derived(
        with_changes(
            dragged(Steps(), law="static", driven={"force": 4.0}, path=AT_ONCE),
            {f"{OBSTACLE}.normal": (0.05, -1.0), f"{OBSTACLE}.displacement_path": AT_ONCE},
        ),
        block,
        "normal_force friction_force_x indentation external_work strain_energy",
        *(f"{OBSTACLE}.normal.0", f"{OBSTACLE}.normal.1", FORCE, RADIUS),
    ),
    "lines that turn, in space": derived(
        with_changes(PAD, LINES),
        CASES["in space"][1],
        "normal_force friction_force_x friction_force_y indentation strain_energy",
        *(f"{OBSTACLE}.along.0", f"{OBSTACLE}.along.1", f"{OBSTACLE}.normal.2", MU),
    ),
    "friction along axes": case(
        "orthotropic",
        {},
        "friction_force_x friction_force_y indentation strain_energy",
        *of_law("along", "across", "direction.0", "direction.1"),
    ),
    "a bolt that is locked": case(
        "bolt",
        {},
        "seat.normal_force bolt.elongation strain_energy bottom.reaction_y max_contact_pressure",
        *("preload.0.force", FORCE, "contact.1.penalty_parameter"),
    ),
    "triangles, of degree 1": derived(
        dragged(THREE, degree=1),
        lambda: box_body((8, 6), (1, 1), cell=CellType.triangle),
        "normal_force friction_force_x strain_energy",
        *(MU, DEPTH, MOVED, RADIUS, E),
    ),
}
# Those that every run of the tests has; ``benchmarks/derivative_table.py`` has all.
SAMPLE = [
    *("unilateral", "incremental", "half-space", "in space", "two bodies", "bolt"),
    *(
        "friction by depth",
        "friction by slip",
        "micro-slip, in load steps",
        "friction around points of rings",
    ),
    *("pressure by a formula", "glued", "a pressure that comes and goes", "a plate, in load steps"),
    *("pressed by a force, in load steps", "two materials", "friction along axes"),
    *("an obstacle that turns, in load steps", "a force that turns with its obstacle"),
    "a bolt that is locked",
]
