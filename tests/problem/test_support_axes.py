"""Supports along turned axes, around an axis, and across planes and cylinders."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Load,
    Material,
    Motion,
    Path,
    Point,
    Scene,
    SolverSettings,
    Study,
    Support,
    SupportAxes,
    run,
)
from fenics_contact.common.errors import NoEquilibriumError, SceneError
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
SOLVERS = ["condensed", "full"]
E, RATIO, ANGLE = 1000.0, 0.3, np.deg2rad(30)
ALONG, ACROSS = (np.cos(ANGLE), np.sin(ANGLE)), (-np.sin(ANGLE), np.cos(ANGLE))
HELD = 3e-5  # what springs that hold give way
TURNED = SupportAxes(x=ALONG)


def turned_box(size=2):
    """A box turned about z by an angle."""
    body = box_body((4, 3, 2)[:size], (2.0, 1.0, 0.5)[:size])
    places = body.mesh.geometry.x
    x, y = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0] = ALONG[0] * x + ACROSS[0] * y
    places[:, 1] = ALONG[1] * x + ACROSS[1] * y
    return body


def pulled(size, sides):
    """Pulled by 5 along its first axis: its end moves by 5 · 2/E, its side by −ν 5/E."""
    traction = (*(5 * np.array(ALONG)), 0.0)[:size]
    corner = np.add(np.multiply(2, ALONG), ACROSS)
    return Scene(
        kinematics="3D" if size == 3 else "plane stress",
        material=Material(E, RATIO),
        support=sides,
        load=(Load("x1", traction=traction),),
        point=(Point("corner", (*corner, 0.0)[:size]),),
        solver=SolverSettings(errors="none"),
    )


@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("way", ["normal", "axes"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_turned_box_is_pulled_as_one_that_is_not(size, way, solver):
    if way == "normal":
        sides = tuple(Support(f"{axis}0", normal=0.0) for axis in "xyz"[:size])
    else:
        axes = SupportAxes(
            x=ALONG if size == 2 else (*ALONG, 0), y=(0, 1, 0) if size == 3 else None
        )
        sides = tuple(Support(f"{axis}0", {axis: 0.0}, axes=axes) for axis in "xyz"[:size])
    scene = replace(pulled(size, sides), solver=SolverSettings(solver=solver, errors="none"))
    found = run(scene, COMM, turned_box(size))
    assert found.passed, found.verdict
    moved = np.array(found.quantities["displacement_corner"])[:2]
    assert moved @ ALONG == pytest.approx(10 / E, rel=HELD)
    assert moved @ ACROSS == pytest.approx(-RATIO * 5 / E, rel=HELD)
    area = 1.0 if size == 2 else 0.5
    reaction = np.array(found.supports[0].reaction)[:2]
    assert reaction == pytest.approx(-5 * area * np.array(ALONG), rel=1e-8, abs=1e-8)


INNER, OUTER, HEIGHT = 20.0, 40.0, 30.0
AROUND = SupportAxes(cylindrical=(0, 0, 2))


def tube(cells=(24, 2, 1), order=2, shift=(0.0, 0.0)):
    """A tube along z, along which these displacements are linear."""
    box = Box("tube", (0.0, INNER, 0.0), (2 * np.pi, OUTER, HEIGHT), cells)
    body = boxes([box], "hexahedron", order=order, closed=["tube"])
    places = body.mesh.geometry.x
    angle, radius = places[:, 0].copy(), places[:, 1].copy()
    places[:, 0] = radius * np.cos(angle) + shift[0]
    places[:, 1] = radius * np.sin(angle) + shift[1]
    return body


def held_tube(*supports, **more):
    """Held along z, and against rotation, besides other supports."""
    given = {
        "kinematics": "3D",
        "material": Material(E, RATIO),
        "support": (
            *supports,
            Support("tube.z0", {"z": 0.0}),
            Support("tube.z1", {"around": 0.0}, axes=AROUND, name="key"),
        ),
        "solver": SolverSettings(errors="none"),
    }
    return Scene(**given | more)


def plane_stress(bore, rim):
    """A and B of u = A r + B/r from two rows of (coefficients, right side): G. Lamé 1852."""
    return np.linalg.solve([bore[0], rim[0]], [bore[1], rim[1]])


def stress_row(radius, stress):
    """σ_r = stress."""
    factor = E / (1 - RATIO**2)
    return (factor * (1 + RATIO), -factor * (1 - RATIO) / radius**2), stress


@pytest.mark.parametrize("way", ["normal", "axes"])
@pytest.mark.parametrize("solver", [*SOLVERS, "iterative"])
def test_a_tube_in_a_rigid_hole(way, solver):
    """Pressed from inside, its rim cannot move outwards, and slides along."""
    rim = (
        Support("tube.y1", normal=0.0)
        if way == "normal"
        else Support("tube.y1", {"radial": 0.0}, axes=AROUND)
    )
    scene = held_tube(
        rim,
        load=(Load("tube.y0", pressure=10.0),),
        point=(Point("bore", (INNER, 0.0, HEIGHT / 2)),),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    found = run(scene, COMM, tube())
    assert found.passed, found.verdict
    a, b = plane_stress(stress_row(INNER, -10.0), ((OUTER, 1 / OUTER), 0.0))
    at_bore = found.quantities["displacement_bore"][0]
    assert at_bore == pytest.approx(a * INNER + b / INNER, rel=2e-3)


def test_a_rim_that_is_moved_outwards():
    """By a given displacement across it, at an axis that is not the origin."""
    shift = (7.0, -3.0)
    key = Support("tube.z1", {"around": 0.0}, axes=replace(AROUND, at=(*shift, 0.0)))
    scene = held_tube(point=(Point("bore", (INNER + shift[0], shift[1], HEIGHT / 2)),))
    supports = (Support("tube.y1", normal=0.2), scene.support[0], key)
    found = run(replace(scene, support=supports), COMM, tube(shift=shift))
    a, b = plane_stress(stress_row(INNER, 0.0), ((OUTER, 1 / OUTER), 0.2))
    at_bore = found.quantities["displacement_bore"][0]
    assert at_bore == pytest.approx(a * INNER + b / INNER, rel=2e-3)
    bore = replace(scene, support=(Support("tube.y0", normal=-0.1), scene.support[0], key))
    found = run(bore, COMM, tube(shift=shift))  # outwards of the body is towards the axis
    assert found.quantities["displacement_bore"][0] == pytest.approx(0.1, rel=1e-3)


def test_a_shaft_that_is_turned():
    """By G J θ/L, the displacement around it grows with the radius."""
    twist = 0.01
    turned = Support(
        "tube.z1", {"around": lambda x: twist * np.hypot(x[0], x[1])}, axes=AROUND, name="turned"
    )
    clamp = Support("tube.z0", {"x": 0, "y": 0, "z": 0})
    found = run(held_tube(support=(turned, clamp)), COMM, tube((32, 2, 1)))
    stiffness = E / (2 * (1 + RATIO)) * np.pi / 2 * (OUTER**4 - INNER**4) / HEIGHT
    assert found.supports[0].reaction_moment[2] == pytest.approx(stiffness * twist, rel=2e-3)


def test_a_bearing_of_radial_springs():
    """Springs across and around a rim resist a sideways motion with half of their stiffness."""
    across, around = 0.02, 0.003
    springs = {"radial": across, "around": around}
    bearing = Support("tube.y1", foundation_stiffness=springs, axes=AROUND)
    scene = held_tube(
        support=(bearing, Support("tube.z0", {"z": 0.0})),
        material=Material(1e6, RATIO),
        load=(Load("tube.y0", force=(30, 0, 0)),),
        point=(Point("bore", (0.0, INNER, HEIGHT / 2)),),
    )
    found = run(scene, COMM, tube())
    area = 2 * np.pi * OUTER * HEIGHT
    expected = 30 / ((across + around) * area / 2)
    assert found.quantities["displacement_bore"][0] == pytest.approx(expected, rel=2e-3)
    assert found.quantities["spring_energy"] == pytest.approx(15 * expected, rel=2e-3)


def test_a_cylinder_that_is_held_across_can_still_turn():
    scene = held_tube(support=(Support("tube.y1", normal=0.0), Support("tube.z0", {"z": 0.0})))
    with refused("cylinder_turns", NoEquilibriumError):
        run(scene, COMM, tube())


@pytest.mark.parametrize("order", [1, 2])
def test_of_facets_it_can_turn_too(order):
    """Along an axis that is given every place of a facet has its own direction."""
    supports = (Support("tube.y1", {"radial": 0.0}, axes=AROUND), Support("tube.z0", {"z": 0.0}))
    with refused("cylinder_turns", NoEquilibriumError):
        run(held_tube(support=supports), COMM, tube(order=order))


@pytest.mark.errors
def test_bars_hold():
    scene = held_tube(
        Support("tube.y1", normal=0.0),
        load=(Load("tube.y0", pressure=10.0),),
        point=(Point("bore", (INNER, 0.0, HEIGHT / 2)),),
        solver=SolverSettings(errors="all"),
    )
    found = run(scene, COMM, tube())
    a, b = plane_stress(stress_row(INNER, -10.0), ((OUTER, 1 / OUTER), 0.0))
    exact = a * INNER + b / INNER
    error = abs(found.quantities["displacement_bore"][0] - exact)
    assert error < found.errors["displacement_bore"]["total"] < 0.05 * exact


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("ratio", [0.3, 0.4999])
def test_a_block_that_cannot_give_way_sideways(ratio, solver):
    """Held all around by its normals: E (1 − ν)/((1 + ν)(1 − 2ν)) times the strain."""
    sides = tuple(Support(side, normal=0.0) for side in ("x0", "x1", "y0"))
    pressed = Support("y1", {"y": -1e-3})
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, ratio),
        support=(*sides, pressed),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    found = run(scene, COMM, box_body((4, 3), (2.0, 1.0)))
    assert found.passed, found.verdict
    confined = E * (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio))
    reaction = next(row for row in found.supports if row.on == "y1").reaction
    assert reaction[1] == pytest.approx(-confined * 1e-3 * 2.0, rel=4 * HELD)


def contradicting(*supports, **keys):
    return Scene(
        kinematics=keys.pop("kinematics", "plane strain"),
        material=Material(E, RATIO),
        support=supports,
        solver=SolverSettings(errors="none"),
        **keys,
    )


OUT = SupportAxes(x=(1.0, 0.0))
SHORT = Path(time=(0, 0.5, 1), factor=(0, 1, 0.5))


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        (
            contradicting(
                Support("y0", {"x": 0.0, "y": 0.0}), Support("x0", {"x": 0.01}, axes=OUT)
            ),
            "axes_against_a_support",
        ),
        (
            contradicting(Support("x0", {"x": 0.01}, axes=TURNED), Support("y0", normal=0.0)),
            "",
        ),
        (
            contradicting(
                Support("x0", {"x": 0.01, "y": 0.02}, axes=OUT), Support("y0", normal=0.02)
            ),
            "axes_against_a_normal",
        ),
        (
            contradicting(
                Support("x0", {"x": 0.01, "y": -0.02}, axes=OUT), Support("y0", normal=0.02)
            ),
            "",
        ),
        (
            contradicting(
                Support("x0", {"x": 0.01, "y": -0.02}, axes=OUT, path=SHORT),
                Support("y0", normal=0.02),
            ),
            "axes_at_other_times",
        ),
        (
            contradicting(Support("y0", {"x": 0.01, "y": 0.0}, axes=OUT), symmetry=("x1",)),
            "axes_against_symmetry",
        ),
        (
            contradicting(
                Support("y0", {"x": 0.01, "y": 0.0}, axes=OUT), kinematics="axisymmetric"
            ),
            "axes_against_the_axis",
        ),
    ],
)
def test_supports_that_move_a_point_otherwise_are_refused(scene, name):
    """Those that agree there are not: along two directions that are not the same, or alike."""
    if name:
        with refused(name):
            run(scene, COMM, box_body((4, 3), (2.0, 1.0)))
        return
    found = run(scene, COMM, box_body((4, 3), (2.0, 1.0)))
    assert found.passed, found.verdict


@pytest.mark.parametrize(
    ("support", "key", "value"),
    [
        (Support("x1", {"x": 0.01}, axes=TURNED), "support.1.displacement.x", 0.01),
        (Support("x1", normal=0.01), "support.1.normal", 0.01),
    ],
)
def test_derivatives_are_those_of_differences(support, key, value):
    scene = pulled(2, (Support("x0", {"x": 0, "y": 0}), replace(support, name="end")))
    scene = replace(scene, load=(Load("y1", pressure=1.0),))
    study = Study(scene, body=turned_box())
    of = ["strain_energy", "displacement_corner_y", "end.reaction_x"]
    slopes = study.derivatives(of, [key])
    step = 1e-4
    below, above = (study.solve({key: value + sign * step}) for sign in (-1, 1))
    for name in of:
        one, other = (
            answer.supports[1].reaction[0]
            if name.startswith("end")
            else answer.quantities["displacement_corner"][1]
            if name.startswith("disp")
            else answer.quantities[name]
            for answer in (below, above)
        )
        assert slopes[name][key] == pytest.approx((other - one) / (2 * step), rel=1e-5), name


def test_any_number_of_ranks_has_the_same_answer():
    scene = pulled(2, (Support("x0", normal=0.0), Support("y0", normal=0.0)))
    found = run(scene, COMM, turned_box())
    assert found.supports[1].reaction == pytest.approx([0, 0], abs=1e-8)
    assert found.supports[0].reaction_moment == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: SupportAxes(), "axes_one_kind"),
        (lambda: SupportAxes(x=(1, 0), cylindrical=(0, 0, 1)), "axes_one_kind"),
        (lambda: SupportAxes(x=(0, 0)), "axes_no_direction"),
        (lambda: SupportAxes(x=(1, 0), at=(0, 0)), "axes_at_without_axis"),
        (lambda: Support("x0", {"x": 0}, normal=0.0), "normal_beside_displacement"),
        (lambda: pulled(2, (Support("x0", {"radial": 0}, axes=TURNED),)), "axes_unknown_component"),
        (lambda: pulled(2, (Support("x0", {"radial": 0}),)), "axes_component_without_axes"),
        (lambda: pulled(3, (Support("x0", {"x": 0}, axes=TURNED),)), "axes_in_space"),
        (
            lambda: pulled(2, (Support("x0", {"x": 0}, axes=replace(TURNED, y=(0, 1))),)),
            "axes_y_in_the_plane",
        ),
        (
            lambda: replace(
                pulled(2, (Support("x0", normal=0.0),)), motion=Motion(end=1.0, step=0.1)
            ),
            "axes_in_motion",
        ),
    ],
)
def test_what_axes_cannot_say_is_refused(make, name):
    with refused(name, SceneError):
        make()


def test_a_boundary_without_a_normal_is_refused():
    body = box_body((4, 3), (2.0, 1.0))
    places = body.mesh.geometry.x
    places[:, 1] += 0.1 * np.sin(2 * places[:, 0])
    scene = replace(pulled(2, (Support("y0", normal=0.0),)), point=())
    with refused("normal_of_a_wave"):
        run(scene, COMM, body)
