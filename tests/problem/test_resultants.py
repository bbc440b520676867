"""Forces and moments over a surface: resultants, displacements of beams, symmetry, derivatives."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Point,
    Scene,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.writing import scene_text
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body

CLAMPED = Support("x0", {"x": 0, "y": 0, "z": 0})
HELD = Support("x0", {"x": 0, "y": 0})
NO_CHECKS = {"errors": "none"}


def block(*loads, **more):
    """A block in space that its side x0 holds."""
    return Scene(
        kinematics="3D", material=Material(1000, 0.3), support=(CLAMPED,), load=loads, **more
    )


def plate(*loads, kinematics="plane strain", **more):
    """A plate in the plane that its side x0 holds."""
    return Scene(
        kinematics=kinematics, material=Material(1000, 0.3), support=(HELD,), load=loads, **more
    )


def resultants(scene, body, about):
    """Sum of the nodal forces of the only load, and of their moments about a point."""
    problem = Problem.on_mesh(scene, body)
    (load,) = problem.loads
    spaces = problem.spaces
    own = slice(spaces.owned_nodes)
    forces = load.acting.nodal()[own]
    assert forces == pytest.approx(spaces.assemble(load.form)[own], abs=1e-13 * abs(forces).max())
    size = spaces.components
    arms = spaces.coordinates[own, :size] - np.array(about)
    arms, padded = (np.pad(each, ((0, 0), (0, 3 - size))) for each in (arms, forces))
    moment = np.cross(arms, padded).sum(axis=0)
    found = np.concatenate([forces.sum(axis=0), moment if size == 3 else moment[2:]])
    return total(spaces.comm, found)


def sphere_cap():
    """A side that is curved: a box whose side x1 bulges, of cells of order 2."""
    body = boxes([Box("body", (0, 0, 0), (1, 1, 1), (2, 3, 3))], "hexahedron", order=2)
    x = body.mesh.geometry.x
    x[:, 0] += x[:, 0] * (0.3 * np.sin(np.pi * x[:, 1]) + 0.2 * x[:, 2] ** 2)
    return body


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"force": (1, 2, 3), "moment": (4, 5, 6), "at": (10, -3, 2)}, (1, 2, 3, 4, 5, 6)),
        ({"force": (0, 0, -7), "at": (10, -3, 2)}, (0, 0, -7, 0, 0, 0)),
        ({"moment": (4, -5, 6)}, (0, 0, 0, 4, -5, 6)),
    ],
)
def test_in_space_they_are_what_is_given(degree, given, expected):
    scene = block(Load("x1", **given), discretisation=Discretisation(degree))
    found = resultants(scene, box_body((3, 4, 2), (1, 2, 3)), given.get("at", (0, 0, 0)))
    assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


def test_on_a_curved_side_they_are_what_is_given():
    scene = dataclasses.replace(
        block(Load("body.x1", force=(1, 2, 3), moment=(4, 5, 6), at=(3, 1, 2))),
        support=(dataclasses.replace(CLAMPED, on="body.x0"),),
    )
    found = resultants(scene, sphere_cap(), (3, 1, 2))
    assert found == pytest.approx((1, 2, 3, 4, 5, 6), abs=1e-11)


def test_in_the_plane_a_moment_is_a_number_also_where_the_thickness_varies():
    load = Load("x1", force=(1, 2), moment=4, at=(3, -1))
    thickness = lambda x: 1 + 0.2 * x[1]  # noqa: E731
    scene = plate(load, kinematics="plane stress", thickness=thickness)
    found = resultants(scene, box_body((3, 4), (1, 2)), (3, -1))
    assert found == pytest.approx((1, 2, 4), abs=1e-11)


def test_an_axial_force_is_that_of_the_whole_turn():
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(Load("y1", force=(0, -50)),),
    )
    found = run(scene, body=box_body((3, 3), (1, 2))).quantities["reaction"]
    assert found[1] == pytest.approx(50, rel=1e-10)


def linear(*values):
    """A traction of these values at y = 0 and, per length, in y and z, written out."""
    return tuple(lambda x, v=value: v[0] + v[1] * x[1] + v[2] * x[2] for value in values)


def test_displacements_are_those_of_the_linear_traction_written_out():
    """The side is y in (0, 2), z in (0, 3): area 6, ∫ (y − 1)² = 2, ∫ (z − 1.5)² = 4.5."""
    moment, body = (6.5, 9.0, 4.0), box_body((2, 3, 3), (1, 2, 3))
    bx, by, bz = moment[0] / 6.5, moment[1] / 4.5, moment[2] / 2
    written = linear(
        (0.5 - by * 1.5 + bz * 1, -bz, by), (0.25 + bx * 1.5, 0, -bx), (-bx * 1, bx, 0)
    )
    point = (Point("end", (1, 2, 3)),)
    loads = Load("x1", force=(3, 1.5, 0), moment=moment), Load("x1", traction=written)
    found, expected = (
        Study(block(load, point=point), body=body).solve().quantities for load in loads
    )
    assert found["displacement_end"] == pytest.approx(expected["displacement_end"], rel=1e-10)
    assert found["strain_energy"] == pytest.approx(expected["strain_energy"], rel=1e-10)


def test_a_moment_bends_a_beam_as_the_formula_says():
    """With ν = 0 the solution is quadratic: w = M L²/2EI, θ = M L/EI, and the end stays free."""
    length, width, young, moment = 100.0, 10.0, 210e3, 1e4
    bending = young * width**4 / 12
    points = (Point("middle", (length, 5, 5)), Point("top", (length, 10, 5)))
    scene = Scene(
        kinematics="3D",
        material=Material(young, 0.0),
        support=(CLAMPED,),
        load=(Load("x1", moment=(0, 0, moment)),),
        point=points,
    )
    found = Study(scene, body=box_body((5, 1, 1), (length, width, width))).solve().quantities
    middle, top = (np.array(found[f"displacement_{name}"]) for name in ("middle", "top"))
    assert middle[1] == pytest.approx(moment * length**2 / (2 * bending), rel=1e-9)
    turned = (middle[0] - top[0]) / 5
    assert turned == pytest.approx(moment * length / bending, rel=1e-9)


def test_a_force_at_the_end_bends_a_beam_as_timoshenko_says():
    """P L³/3EI + 6 P L/5 G A, to a tenth of the part by shear."""
    length, width, young, force = 100.0, 10.0, 210e3, 1000.0
    scene = Scene(
        kinematics="3D",
        material=Material(young, 0.0),
        support=(CLAMPED,),
        load=(Load("x1", force=(0, force, 0)),),
        point=(Point("middle", (length, 5, 5)),),
    )
    found = Study(scene, body=box_body((20, 2, 2), (length, width, width))).solve().quantities
    by_shear = 6 * force * length / (5 * young / 2 * width**2)
    expected = 4 * force * length**3 / (young * width**4) + by_shear
    assert found["displacement_middle"][1] == pytest.approx(expected, abs=by_shear / 10)


def test_a_remote_force_is_a_force_with_its_moment():
    body, point = box_body((2, 2, 2), (1, 2, 3)), (Point("end", (1, 2, 3)),)
    remote = Load("x1", force=(1, 2, 3), at=(5, 1, 1.5))
    at_centre = Load("x1", force=(1, 2, 3), moment=tuple(np.cross((4, 0, 0), (1, 2, 3)).tolist()))
    found, expected = (
        Study(block(load, point=point), body=body).solve().quantities["displacement_end"]
        for load in (remote, at_centre)
    )
    assert found == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("axis", [1, 2])
def test_half_of_a_symmetric_model_is_half_of_it(axis):
    """The whole is 2 wide about the plane; a torque about the plane's normal is its own image."""
    size = [1.0, 2.0, 2.0]
    moment = np.zeros(3)
    moment[axis] = 3.0
    whole_load = Load("x1", force=(4, 0, 0), moment=tuple(moment.tolist()), at=(2, 1, 1))
    point = (Point("end", (1, 1, 1)),)
    whole = Study(block(whole_load, point=point), body=box_body((2, 4, 4), size)).solve()
    size[axis], cells = 1.0, [2, 4, 4]
    cells[axis] = 2
    side = f"{'xyz'[axis]}1"
    half_load = Load("x1", force=(2, 0, 0), moment=tuple((moment / 2).tolist()), at=(2, 1, 1))
    half_scene = block(half_load, point=point, symmetry=(side,))
    half = Study(half_scene, body=box_body(tuple(cells), tuple(size))).solve()
    found, expected = (one.quantities["displacement_end"] for one in (half, whole))
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)
    energies = [one.quantities["strain_energy"] for one in (half, whole)]
    assert 2 * energies[0] == pytest.approx(energies[1], rel=1e-9)


