"""Scenes solved without penalty and smoothing, against statics, formulas and the limit of both."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType

from fenics_contact import (
    Contact,
    Coupling,
    Discretisation,
    Load,
    Material,
    Modes,
    Obstacle,
    Path,
    Scene,
    Steps,
    Support,
    run,
)
from fenics_contact.solve.at_points import exact_step
from fenics_contact.solve.exact import several
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body, with_solver

MODULUS, LENGTH, DEPTH = 1000.0, 0.5, 0.01


def bar(degree: int = 2, **contact: object) -> Scene:
    """A bar of height .5 and width 1, ν = 0, held at its top, on an obstacle that comes in."""
    given = {"penalty_parameter": 0, "obstacle": Obstacle(indentation=DEPTH)} | contact
    return Scene(
        kinematics="plane strain",
        material=Material(MODULUS, 0.0),
        discretisation=Discretisation(degree),
        support=(Support("y1", {"x": 0, "y": 0}),),
        contact=(Contact("y0", **given),),
    )


def block(coefficient: float = 0.5, **contact: object) -> Scene:
    """A block of side 1 pressed onto a rough floor, and pulled along it, by forces alone."""
    return Scene(
        kinematics="plane strain",
        material=Material(MODULUS, 0.3),
        load=(Load("y1", pressure=10), Load("y1", traction=(3, 0))),
        support=(),
        contact=(Contact("y0", friction_coefficient=coefficient, **contact),),
    )


def errors_off(scene: Scene, **settings: object) -> Scene:
    return with_solver(scene, errors="none", **settings)


@pytest.mark.parametrize("degree", [1, 2])
def test_a_bar_has_the_pressure_of_its_shortening_to_round_off(degree: int) -> None:
    """p = E d/L; an automatic penalty makes it 3e-4 h/L less."""
    found = run(errors_off(bar(degree)), body=box_body((2, 2), (1, LENGTH)))
    assert found.passed
    pressure = MODULUS * DEPTH / LENGTH
    assert found.quantities["max_contact_pressure"] == pytest.approx(pressure, rel=1e-12)
    assert found.quantities["penalty_energy"] == 0
    assert abs(found.quantities["max_penetration"]) <= 1e-15


def test_facets_with_points_between_their_nodes() -> None:
    """On tetrahedra of degree 2 there are more points than dofs; a uniform pressure is exact."""
    scene = dataclasses.replace(
        bar(), kinematics="3D", support=(Support("z1", {"x": 0, "y": 0, "z": 0}),)
    )
    contact = dataclasses.replace(scene.contact[0], on="z0")
    body = box_body((1, 1, 1), (1, 1, LENGTH), cell=CellType.tetrahedron)
    found = run(errors_off(dataclasses.replace(scene, contact=(contact,))), body=body)
    pressure = MODULUS * DEPTH / LENGTH
    assert found.passed
    assert found.quantities["max_contact_pressure"] == pytest.approx(pressure, rel=1e-9)
    assert found.quantities["normal_force"] == pytest.approx(pressure, rel=1e-10)


def test_friction_alone_holds_a_block_that_nothing_supports() -> None:
    """Forces by statics; where |t| < μ p nothing slips at all."""
    scene = errors_off(block(), strategy="exact")
    found = run(scene, body=box_body((4, 4), (1, 1)))
    assert found.passed
    assert found.quantities["normal_force"] == pytest.approx(10, rel=1e-12)
    assert found.quantities["friction_force"] == pytest.approx([-3, 0], abs=1e-11)
    points = found.points
    sticks = np.array(points.status) == "STICK"
    assert sticks.any()
    assert np.abs(points.slip[sticks]).max() <= 1e-14
    slips = np.array(points.status) == "SLIP"
    size = np.linalg.norm(points.friction_traction[slips], axis=1)
    assert size == pytest.approx(0.5 * points.contact_pressure[slips], rel=1e-10)


@pytest.mark.parametrize("parameter", ["penalty_parameter", "regularisation_parameter"])
def test_the_exact_answer_is_the_limit_at_order_one(parameter: str) -> None:
    """A tenth of the parameter alone leaves a tenth of the difference."""
    body = box_body((4, 4), (1, 1))

    def force(value: float) -> float:
        scene = dataclasses.replace(
            block(coefficient=0.35), support=(Support("y1", {"x": 0.004, "y": -0.004}),), load=()
        )
        others = dict.fromkeys(("penalty_parameter", "regularisation_parameter"), 0)
        contact = dataclasses.replace(scene.contact[0], **(others | {parameter: value}))
        found = run(errors_off(dataclasses.replace(scene, contact=(contact,))), body=body)
        return float(found.quantities["contact_force"][0])

    exact = force(0)
    first, second = (force(value) - exact for value in (1e-6, 1e-7))
    assert abs(first) > 1e-8 * abs(exact)
    assert first / second == pytest.approx(10, rel=0.02)


def test_glued_bars_are_one() -> None:
    """Bonded without a penalty: the force of a bar as long as both, E d/(2 L)."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(MODULUS, 0.0),
        support=(Support("lower.y0", {"x": 0, "y": 0}), Support("upper.y1", {"y": DEPTH})),
        contact=(Contact("upper.y0", against="lower.y1", contact="bonded", penalty_parameter=0),),
    )
    lower, upper = Box("lower", (0, -1), (1, 0), (3, 2)), Box("upper", (0, 0), (1, 1), (4, 2))
    found = run(errors_off(scene), body=boxes((lower, upper)))
    assert found.passed
    assert "bonded contact on upper.y0" in found.model.terms
    force = found.reactions["upper.y1"].reaction[1]
    assert force == pytest.approx(MODULUS * DEPTH / 2, rel=1e-10)


