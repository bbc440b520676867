"""Boussinesq's, Cerruti's and Flamant's fields: equations of elasticity, by differences."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    run,
)
from fenics_contact.analytic.half_space import boussinesq, cerruti, flamant, flamant_along
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.verification.published.shear import SPHERE, sheared_scene, shift
from tests.messages import refused
from tests.scenes import ROOT, box_body

E, NU = 1000.0, 0.3
INWARD = np.array([0.0, 0.0, -1.0])
ALONG = np.array([0.6, 0.8, 0.0])
ALONG_EDGE = np.array([1.0, 0.0, 0.0])


def gradient(field, point, step=1e-4):
    """∂u_i/∂x_j by central differences."""
    columns = []
    for axis in range(3):
        move = step * np.eye(3)[axis]
        columns.append((field(point + move) - field(point - move)) / (2 * step))
    return np.stack(columns, axis=1)


def stress(field, point, step=1e-4):
    e = gradient(field, point, step)
    e = 0.5 * (e + e.T)
    shear, lame = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
    return 2 * shear * e + lame * np.trace(e) * np.eye(3)


def point_force(point):
    return boussinesq(point[None], INWARD, E, NU)[0]


def line_force(point):
    return flamant(point[None] * [1, 0, 1], INWARD, E, NU, 5.0)[0]


def point_force_along(point):
    return cerruti(point[None], ALONG, INWARD, E, NU)[0]


def line_force_along(point):
    return flamant_along(point[None] * [1, 0, 1], ALONG_EDGE, INWARD, E, NU, 5.0)[0]


def sphere_points(number=48):
    """Points and weights of a half sphere of radius 2 below the surface."""
    heights, weights = np.polynomial.legendre.leggauss(number)
    heights, weights = -(heights + 1) / 2, weights / 2
    angles = np.arange(number) * 2 * np.pi / number
    z, phi = np.meshgrid(heights, angles, indexing="ij")
    r = np.sqrt(1 - z**2)
    points = 2 * np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1).reshape(-1, 3)
    return points, np.repeat(weights, number) * 4 * 2 * np.pi / number


@pytest.mark.parametrize(
    ("field", "force"), [(point_force, INWARD), (point_force_along, ALONG)], ids=["into", "along"]
)
def test_point_force_is_balanced_by_the_stress_around_it(field, force):
    points, weights = sphere_points()
    tractions = np.array([stress(field, p) @ (p / 2) for p in points])
    # What the half sphere's surface carries must balance the force.
    assert weights @ tractions == pytest.approx(-force, abs=1e-5)


@pytest.mark.parametrize(
    ("field", "force"),
    [(line_force, INWARD), (line_force_along, ALONG_EDGE)],
    ids=["into", "along"],
)
def test_line_force_is_balanced_by_the_stress_around_it(field, force):
    angles = -np.pi * (np.arange(400) + 0.5) / 400
    points = 2 * np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    tractions = np.array([stress(field, p) @ (p / 2) for p in points])
    assert tractions.sum(axis=0) * 2 * np.pi / 400 == pytest.approx(-force, abs=1e-4)


@pytest.mark.parametrize("field", [point_force, line_force, point_force_along, line_force_along])
def test_inside_is_in_equilibrium_and_the_surface_is_free(field):
    point, step = np.array([0.8, 0.0, -1.1]), 1e-3
    divergence = np.zeros(3)
    for axis in range(3):
        move = step * np.eye(3)[axis]
        after, before = stress(field, point + move), stress(field, point - move)
        divergence += (after - before)[:, axis] / (2 * step)
    size = np.abs(stress(field, point)).max()
    assert np.abs(divergence).max() < 1e-4 * size
    near_surface = stress(field, np.array([0.9, 0.0, -2e-4]), step=1e-5)
    assert np.abs(near_surface[:, 2]).max() < 2e-3 * np.abs(near_surface).max()


def test_forces_into_the_surface_and_along_it_are_reciprocal():
    """Betti: what a force along does into the surface is what one into it does along."""
    points = np.random.default_rng(0).normal(size=(5, 3)) * [1, 1, 0]
    into = cerruti(points, ALONG, INWARD, E, NU) @ INWARD
    assert into == pytest.approx(boussinesq(-points, INWARD, E, NU) @ ALONG, rel=1e-12)
    on_edge = points * [1, 0, 0]
    into = flamant_along(on_edge, ALONG_EDGE, INWARD, E, NU, 5.0) @ INWARD
    assert into == pytest.approx(flamant(-on_edge, INWARD, E, NU, 5.0) @ ALONG_EDGE, rel=1e-12)


def test_flamant_is_zero_at_its_datum():
    assert line_force(np.array([0.0, 0, -5])) == pytest.approx([0, 0, 0], abs=1e-12)
    assert line_force_along(np.array([0.0, 0, -5])) == pytest.approx([0, 0, 0], abs=1e-12)


def scene(kinematics="axisymmetric", obstacle=None, **changes):
    keys = {
        "kinematics": kinematics,
        "mesh": MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={"fine": 4, "size": 0.5, "extent": 40, "cells_outside": 12},
        ),
        "material": Material(E, NU),
        "symmetry": ("axis",),
        "half_space": HalfSpace(("outer",)),
        "contact": (
            Contact("contact", obstacle=obstacle or Obstacle("paraboloid", radius=8, force=1000)),
        ),
    }
    return Scene(**keys | changes)


def test_unknown_and_given_resultant_are_the_same_problem():
    """Driven by force the far field is known; driven by indentation it is an unknown."""
    by_force = run(scene())
    depth = by_force.quantities["indentation"]
    by_depth = run(scene(obstacle=Obstacle("paraboloid", radius=8, indentation=depth)))
    assert by_depth.model["scalar_unknowns"] == ["resultant at contact"]
    assert by_depth.quantities["normal_force"] == pytest.approx(1000, rel=1e-8)
    assert by_depth.quantities["strain_energy"] == pytest.approx(
        by_force.quantities["strain_energy"], rel=1e-8
    )


def test_around_an_axis_friction_has_no_resultant():
    contact = dataclasses.replace(scene().contact[0], friction_coefficient=0.5)
    prepared = Run(scene(contact=(contact,)))
    assert [unknown.kind for unknown in prepared.problem.unknowns] == ["indentation"]


@pytest.mark.parametrize(
    ("kinematics", "shape"), [("axisymmetric", "paraboloid"), ("plane strain", "parabola")]
)
def test_the_force_of_a_gap_acts_at_the_origin_by_default(kinematics, shape):
    """The gap x²/2R is the parabola's, which stands at the origin."""
    gap = Obstacle(gap=lambda x: x[0] ** 2 / 16, force=500)
    found = run(scene(kinematics, gap)).quantities
    wanted = run(scene(kinematics, Obstacle(shape, radius=8, force=500))).quantities
    for name in ("max_contact_pressure", "contact_area", "strain_energy"):
        assert found[name] == pytest.approx(wanted[name], rel=1e-9), name