KEYS = [
    *(f"load.0.force.{axis}" for axis in range(3)),
    *(f"load.0.moment.{axis}" for axis in range(3)),
    *(f"load.0.at.{axis}" for axis in range(3)),
]


def test_derivatives_are_those_of_differences():
    load = Load("x1", force=(1, 2, 3), moment=(4, 5, 6), at=(2, -1, 1))
    scene = block(load, point=(Point("end", (1, 1, 1)),), contact=(Contact("z0"),))
    study = Study(scene, body=box_body((2, 2, 2), (1, 1, 1)))
    names = [f"displacement_end_{axis}" for axis in "xyz"]
    found = study.derivatives(names, KEYS)
    for key in KEYS:
        *_, name, axis = key.split(".")
        value = getattr(load, name)[int(axis)]
        low, high = (
            study.solve({key: value + change}).quantities["displacement_end"]
            for change in (-1e-3, 1e-3)
        )
        for number, quantity in enumerate(names):
            slope = (high[number] - low[number]) / 2e-3
            assert found[quantity][key] == pytest.approx(slope, rel=1e-4, abs=1e-9)


def test_a_moment_in_the_plane_has_a_derivative():
    scene = plate(Load("x1", moment=4), point=(Point("end", (1, 1)),))
    study = Study(scene, body=box_body((2, 2), (1, 1)))
    found = study.derivatives(["displacement_end_y"], ["load.0.moment"])["displacement_end_y"]
    value = study.solve().quantities["displacement_end"][1]
    assert found["load.0.moment"] == pytest.approx(value / 4, rel=1e-8)


