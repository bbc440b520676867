"""Normal compliance p = c d^m against its formula, with friction, restarted, and on two ranks."""

import dataclasses

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Steps, Support, run
from fenics_contact.problem.problem import Problem
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.solve.matrices import product

COMM = MPI.COMM_WORLD
COEFFICIENT = 4e3
BALL = Obstacle("parabola", radius=0.5, force=3, position=(0.5, 1))


def law(exponent, coefficient=COEFFICIENT):
    return {"kind": "normal compliance", "coefficient": coefficient, "exponent": exponent}


def block(load=(0, -10), kinematics="plane strain", **keys):
    """Pressed onto a rough plane by a uniform pressure, with no support across it."""
    dimension = len(load)
    axes = "xyz"[: dimension - 1]
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=tuple(Support(f"{axis}0", {axis: 0}) for axis in axes),
        load=(Load(f"{'xyz'[dimension - 1]}1", traction=load),),
        contact=(Contact(f"{'xyz'[dimension - 1]}0", **keys),),
    )


@pytest.mark.parametrize("exponent", [1, 1.5, 2, 3])
def test_a_uniform_pressure_sinks_in_by_its_root(exponent):
    """d = (p/c)^(1/m), and c d^(m + 1)/(m + 1) is stored; all checks pass."""
    result = run(block(normal_law=law(exponent)), COMM, box_body((4, 4)))
    depth = (10 / COEFFICIENT) ** (1 / exponent)
    assert result.passed, result.verdict
    assert result.points.contact_pressure == pytest.approx(10, rel=1e-8)
    assert -result.points.gap == pytest.approx(depth, rel=1e-8)
    assert result.quantities["max_penetration"] == pytest.approx(depth, rel=1e-8)
    stored = COEFFICIENT * depth ** (exponent + 1) / (exponent + 1)
    assert result.quantities["penalty_energy"] == pytest.approx(stored, rel=1e-8)
    assert result.contacts[0]["contact"] == "normal compliance"
    assert result.contacts[0]["parameters"]["exponent"] == exponent
    assert {"contact_law", "complementarity", "tension"} <= set(result.checks)
    assert not {"penetration", "penetration_depth"} & set(result.checks)  # the depth is meant


@pytest.mark.errors
def test_error_bars_cover_what_a_finer_mesh_finds():
    """There is no penalty to be wrong by: the compliance is asked for, and is not made stiffer."""
    coarse, fine = (
        run(pressed(BALL, {"normal_law": law(2)}), COMM, box_body(cells))
        for cells in ((12, 6), (48, 24))
    )
    assert coarse.passed, coarse.verdict
    assert 0.3 < coarse.quantities["contact_area"] < 0.7
    assert coarse.errors["normal_force"]["penalty"] == 0
    for name in ("max_contact_pressure", "contact_area", "indentation", "strain_energy"):
        error = abs(coarse.quantities[name] - fine.quantities[name])
        assert error < 1.5 * coarse.errors[name]["total"], name


def test_the_exponent_1_is_a_foundation():
    springs = {"foundation_stiffness": COEFFICIENT}, {"normal_law": law(1)}
    answers = [run(pressed(BALL, keys), COMM, box_body((16, 8))) for keys in springs]
    for name in ("normal_force", "contact_area", "max_contact_pressure", "strain_energy"):
        one, other = (answer.quantities[name] for answer in answers)
        assert other == pytest.approx(one, rel=1e-9), name


