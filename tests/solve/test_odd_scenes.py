"""Legal but odd scenes: each is solved rightly, or refused in one sentence."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    NoEquilibriumError,
    Obstacle,
    Profile,
    Scene,
    Support,
    run,
)
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
CLAMP = Support("y0", {"x": 0, "y": 0})
ASIDE = Support("x0", {"x": 0})
DOWN = Load("y1", traction=(0, -10))


def block(*contacts, support=(ASIDE,), load=(), cells=(6, 8), size=(1, 2), nu=0.3, **keys):
    scene = Scene(
        kinematics=keys.pop("kinematics", "plane strain"),
        material=Material(keys.pop("modulus", 1000.0), nu),
        discretisation=Discretisation(keys.pop("degree", 2)),
        support=support,
        load=load,
        contact=contacts,
        **keys,
    )
    return run(scene, COMM, box_body(cells, size))


def plane(height, **keys):
    return Obstacle("plane", position=(0, height), **keys)


@pytest.mark.parametrize("penalty", [1e-9, 1e-12])
def test_stiff_penalties_do_not_stop_the_solver_early(penalty):
    result = block(Contact("y0", penalty_parameter=penalty), load=(DOWN,))
    assert result.passed
    assert result.points.contact_pressure == pytest.approx(10, rel=1e-3)


@pytest.mark.parametrize("force", [1e-8, 1e-2, 1e4])
def test_light_and_heavy_forces(force):
    """A curved punch: the force is met, whatever its size."""
    punch = Obstacle("parabola", radius=4, position=(0.5, 2), force=force)
    result = block(Contact("y1", obstacle=punch), support=(CLAMP,), cells=(8, 8), modulus=1e5)
    assert result.passed, result.verdict
    assert result.quantities["normal_force"] == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_units_do_not_matter(scale):
    """Stresses in other units: the same dimensionless answer."""
    punch = Obstacle("parabola", radius=4, position=(0.5, 2), force=scale * 10)
    result = block(
        Contact("y1", obstacle=punch), support=(CLAMP,), cells=(8, 8), modulus=scale * 1000
    )
    reference = block(
        Contact("y1", obstacle=Obstacle("parabola", radius=4, position=(0.5, 2), force=10.0)),
        support=(CLAMP,),
        cells=(8, 8),
    )
    assert result.passed
    for key, unit in (("indentation", 1), ("max_contact_pressure", scale), ("contact_area", 1)):
        assert result.quantities[key] == pytest.approx(unit * reference.quantities[key], rel=1e-6)


@pytest.mark.parametrize("size", [(1, 2), (0.3, 0.7)])
def test_just_touching_within_round_off(size):
    result = block(
        Contact("y1", obstacle=plane(size[1])), support=(CLAMP,), cells=(8, 8), size=size
    )
    assert result.passed
    assert abs(result.quantities["normal_force"]) < 1e-6
    punch = Obstacle("parabola", radius=4, position=(size[0] / 2, size[1]))
    assert block(Contact("y1", obstacle=punch), support=(CLAMP,), cells=(8, 8), size=size).passed


@pytest.mark.parametrize("nu", [0.3, 0.49, 0.4999, 0.49999])
def test_penalty_suits_confined_material(nu):
    """Uniaxial strain: the stiffness is that of compression waves, far above E near ν = ½."""
    sides = tuple(Support(name, {"x": 0}) for name in ("x0", "x1"))
    result = block(
        Contact("y1", obstacle=plane(1, indentation=0.01)),
        support=(*sides, Support("y0", {"y": 0})),
        cells=(4, 4),
        size=(1, 1),
        nu=nu,
    )
    modulus = 1000 * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    assert result.passed
    assert result.quantities["normal_force"] == pytest.approx(0.01 * modulus, rel=1e-3)


@pytest.mark.parametrize("stiffness", [1e3, 1e7])
def test_foundation_that_ends_within_the_surface(stiffness):
    ends = Profile("x", (0, 0.5, 0.501), (stiffness, stiffness, 0))
    result = block(Contact("y0", foundation_stiffness=ends), load=(DOWN,), cells=(16, 16))
    assert result.converged
    assert result.quantities["contact_area"] == pytest.approx(0.5, abs=0.07)
    assert result.quantities["normal_force"] == pytest.approx(10, rel=1e-8)


def test_glued_obstacle_under_force_is_a_rigid_plate():
    glued = {"contact": "bonded", "support": (CLAMP,)}
    kind, support = glued["contact"], glued["support"]
    pressed = block(Contact("y1", contact=kind, obstacle=plane(2, force=10)), support=support)
    assert pressed.passed
    assert pressed.quantities["normal_force"] == pytest.approx(10, rel=1e-8)
    driven = pressed.quantities["indentation"]
    again = block(
        Contact("y1", contact=kind, obstacle=plane(2, indentation=driven)), support=support
    )
    assert again.quantities["normal_force"] == pytest.approx(10, rel=1e-6)


def test_glued_obstacle_without_force_keeps_its_surface_rigid():
    side = Load("x1", traction=(0, -5))
    free = block(
        Contact("y1", contact="bonded", obstacle=plane(2, force=0)), support=(CLAMP,), load=(side,)
    )
    assert free.passed
    slips = free.points.slip[:, :2] @ np.eye(2)
    assert np.abs(slips).max() < 1e-3 * free.quantities["max_slip"] + 1e-4
    assert free.quantities["normal_force"] == pytest.approx(0, abs=1e-6)
    assert "does not touch" not in free.verdict


@pytest.mark.parametrize("direction", [(1, 0), (0, 1)])
def test_glued_obstacle_can_be_pulled_and_sheared(direction):
    obstacle = Obstacle(
        "plane", position=(0, 2), normal=(0, -1), direction=direction, indentation=0.01
    )
    result = block(Contact("y1", contact="bonded", obstacle=obstacle), support=(CLAMP,))
    assert result.passed
    assert np.hypot(*result.quantities["reaction"]) > 0.5


def test_wedged_between_obstacles():
    """No loads: overlaps press it; with clearance, what only a side load holds is refused."""
    floor, ceiling = (
        Contact("y0", obstacle=Obstacle("plane", indentation=0.01)),
        Contact("y1", obstacle=plane(2, indentation=0.01)),
    )
    wedged = block(floor, ceiling)
    assert wedged.passed
    expected = 0.02 / 2 * 1000 / (1 - 0.3**2)
    assert wedged.contacts[0]["quantities"]["normal_force"] == pytest.approx(expected, rel=1e-3)
    with_clearance = (Contact("y0", obstacle=plane(-0.1)), Contact("y1", obstacle=plane(2.1)))
    with refused("body_has_clearance", NoEquilibriumError):
        block(*with_clearance, load=(Load("x1", traction=(-5, 0)),))


def test_points_that_supports_hold_are_no_contact_points():
    """Clamped sides: what the obstacle meets at their corners is the clamp's affair."""
    clamps = tuple(Support(name, {"x": 0, "y": 0}) for name in ("x0", "x1"))
    for degree in (1, 2):
        result = block(
            Contact("y1", obstacle=plane(2, indentation=0.01)),
            support=clamps,
            cells=(8, 16),
            degree=degree,
        )
        assert result.passed, result.verdict
        assert 1 < result.quantities["normal_force"] < 100
        held = np.isinf(result.points.gap)
        assert held.sum() == 2 and (result.points.status[held] == "OPEN").all()