def test_load_steps_of_the_incremental_law() -> None:
    """Pulled and let go: what has slipped stays, as the regularised answer has it but for ε."""
    scene = dataclasses.replace(
        block(coefficient=0.35),
        support=(Support("y1", {"x": 0.004, "y": -0.004}),),
        load=(),
        steps=Steps(number=3),
    )
    contact = dataclasses.replace(scene.contact[0], law="incremental")
    scene = dataclasses.replace(scene, contact=(contact,))
    body = box_body((4, 4), (1, 1))
    smooth, exact = (run(errors_off(scene, strategy=s), body=body) for s in ("auto", "exact"))
    assert smooth.passed
    assert exact.passed
    assert smooth.model.terms[-2:] == [
        "unilateral contact (penalty) on y0",
        "regularised friction on y0",
    ]
    assert exact.model.terms[-2:] == ["unilateral contact on y0", "friction on y0"]
    for one, other in zip(smooth.steps, exact.steps, strict=True):
        for name in ("normal_force", "friction_work", "stick_area"):
            value = one.quantities[name]
            assert other.quantities[name] == pytest.approx(value, rel=2e-3)
    assert sum(s.newton_iterations for s in exact.steps) < sum(
        s.newton_iterations for s in smooth.steps
    )


def test_what_does_not_go_together_is_refused() -> None:
    with refused("exact_contact_with_another_solver", ValueError):
        errors_off(bar(), solver="full")
    with refused("a_penalty_beside_the_exact_strategy", ValueError):
        errors_off(bar(penalty_parameter=1e-6), strategy="exact")
    with refused("no_penalty_beside_another_strategy", ValueError):
        errors_off(bar(), strategy="campos")
    with refused("modes_of_exact_contact", ValueError):
        dataclasses.replace(bar(), modes=Modes(number=2))


def test_laws_that_it_does_not_cover_are_refused() -> None:
    contact = {"penalty_parameter": "auto", "foundation_stiffness": 5.0}
    scene = errors_off(bar(**contact), strategy="exact")
    with refused("a_law_that_is_not_solved_exactly"):
        run(scene, body=box_body((2, 2), (1, LENGTH)))