def test_line_contact_half_and_whole_agree_and_name_no_indentation():
    """Mirror images: half a model with half the force, on either side of x = 0."""
    radius, force = 8.0, 400.0
    half = run(scene("plane strain", Obstacle("parabola", radius=radius, force=force / 2)))
    assert "indentation" not in half.quantities
    modulus = E / (1 - NU**2)
    width = np.sqrt(4 * force * radius / (np.pi * modulus))
    assert half.quantities["contact_area"] == pytest.approx(width, rel=0.02)
    assert half.model["symmetry"] == "half (x = 0)"


@pytest.mark.parametrize("follows", [True, False], ids=["Cerruti", "held sideways"])
def test_sideways_stiffness_hardly_depends_on_the_mesh_extent(follows, monkeypatch):
    """Full stick: δ = Q (2 − ν)/(8 G a); held sideways, the boundary stiffens it by a/L."""
    if not follows:
        monkeypatch.setattr(ContactSurface, "can_shear", False)
    error = {}
    for extent, cells in ((5, 2), (10, 3)):
        result = run(sheared_scene(0.02, extent=extent, cells_outside=cells))
        assert result.passed, result.verdict
        assert len(result.model["scalar_unknowns"]) == 1 + follows
        shear = result.quantities["friction_force"][0]
        assert result.quantities["reaction"][0] == pytest.approx(-shear, rel=1e-7)
        error[extent] = shift(0.02) / shift(2 * shear / (0.3 * SPHERE.force)) - 1
    if follows:
        assert max(map(abs, error.values())) < 6e-3
        assert abs(error[5] - error[10]) < 2e-3
    else:
        assert error[5] < -0.15 and error[10] < -0.08


