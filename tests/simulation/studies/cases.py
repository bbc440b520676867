"""Small scenes of all laws, drivers and dimensions, each with changes of what is done to it."""

import dataclasses

from fenics_contact import (
    Contact,
    HalfSpace,
    Load,
    Material,
    NormalCompliance,
    Obstacle,
    Path,
    Point,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from tests.preload.joints import joint
from tests.preload.test_joint import scene as bolted
from tests.scenes import PULLED_BLOCK, box_body
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

STEEL = Material(1000, 0.3)
MU = "contact.0.friction_coefficient"
DEPTH = "contact.0.obstacle.indentation"
FORCE = "contact.0.obstacle.force"
LAW = "contact.0.friction_law"
TWO_STEPS = {"steps": Steps(number=2)}

PRESCRIBED = Scene(
    kinematics="plane stress",
    material=STEEL,
    support=(Support("y0", {"y": 0}), Support("x0", {"x": 0})),
    load=(Load("x1", traction=(-30, 0)),),
    contact=(Contact("y1", pressure=30, friction_coefficient=0.3),),
)
ON_A_FLOOR = Scene(
    kinematics="plane strain",
    material=STEEL,
    support=(Support("y1", {"x": 0.001, "y": -0.002}),),
    load=(Load("x1", traction=(1, 0)),),
    contact=(Contact("y0", friction_coefficient=0.3),),
)
BALL = Scene(
    kinematics="axisymmetric",
    material=STEEL,
    symmetry=("x0",),
    half_space=HalfSpace(("x1", "y0")),
    contact=(
        Contact(
            "y1",
            friction_coefficient=0.4,
            obstacle=Obstacle("sphere", radius=4, indentation=0.02, position=(0, 1)),
        ),
    ),
)
PAD = dataclasses.replace(
    PULLED_BLOCK,
    load=(Load("x0", traction=(1, 0.5, 0)),),
    contact=(Contact("z0", friction_coefficient=0.5, obstacle=Obstacle("plane", force=10)),),
)


def of_contact(scene, **changes):
    first, *others = scene.contact
    return dataclasses.replace(scene, contact=(dataclasses.replace(first, **changes), *others))


def square():
    return box_body((6, 4), (1, 1))


# Scene, its body, and changes, one after the other.
CASES = {
    "prescribed": (
        PRESCRIBED,
        square,
        [{MU: 0.5}, {MU: 0}, {"load.0.traction.0": -10, "contact.0.pressure": 40}],
    ),
    "unilateral": (
        ON_A_FLOOR,
        square,
        [
            {MU: 0.35},
            {"support.0.displacement.y": -0.0015, MU: 0},
            {"contact.0.obstacle": {"shape": "cylinder", "radius": 5, "position": (0.3, 0)}},
            {"contact.0.penalty_parameter": 1e-7, "contact.0.regularisation_parameter": 1e-7},
            {"contact.0.law": "incremental", "steps": Steps(number=2)},
        ],
    ),
    "foundation": (
        of_contact(ON_A_FLOOR, foundation_stiffness=5000),
        square,
        [
            {"contact.0.foundation_stiffness": 3000},
            {"contact.0.foundation_stiffness": None},
            {"contact.0.contact": "bonded", "contact.0.foundation_stiffness": None, MU: 0},
        ],
    ),
    "compliance": (
        of_contact(
            ON_A_FLOOR,
            normal_law=NormalCompliance(kind="normal compliance", coefficient=1e6, exponent=2),
        ),
        square,
        [{"contact.0.normal_law.coefficient": 2e6}, {"contact.0.normal_law.exponent": 1.5}],
    ),
    "friction laws": (
        of_contact(
            ON_A_FLOOR,
            law="incremental",
            friction_law={"kind": "nonlocal", "averaging_radius": 0.3},
        ),
        square,
        [
            {MU: 0.35},
            {LAW: {"kind": "micro-slip", "elastic_slip": 1e-3}},
            {LAW: {"kind": "pressure dependent", "pressures": (1, 3), "shares": (1, 0.5)}},
            {LAW: {"kind": "slip dependent", "slips": (0, 1e-3), "shares": (1, 0.5)}, **TWO_STEPS},
            {LAW: {"kind": "formula", "bound": "p / (1 + p / c)", "parameters": {"c": 4}}, MU: 0},
        ],
    ),
    "friction by compliance": (
        of_contact(
            ON_A_FLOOR,
            friction_coefficient=0,
            normal_law=NormalCompliance(kind="normal compliance", coefficient=1e6, exponent=2),
            friction_law={"kind": "compliance", "coefficient": 2e5, "exponent": 2},
        ),
        square,
        [{f"{LAW}.exponent": 1.8}, {"contact.0.normal_law.coefficient": 2e6}],
    ),
    "orthotropic": (
        of_contact(
            PAD,
            friction_coefficient=0,
            friction_law={
                "kind": "orthotropic",
                "along": 0.4,
                "across": 0.6,
                "direction": (1, 1, 0),
            },
        ),
        lambda: box_body((3, 3, 2)),
        [{f"{LAW}.across": 0.5, FORCE: 11}, {f"{LAW}.direction": (1, 0, 0)}],
    ),
    "wear": (
        of_contact(dragged(Steps(number=3)), wear={"coefficient": 1e-3}),
        block,
        [{"contact.0.wear.coefficient": 2e-3}, {MU: 0.2}],
    ),
    "incremental": (
        dragged(Steps(number=2)),
        block,
        [
            {MU: 0.2},
            {"contact.0.obstacle.displacement.0": 0.001, DEPTH: 0.015},
            {"contact.0.law": "static", "steps.number": 3},
            {DEPTH: None, FORCE: 6.0},
        ],
    ),
    "half-space": (
        BALL,
        lambda: box_body((6, 6), (1, 1)),
        [{DEPTH: 0.021}, {"contact.0.obstacle.radius": 5}, {DEPTH: None, FORCE: 8}, {MU: 0}],
    ),
    "in space": (
        PAD,
        lambda: box_body((3, 3, 2)),
        [
            {FORCE: 11},
            {"load.0.traction": (0, 1, 0), "contact.0.law": "incremental", "steps.number": 2},
            {"contact.0.obstacle.shape": "sphere", "contact.0.obstacle.radius": 4},
        ],
    ),
    "two bodies": (
        shoved(Steps(times=(0.5, 0.7))),
        two_blocks,
        [
            {MU: 0.1, "contact.0.interference": 1e-3},
            {"steps.times": (0.5, 0.6)},
            {"support.1.displacement.y": -0.008, MU: 0},
        ],
    ),
    "bolt": (
        bolted(pulled=1.0),
        joint,
        [
            {"preload.0.force": 12},
            {"contact.1.friction_coefficient": 0.4, "preload.0.locked_from": None},
            {"contact.0.obstacle.force": 3},
        ],
    ),
    "nearly incompressible": (
        dataclasses.replace(ON_A_FLOOR, material=Material(1000, 0.499)),
        square,
        [{MU: 0.4}, {"load.0.traction.0": 2}],
    ),
    "corners": (  # supports meet, some at the contact; points
        Scene(
            kinematics="plane strain",
            material=STEEL,
            support=(
                Support("y1", {"x": 0, "y": -0.003}, name="lid"),
                Support("x0", {"x": 0}),
                Support("x1", {"y": -0.003}),
            ),
            load=(Load("x1", traction=(3, 0)), Load("body", body_force=(0, -2))),
            contact=(Contact("y0", obstacle=Obstacle("plane"), friction_coefficient=0.2),),
            point=(Point("middle", (0.3, 0.4)), Point("corner", (1, 1))),
        ),
        square,
        [
            {"support.0.displacement.y": -0.002, "support.2.displacement.y": -0.002, MU: 0.25},
            {"load.0.traction": (2, 1), "point.0.at": (0.5, 0.5)},
        ],
    ),
    "stabilised": (
        dataclasses.replace(
            PAD,
            kinematics="plane strain",
            support=(),
            load=(Load("y1", pressure=1),),
            contact=(Contact("y0", obstacle=Obstacle("plane"), friction_coefficient=0),),
            solver=SolverSettings(stabilisation=True),
        ),
        square,
        [{"load.0.pressure": 2, "load.0.path": Path((0, 1), (0, 1))}],
    ),
}