def pressed(obstacle, keys, **more):
    """A parabola pressed onto the middle of a block that stands on the ground."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, **keys),),
        **more,
    )


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("exponent", [1.5, 2])
def test_residual_and_tangent_are_derivatives_of_the_energy(dimension, exponent):
    scene = block(
        load=(0,) * (dimension - 1) + (-1,),
        kinematics="3D" if dimension == 3 else "plane strain",
        obstacle=Obstacle(gap=lambda x: 0.1 * x[0]),
        normal_law=law(exponent, lambda x: 3 + x[0]),
    )
    contact = Problem.on_mesh(scene, box_body((3, 2, 2)[:dimension])).contacts[0]
    surface, energy = contact.trace.surface, fem.form(contact.normal.energy)
    points = surface.coordinates
    shift = np.stack([np.sin(3 * points[:, 0] + i) for i in range(dimension)], axis=1)
    state = np.zeros_like(shift)
    state[:, -1] = np.where(points[:, 0] < 0.4, -0.3, 0.2)
    owned = slice(0, surface.owned_nodes)

    def at(step):
        contact.kinematics.move(state + step * shift)
        value = COMM.allreduce(fem.assemble_scalar(energy))
        stored = contact.trace.integral(contact.state().penalty_energy)
        assert value == pytest.approx(stored, rel=1e-12)  # results use the same UFL
        return value, surface.assemble(contact.normal.residual)

    value, slope = at(0.0)
    matrix = fem.assemble_matrix(contact.normal.tangent)
    matrix.scatter_reverse()
    change = product(matrix, shift.ravel()).reshape(-1, dimension)[owned]
    work = COMM.allreduce(np.sum(slope[owned] * shift[owned]))
    curvature = COMM.allreduce(np.sum(change * shift[owned]))
    left = []
    for step in (1e-2, 5e-3):
        moved, force = at(step)
        rest = moved - value - step * work - 0.5 * step**2 * curvature
        off = COMM.allreduce(np.abs((force - slope)[owned] - step * change).sum())
        left.append((abs(rest), off))
    orders = np.log2(np.divide(left[0], left[1]))
    assert orders == pytest.approx([3, 2], abs=0.1)  # what Taylor's series leaves


@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
@pytest.mark.parametrize("friction", ["static", "incremental"])
def test_coulombs_friction_is_bounded_by_its_pressure(strategy, friction):
    """A block held on its left is sheared: where it slips, |σ_T| = μ p of the power law."""
    keys = {"normal_law": law(2), "friction_coefficient": 0.3, "law": friction}
    scene = dataclasses.replace(
        block(load=(3, -10), **keys),
        support=(Support("x0", {"x": 0, "y": 0}),),
        solver={"strategy": strategy},
    )
    result = run(scene, COMM, box_body((6, 3)))
    assert result.passed, result.verdict
    bound = 0.3 * result.quantities["pressure_integral"]
    shear = abs(result.quantities["friction_force"][0])
    assert 0 < shear <= bound * (1 + 1e-9)
    slips = result.points.status == "SLIP"
    traction = np.linalg.norm(result.points.friction_traction, axis=1)
    assert traction[slips] == pytest.approx(0.3 * result.points.contact_pressure[slips], rel=1e-6)


def test_a_block_that_only_friction_holds():
    """Sheared by less than μ p everywhere: it sticks, and friction carries all."""
    scene = dataclasses.replace(
        block(load=(2, -10), normal_law=law(1.5), friction_coefficient=0.5), support=()
    )
    result = run(scene, COMM, box_body((4, 1), (4, 0.5)))
    assert result.passed, result.verdict
    assert result.quantities["friction_force"][0] == pytest.approx(-8, rel=1e-6)


def test_a_run_is_restarted_on_other_ranks(folder):
    """From one rank to all: as a whole run on all."""
    obstacle = dataclasses.replace(BALL, displacement=(0.004, 0))
    keys = {"normal_law": law(2), "friction_coefficient": 0.3, "law": "incremental"}
    scene = pressed(obstacle, keys, steps=Steps(number=4))
    whole = run(scene, COMM, box_body((12, 6)))
    assert whole.passed, whole.verdict
    if COMM.rank == 0:
        stopped_after(scene, box_body((12, 6), comm=MPI.COMM_SELF), folder, 2)
    COMM.barrier()
    found = resumed(scene, box_body((12, 6)), folder)
    for name in ("normal_force", "contact_area", "friction_work", "strain_energy"):
        assert found.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-7), name


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"normal_law": law(0.5)}, "exponent_below_1"),
        ({"normal_law": law(2, -1)}, "compliance_coefficient_is_negative"),
        ({"normal_law": law(2), "contact": "bonded"}, "normal_law_beside_contact_kind"),
        ({"normal_law": law(2), "pressure": 1}, "compliance_with_pressure"),
        ({"normal_law": law(2), "penalty_parameter": 1.0}, "compliance_with_penalty"),
        ({"normal_law": law(2) | {"power": 2}}, "unknown_key_power"),
    ],
)
def test_contradictions_are_refused(keys, message):
    with refused(message, ValueError):
        Contact("top", **keys)


def test_between_two_bodies_both_give_way():
    """Blocks pressed together by a uniform pressure are d = (p/c)^(1/m) deep in each other."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=(Support("lower.y0", {"y": 0}), Support("lower.x0", {"x": 0})),
        load=(Load("upper.y1", traction=(0, -10)),),
        contact=(
            Contact("upper.y0", against="lower.y1", normal_law=law(2), friction_coefficient=0.2),
        ),
    )
    lower, upper = Box("lower", (0, -1), (1, 0), (5, 4)), Box("upper", (0, 0), (1, 1), (3, 3))
    result = run(scene, COMM, boxes((lower, upper)))
    assert result.passed, result.verdict
    assert result.points.contact_pressure == pytest.approx(10, rel=1e-7)
    assert -result.points.gap == pytest.approx((10 / COEFFICIENT) ** 0.5, rel=1e-7)