def test_given_motions_of_a_coupling_hold() -> None:
    """A bar whose end is moved by a rigid coupling onto an obstacle: p = E (d − gap)/L."""
    moved = Coupling("y1", displacement={"x": 0, "y": -DEPTH}, rotation={"z": 0}, name="head")
    scene = dataclasses.replace(
        bar(obstacle=Obstacle(gap=lambda x: 0.002 + 0 * x[0])), support=(), coupling=(moved,)
    )
    found = run(errors_off(scene), body=box_body((2, 2), (1, LENGTH)))
    assert found.passed
    assert found.couplings[0].displacement == [0, -DEPTH]
    pressure = MODULUS * (DEPTH - 0.002) / LENGTH
    assert found.quantities["max_contact_pressure"] == pytest.approx(pressure, rel=1e-11)
    assert found.couplings[0].force[1] == pytest.approx(-pressure, rel=1e-11)


def test_where_everything_sticks_no_work_is_done() -> None:
    """Slips are round-off there, and their direction says nothing."""
    scene = block(coefficient=2.0)
    found = run(errors_off(scene, strategy="exact"), body=box_body((4, 4), (1, 1)))
    assert found.passed
    assert found.checks["dissipation"].value <= found.checks["dissipation"].limit
    assert found.quantities["friction_work"] == pytest.approx(0, abs=1e-12)


def test_a_solver_that_breaks_down_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rank 0 solves alone: what it raises would end the others."""

    def broken(*given: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(exact_step, "solve", broken)
    found = run(errors_off(bar()), body=box_body((2, 2), (1, LENGTH)))
    assert found.exit_code == 3
    assert "what is left of their laws" in found.verdict


def test_a_search_for_all_answers_that_breaks_down_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rank 0 searches alone, too."""

    def broken(*given: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(several, "all_answers", broken)
    found = run(errors_off(bar(), all_answers=True), body=box_body((2, 2), (1, LENGTH)))
    assert found.passed
    assert "as the search broke down; there may be others" in found.verdict
    assert len(found.branches) == 1


def test_a_punch_that_moves_takes_its_points_along() -> None:
    """Other points have something opposite in each load step; against the default's answers."""
    punch = Obstacle(
        shape="flat punch",
        radius=0.25,
        position=(0.3, 0.0),
        normal=(0, 1),
        indentation=0.01,
        path=Path(time=(0, 1), factor=(1, 1)),
        displacement=(0.4, 0),
    )
    scene = dataclasses.replace(
        bar(penalty_parameter="auto", obstacle=punch, law="incremental", friction_coefficient=0.2),
        steps=Steps(number=4),
    )
    body = box_body((20, 4), (1, LENGTH))
    smooth, exact = (run(errors_off(scene, strategy=s), body=body) for s in ("auto", "exact"))
    assert exact.converged
    closed = [step.quantities["contact_area"] for step in exact.steps]
    assert min(closed) > 0.3
    for one, other in zip(smooth.steps, exact.steps, strict=True):
        force = one.quantities["normal_force"]
        assert other.quantities["normal_force"] == pytest.approx(force, rel=2e-3)


def test_slender_bodies_and_a_point_that_supports_hold() -> None:
    """Two clamped strips pressed together: forces to round-off, none where nothing can move."""
    boxes_of = [Box("lower", (0, -1), (40, 0), (20, 1)), Box("upper", (0, 0), (40, 1), (20, 1))]
    scene = Scene(
        kinematics="plane strain",
        material=Material(MODULUS, 0.3),
        support=(Support("lower.x0", {"x": 0, "y": 0}), Support("upper.x0", {"x": 0, "y": 0})),
        load=(Load("lower.y0", pressure=1e-3), Load("upper.y1", pressure=1e-3)),
        contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=0.3),),
    )
    body = boxes(boxes_of)
    smooth, exact = (run(errors_off(scene, strategy=s), body=body) for s in ("auto", "exact"))
    assert exact.passed
    force = smooth.quantities["pressure_integral"]
    assert exact.quantities["pressure_integral"] == pytest.approx(force, rel=1e-5)
    points = exact.points
    held = np.abs(points.coordinates[:, 0]) < 1e-9
    assert np.abs(points.contact_pressure[held]).max(initial=0) <= 1e-9
    assert max(exact.steps[-1].residual_history) <= 1e-12