def sheared_half_plane(extent):
    """Sideways displacement of a sticking obstacle over the force that it takes."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU),
        half_space=HalfSpace(("x0", "x1", "y0")),
        contact=(
            Contact(
                "patch",
                friction_coefficient=2.0,
                obstacle=Obstacle(
                    "parabola",
                    radius=30,
                    position=(extent, extent),
                    force=20.0,
                    displacement=(0.002, 0),
                ),
            ),
        ),
    )
    near = {"patch": ("y1", lambda x: np.abs(x[0] - extent) < 2)}
    body = box_body((16 * extent // 2, 8 * extent // 2), (2 * extent, extent), patches=near)
    result = run(scene, body=body)
    assert result.passed, result.verdict
    return 0.002 / result.quantities["friction_force"][0]


def test_sideways_datum_of_a_half_plane_lies_straight_below():
    """Its distance, to the farthest corner, is all that a larger mesh changes."""
    small, large = (sheared_half_plane(extent) for extent in (4, 8))
    change = 2 * (1 - NU**2) / (np.pi * E) * np.log(2)
    assert large - small == pytest.approx(change, rel=0.03)


def sheared_pair(symmetry):
    """Two spheres that move apart, or one of them beside a plane of symmetry."""
    contacts = tuple(
        Contact(
            name,
            friction_coefficient=0.4,
            obstacle=Obstacle(
                "sphere",
                radius=2,
                position=(middle, 1, 1),
                indentation=0.02,
                displacement=(np.sign(middle - 2) * 0.004, 0.003, 0),
            ),
        )
        for name, middle in (("right", 3), ("left", 1))
    )
    scene = Scene(
        kinematics="3D",
        material=Material(E, NU),
        discretisation=Discretisation(1),
        half_space=HalfSpace(("x1", "y0", "y1", "z0", *(() if symmetry else ("x0",)))),
        symmetry=("x0",) if symmetry else (),
        contact=contacts[:1] if symmetry else contacts,
    )
    return scene


def test_forces_beside_a_plane_of_symmetry_have_images_with_mirrored_directions():
    """Along the plane's normal they add nothing to the resultant, but do move the boundary."""

    def near(middle):
        return lambda x: (np.abs(x[0] - middle) < 0.5) & (np.abs(x[1] - 1) < 0.5)

    patches = {"right": ("z1", near(3)), "left": ("z1", near(1))}
    whole = run(sheared_pair(False), body=box_body((16, 8, 4), (4, 2, 1), patches=patches))
    patches = {"right": ("z1", near(1))}
    half_body = box_body((8, 8, 4), (2, 2, 1), patches=patches)
    scene = sheared_pair(True)
    obstacle = dataclasses.replace(scene.contact[0].obstacle, position=(1, 1, 1))
    contact = dataclasses.replace(scene.contact[0], obstacle=obstacle)
    half = run(dataclasses.replace(scene, contact=(contact,)), body=half_body)
    assert whole.passed and half.passed
    assert len(half.model["scalar_unknowns"]) == 3
    assert len(whole.model["scalar_unknowns"]) == 6
    found, wanted = half.contacts[0]["quantities"], whole.contacts[0]["quantities"]
    for name in ("normal_force", "friction_force", "contact_area", "friction_work"):
        assert found[name] == pytest.approx(wanted[name], rel=1e-6, abs=1e-6), name


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {
                "kinematics": "plane strain",
                "contact": (Contact("contact", obstacle=Obstacle("parabola", radius=8)),),
            },
            "half_space_indentation_has_no_datum",
        ),
        ({"contact": (Contact("contact", pressure=1),)}, "half_space_needs_a_flat_contact"),
        ({"material": Material(lambda x: 1000 + x[0], 0.3)}, "half_space_material_not_uniform"),
        ({"contact": ()}, "half_space_without_contact"),
    ],
)
def test_what_a_half_space_cannot_be_is_said(changes, message):
    with refused(message):
        run(scene(**changes))


def test_half_space_takes_no_loads_and_no_plane_stress():
    with refused("half_space_with_load", ValueError):
        scene(load=(Load("contact", traction=(0, 1)),))
    with refused("half_space_in_plane_stress", ValueError):
        scene("plane stress", Obstacle("parabola", radius=8, force=1))