TEXT = """
kinematics = "3D"
units = { length = "mm", force = "N" }
[mesh]
file = "slab.geo"
[material]
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[[load]]
on = "right"
force = ["1 kN", 0, 2]
moment = ["3 N m", 0, 0]
at = ["1 cm", 0, 0]
"""


def test_files_have_them_with_units():
    from pathlib import Path

    scene = scene_of_text(TEXT, Path("slab.toml"))
    (load,) = scene.load
    assert load.force == (1000, 0, 2) and load.moment == (3000, 0, 0) and load.at == (10, 0, 0)
    assert scene_of_text(scene_text(scene), Path("slab.toml")) == scene
    flat = TEXT.replace('"3D"', '"plane strain"').replace('["1 kN", 0, 2]', '["1 kN/mm", 0]')
    flat = flat.replace('["3 N m", 0, 0]', '"3 N m/mm"').replace('["1 cm", 0, 0]', '["1 cm", 0]')
    (load,) = scene_of_text(flat, Path("slab.toml")).load
    assert load.force == (1000, 0) and load.moment == 3000


def test_ranks_have_the_same():
    """Also where a rank has nothing of the surface."""
    load = Load("x1", force=(1, 2, 3), moment=(4, 5, 6), at=(10, -3, 2))
    point = (Point("end", (4, 1, 1)),)
    bodies = box_body((8, 2, 2), (4, 1, 1)), box_body((8, 2, 2), (4, 1, 1), comm=MPI.COMM_SELF)
    found, expected = (
        run(block(load, point=point), body.mesh.comm, body).quantities["displacement_end"]
        for body in bodies
    )
    assert found == pytest.approx(expected, rel=1e-9)


def test_loads_contradict_each_other_in_words():
    with refused("moment_alone_has_no_place", SceneError):
        Load("x1", moment=3, at=(0, 0))
    with refused("moment_alone_has_no_place", SceneError):
        Load("x1", at=(0, 0))
    with refused("load_gives_none", SceneError):
        Load("x1", force=(1, 0), pressure=3)
    with refused("moment_in_space_is_a_list", SceneError):
        block(Load("x1", moment=3))
    with refused("moment_in_the_plane_is_a_number", SceneError):
        plate(Load("x1", moment=(1, 2, 3)))
    with refused("force_has_two_entries", SceneError):
        block(Load("x1", force=(1, 2)))


@pytest.mark.parametrize(
    "given",
    [{"force": (1, 0)}, {"moment": 1}, {"force": (0, 1), "at": (0, 1)}],
)
def test_axisymmetric_models_take_axial_forces_alone(given):
    with refused("axisymmetric_takes_axial_forces", SceneError):
        Scene(
            kinematics="axisymmetric",
            material=Material(1000, 0.3),
            load=(Load("y1", **given),),
        )


def test_a_moment_about_a_line_is_refused():
    body = box_body((1, 2, 2), (1, 1e-6, 1))
    across = resultants(block(Load("x1", moment=(1, 2, 0))), body, (0, 0, 0))
    assert across == pytest.approx((0, 0, 0, 1, 2, 0), abs=1e-9)
    with refused("moment_about_a_line"):
        run(block(Load("x1", moment=(1, 0, 1))), MPI.COMM_SELF, body)


def test_moments_that_mirror_images_take_away_are_refused():
    body = box_body((2, 2, 2), comm=MPI.COMM_SELF)
    with refused("moment_across_a_plane_of_symmetry"):
        run(block(Load("x1", moment=(1, 2, 0)), symmetry=("y0",)), MPI.COMM_SELF, body)
    with refused("force_across_a_plane_of_symmetry"):
        load = Load("x1", force=(0, 1, 0), at=(3, 0, 0))
        run(block(load, symmetry=("y0",)), MPI.COMM_SELF, body)
    flat = box_body((2, 2), comm=MPI.COMM_SELF)
    with refused("moment_in_a_half_plane"):
        run(plate(Load("x1", moment=1), symmetry=("y0",)), MPI.COMM_SELF, flat)


def test_a_load_acts_on_a_boundary():
    with refused("force_on_a_part"):
        run(block(Load("body", force=(1, 0, 0))), MPI.COMM_SELF, box_body((1, 1, 1)))