def test_sharp_edges_within_a_surface_are_refused():
    with refused("surface_has_a_sharp_edge"):
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            support=(CLAMP,),
            contact=(Contact("top and side", obstacle=plane(2, indentation=0.01, normal=(0, -1))),),
        )
        box = box_body((4, 4), (1, 2))
        tags = box.groups["y1"].tags + box.groups["x1"].tags
        groups = {**box.groups, "top and side": type(box.groups["y1"])(1, tags)}
        run(scene, COMM, Body(box.mesh, box.cell_tags, box.facet_tags, groups))


def half_space(obstacle, cells=(8, 4, 4), size=(2, 1, 1), **keys):
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        half_space=HalfSpace(("z0", "x0", "x1", "y0", "y1")),
        contact=(Contact("z1", obstacle=obstacle),),
        **keys,
    )
    return run(scene, COMM, box_body(cells, size))


def test_unknown_resultant_with_far_dofs_that_do_not_move():
    """The foot off the middle: some of the far field's entries vanish."""
    obstacle = Obstacle("paraboloid", radius=1, position=(0.5, 0.5, 1), indentation=0.02)
    result = half_space(obstacle)
    assert result.passed
    assert result.quantities["normal_force"] > 0


@pytest.mark.parametrize(
    ("obstacle", "message"),
    [
        (
            Obstacle("paraboloid", radius=1, position=(0, 0.5, 1), indentation=0.02),
            "force_at_a_side",
        ),
        (Obstacle("paraboloid", radius=1, position=(5, 0.5, 1), force=1), "force_far_outside"),
        (
            Obstacle(gap=lambda x: x[0] ** 2, force=1),
            "force_at_a_corner",
        ),  # at the origin, a corner
    ],
)
def test_far_field_needs_a_foot_on_the_contact_surface(obstacle, message):
    with refused(message):
        half_space(obstacle)


def test_one_plane_of_symmetry_named_twice_is_one():
    from fenics_contact.problem.problem import Problem

    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(CLAMP,),
        symmetry=("x0", "x0"),
        contact=(Contact("y1"),),
    )
    assert Problem.on_mesh(scene, box_body((2, 2), (1, 2))).discrete.held.symmetry == "half (x = 0)"


def test_foundation_all_around_needs_no_direction():
    """Springs on two opposite sides: no resultant direction, so the sum of pressures counts."""
    box = box_body((4, 4), (1, 2))
    tags = box.groups["x0"].tags + box.groups["x1"].tags
    groups = {**box.groups, "both": type(box.groups["x0"])(1, tags)}
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(DOWN,),
        contact=(Contact("both", foundation_stiffness=100),),
    )
    result = run(scene, COMM, Body(box.mesh, box.cell_tags, box.facet_tags, groups))
    assert result.passed
    assert result.quantities["normal_force"] is None
    assert result.quantities["pressure_integral"] == pytest.approx(
        result.points.weights @ result.points.contact_pressure, rel=1e-6
    )


def test_curved_body_on_its_plane_of_symmetry_has_an_upright_normal():
    """Half a cylinder: the average over one side alone would be tilted at the lowest point."""
    from fenics_contact import MeshSource, Run
    from tests.scenes import ROOT

    scene = Scene(
        kinematics="plane strain",
        mesh=MeshSource(str(ROOT / "meshes" / "cylinder.geo"), order=2),
        material=Material(1000, 0.3),
        symmetry=("axis",),
        load=(Load("top", traction=(0, -5)),),
        contact=(Contact("contact", obstacle=Obstacle("plane", normal=(0, 1))),),
    )
    trace = Run(scene, COMM).problem.contacts[0].trace
    lowest = np.abs(trace.coordinates[:, 0]) < 1e-9
    assert np.abs(trace.normals[lowest] - [0, -1]).max(initial=0.0) < 1e-12
