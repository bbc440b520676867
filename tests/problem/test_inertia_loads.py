"""Accelerations and rotations of bodies: weights, rotors, a press fit that speed lifts off."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Motion,
    Point,
    Scene,
    Study,
    Support,
    run,
)
from fenics_contact.analyses.derivatives.means import driven
from fenics_contact.common.errors import SceneError
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.writing import scene_text
from fenics_contact.verification.boxes import Box, boxes, quarter_rings
from tests.messages import refused
from tests.scenes import box_body

YOUNG, RATIO, DENSITY = 210e3, 0.3, 7.85e-9
RPM = 2 * np.pi / 60
MODELS = ["plane strain", "plane stress", "axisymmetric", "3D"]


def held(kinematics, load, **more):
    """A box that its side at y = 0 holds, of density 0.5."""
    axes = {axis: 0 for axis in ("xyz" if kinematics == "3D" else "xy")}
    return Scene(
        kinematics=kinematics,
        material=more.pop("material", Material(1000, 0.3, density=0.5)),
        support=(Support("y0", axes),),
        load=(Load("body", **load),),
        **more,
    )


def box(kinematics, comm=MPI.COMM_WORLD):
    return (
        box_body((2, 3, 2), (1, 2, 3), comm=comm)
        if kinematics == "3D"
        else box_body((2, 3), (1, 2), comm=comm)
    )


@pytest.mark.parametrize("kinematics", MODELS)
def test_a_weight_is_that_of_the_volume(kinematics):
    thickness = {"thickness": 3.0} if kinematics == "plane stress" else {}
    gravity = (0, -9.81) if kinematics != "3D" else (0, -9.81, 0)
    found = run(held(kinematics, {"acceleration": gravity}, **thickness), body=box(kinematics))
    volume = {"plane strain": 2, "plane stress": 6, "axisymmetric": 2 * np.pi, "3D": 6}[kinematics]
    assert found.quantities["reaction"][1] == pytest.approx(0.5 * 9.81 * volume, rel=1e-10)


def given(scene, body):
    """Nodal forces of the only load, by masses and by its form."""
    problem = Problem.on_mesh(scene, body)
    acting = problem.loads[0].acting
    by_form = problem.spaces.assemble(problem.loads[0].form)
    assert acting.nodal() == pytest.approx(by_form, abs=1e-12 * np.abs(by_form).max())
    return by_form


@pytest.mark.parametrize("axis", [(0, 0, 2), (1, -2, 0.5)])
def test_a_rotation_is_the_body_force_written_out(axis):
    at, speed = (3, 1, -1), 3.0
    along = np.array(axis) / np.linalg.norm(axis)
    projection = np.eye(3) - np.outer(along, along)
    parts = tuple(
        lambda x, row=row: 0.5 * speed**2 * row @ (x - np.array(at)[:, None]) for row in projection
    )
    rotation = {"speed": speed, "axis": axis, "at": at}
    loads = {"rotation": rotation}, {"body_force": parts}
    found, expected = (given(held("3D", load), box("3D")) for load in loads)
    assert found == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("varies", [False, True])
def test_densities_may_differ_and_vary(varies):
    parts = [Box("a", (0, 0), (1, 1), (2, 2)), Box("b", (1, 0), (3, 1), (4, 2))]
    body = boxes(parts, welded=[("a", "b")])
    first = (lambda x: 1 + x[1]) if varies else 1.5
    scene = Scene(
        kinematics="plane strain",
        material=(
            Material(1000, 0.3, on="a", density=first),
            Material(1000, 0.3, on="b", density=4.0),
        ),
        support=(Support("a.x0", {"x": 0, "y": 0}),),
        load=(Load("a", acceleration=(0, -2)), Load("b", acceleration=(0, -3))),
    )
    found = run(scene, body=body).quantities["reaction"]
    assert found[1] == pytest.approx(1.5 * 2 + 8 * 3, rel=1e-10)


def quarter(kinematics, inner, outer, load, cells=12, **more):
    """A quarter of a ring about z that its planes of symmetry hold."""
    body = quarter_rings([Box("ring", (inner, 0), (outer, 1), (cells, cells))])
    scene = Scene(
        kinematics=kinematics,
        material=Material(YOUNG, RATIO, density=DENSITY),
        symmetry=("ring.y0", "ring.y1"),
        load=(Load("ring", **load),),
        **more,
    )
    return Study(scene, body=body)


def test_the_bore_of_a_ring_has_its_hoop_stress():
    """11.966 MPa at 10,000 rpm: E u/b in plane stress, where no pressure acts."""
    points = (Point("bore", (20, 0)),)
    rotation = {"speed": 10_000 * RPM}
    study = quarter("plane stress", 20, 40, {"rotation": rotation}, point=points)
    found = study.solve().quantities["displacement_bore"][0]
    assert YOUNG * found / 20 == pytest.approx(11.966, rel=2e-4)


def rotor(load, contact=(), inner=0, **more):
    """A thin disc of 40, or what is left of it, in an axisymmetric model."""
    parts = [Box("shaft", (inner, 0), (20, 1), (10, 1)), Box("hub", (20, 0), (40, 1), (10, 1))]
    body = boxes(parts, welded=() if contact else [("shaft", "hub")])
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(YOUNG, RATIO, density=DENSITY),
        support=tuple(Support(f"{part.name}.y0", {"y": 0}) for part in parts),
        load=tuple(Load(part.name, rotation=load) for part in parts),
        contact=contact,
        **more,
    )
    return scene, body


def test_the_centre_of_a_disc_has_its_stress():
    """5.6816 MPa: E A/(1 − ν) of u = A r − B r³."""
    radii = (5.0, 10.0)
    points = tuple(Point(f"at{radius:g}", (radius, 0)) for radius in radii)
    scene, body = rotor({"speed": 10_000 * RPM, "axis": (0, 1)}, point=points)
    found = Study(scene, body=body).solve().quantities
    one, other = (found[f"displacement_at{radius:g}"][0] / radius for radius in radii)
    linear = (one * radii[1] ** 2 - other * radii[0] ** 2) / (radii[1] ** 2 - radii[0] ** 2)
    assert YOUNG * linear / (1 - RATIO) == pytest.approx(5.6816, rel=1e-3)


@pytest.mark.parametrize(("speed", "expected"), [(0, 9.45), (10_000, 5.1888)])
def test_a_press_fit_loosens_with_speed(speed, expected):
    contact = (Contact("shaft.x1", against="hub.x0", interference=0.0024),)
    scene, body = rotor({"speed": speed * RPM, "axis": (0, 1)}, contact)
    found = run(scene, body=body).quantities
    pressure = found["pressure_integral"] / (2 * np.pi * 20)
    assert pressure == pytest.approx(expected, rel=2e-3)


def test_a_press_fit_lifts_off_at_its_speed():
    """At 14,892 rpm to 1 %."""
    contact = (Contact("shaft.x1", against="hub.x0", interference=0.0024),)
    forces = []
    for speed in (0.99 * 14_892, 1.01 * 14_892):
        scene, body = rotor({"speed": speed * RPM, "axis": (0, 1)}, contact)
        forces.append(run(scene, body=body).quantities["pressure_integral"])
    assert forces[0] > 0.01 * 9.45 * 2 * np.pi * 20 and forces[1] == pytest.approx(0, abs=1e-6)


KEYS = [
    *(f"load.0.rotation.axis.{axis}" for axis in range(3)),
    *(f"load.0.rotation.at.{axis}" for axis in range(3)),
    "load.0.rotation.speed",
    *(f"load.1.acceleration.{axis}" for axis in range(3)),
    "material.density",
]


def test_derivatives_are_those_of_differences():
    rotation = {"speed": 2.0, "axis": (1, -2, 0.5), "at": (0.3, 1, 2)}
    scene = held("3D", {"rotation": rotation}, point=(Point("end", (1, 2, 3)),))
    second = Load("body", acceleration=(1, 2, 3))
    scene = dataclasses.replace(scene, load=(*scene.load, second))
    study = Study(scene, body=box("3D"))
    names = [f"displacement_end_{axis}" for axis in "xyz"]
    found = study.derivatives(names, KEYS)
    values = [*rotation["axis"], *rotation["at"], rotation["speed"], 1, 2, 3, 0.5]
    for key, value in zip(KEYS, values, strict=True):
        low, high = (
            study.solve({key: value + change}).quantities["displacement_end"]
            for change in (-1e-3, 1e-3)
        )
        for number, name in enumerate(names):
            slope = (high[number] - low[number]) / 2e-3
            assert found[name][key] == pytest.approx(slope, rel=1e-4, abs=1e-8)


def test_a_study_follows_densities_of_a_body_that_it_keeps():
    study = Study(held("plane strain", {"acceleration": (0, -2)}), body=box("plane strain"))
    for density in (0.5, 2.0, 0.5):
        found = study.solve({"material.density": density}).quantities["reaction"]
        assert found[1] == pytest.approx(density * 2 * 2, rel=1e-9)


def test_a_multiple_of_all_loads_is_one_of_forces():
    scene = held("plane strain", {"rotation": {"speed": 2.0}})
    found, whole = (
        Study(one, body=box("plane strain")).solve().quantities["reaction"]
        for one in (driven(scene, 0.5), scene)
    )
    assert found == pytest.approx([part / 2 for part in whole], rel=1e-9)


def test_bodies_that_move_are_pulled_by_it():
    """As by the body force written out, also where contacts have no mass."""
    loads = {"acceleration": (0, -2.0)}, {"body_force": (0, -1.0)}
    path = {"time": [0], "factor": [1]}
    motion = Motion(end=0.2, step=0.02)
    found = []
    for load in loads:
        scene = dataclasses.replace(
            held("plane strain", {**load, "path": path}, motion=motion),
            support=(Support("x0", {"x": 0}),),
            contact=(Contact("y0"),),
            point=(Point("end", (1, 2)),),
        )
        found.append(run(scene, body=box("plane strain")).quantities["displacement_end"])
    assert found[0] == pytest.approx(found[1], rel=1e-9) and found[0][1] < 0


TEXT = """
kinematics = "3D"
units = { length = "mm", force = "N" }
[mesh]
file = "slab.geo"
[material]
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
density = "7850 kg/m³"
[[load]]
on = "slab"
acceleration = [0, 0, "-9.81 m/s²"]
[[load]]
on = "slab"
rotation = { axis = [0, 0, 1], at = ["1 cm", 0, 0], speed = "10000 rpm" }
"""


def test_files_have_them_with_units():
    scene = scene_of_text(TEXT, Path("slab.toml"))
    weight, rotation = scene.load
    assert weight.acceleration == pytest.approx((0, 0, -9810))
    assert rotation.rotation.speed == pytest.approx(10_000 * RPM)
    assert rotation.rotation.at == (10, 0, 0)
    assert scene_of_text(scene_text(scene), Path("slab.toml")) == scene


def test_ranks_have_the_same():
    rotation = {"speed": 2.0, "axis": (1, -2, 0.5), "at": (0.3, 1, 2)}
    scene = held("3D", {"rotation": rotation}, point=(Point("end", (1, 2, 3)),))
    found, expected = (
        run(scene, comm, box("3D", comm)).quantities["displacement_end"]
        for comm in (MPI.COMM_WORLD, MPI.COMM_SELF)
    )
    assert found == pytest.approx(expected, rel=1e-9)


def test_what_has_no_density_cannot_be_heavy():
    bare = Material(1000, 0.3)
    with refused("weight_without_density"):
        run(held("plane strain", {"acceleration": (0, -2)}, material=bare), body=box("plane"))
    with refused("weight_of_a_boundary"):
        scene = held("plane strain", {"acceleration": (0, -2)})
        load = dataclasses.replace(scene.load[0], on="x1")
        run(dataclasses.replace(scene, load=(load,)), body=box("plane"))


def test_axes_that_a_model_has_not_are_refused():
    with refused("rotation_without_axis", SceneError):
        held("3D", {"rotation": {"speed": 1}})
    with refused("rotation_about_nothing", SceneError):
        held("3D", {"rotation": {"speed": 1, "axis": (0, 0, 0)}})
    with refused("rotation_in_a_plane_model", SceneError):
        held("plane stress", {"rotation": {"speed": 1, "axis": (0, 1)}})
    with refused("rotation_of_an_axisymmetric_model", SceneError):
        held("axisymmetric", {"rotation": {"speed": 1, "axis": (1, 0)}})
    with refused("weight_across_an_axis", SceneError):
        held("axisymmetric", {"acceleration": (1, 0)})
    with refused("rotation_of_three_entries", SceneError):
        held("plane stress", {"rotation": {"speed": 1, "at": (0, 1, 0)}})
