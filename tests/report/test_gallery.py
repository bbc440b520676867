"""Pictures show what the files say: looked at by their pixels, and once by a person."""

import dataclasses
import html
import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    Steps,
    Support,
)
from fenics_contact.report import report
from fenics_contact.report.bodies.picture import draw_body
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.film import FEWEST_STEPS
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.style import COLOURS, STYLE, neighbourhood
from fenics_contact.report.gallery import draw_pictures
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from tests.scenes import PULLED_BLOCK, ROOT, box_body, slab

pytestmark = pytest.mark.serial
LINE = {"contact_0.png", "deformed.png", "surface_displacement.png"}  # of a flat model
BELOW = {"stress_0.png"}  # and where something touches that is not given


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    draw_coarsely(monkeypatch)


def draw_coarsely(monkeypatch):
    """Fewer pixels."""
    monkeypatch.setitem(STYLE, "savefig.dpi", 80)


def write_run(scene, folder, body=None):
    prepared = Run(scene, MPI.COMM_SELF, body)
    files.write(prepared, prepared.solve(), folder)


def pixels(path):
    from matplotlib import image

    return image.imread(path)[..., :3]


def has_colour(picture, colour, tolerance=0.06):
    wanted = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return bool((np.abs(picture - wanted).max(axis=-1) < tolerance).any())


def is_picture(path):
    """Neither empty nor of one colour."""
    picture = pixels(path)
    shades = np.unique(np.round(picture.reshape(-1, 3) * 255).astype(int), axis=0)
    return np.ptp(picture) > 0.5 and len(shades) > 100


def drawn(scene, folder, body=None):
    """A run and its pictures; the names of their files, all of them pictures of something."""
    write_run(scene, folder, body)
    result = read_result(folder)
    pictures = draw_pictures(folder, result)
    assert all(is_picture(picture.path) for picture in pictures)
    assert all(picture.title and picture.caption.endswith(".") for picture in pictures)
    return {picture.path.name for picture in pictures}


def body_and_contact(scene, folder, body=None):
    """Of a run only the pictures of the body and of its first contact."""
    write_run(scene, folder, body)
    result = read_result(folder)
    table, contact = ContactTable.read(folder / "contact.csv"), result.contacts[0]
    rows, path = table.of(contact.name), folder / "contact_0.png"
    with style():
        draw_body(read_body(folder), result, table, folder / "deformed.png")
        if scene.kinematics == "3D":
            draw_maps(read_body(folder), rows, contact, path)
        else:
            draw_curves(read_body(folder), rows, contact, "xy", path)
    assert is_picture(path) and is_picture(folder / "deformed.png")


def pressed(obstacle, kinematics="plane strain", **contact):
    """A box on its side y0 (3D: z0), with an obstacle before the opposite one."""
    bottom, top, axis = ("z0", "z1", "z") if kinematics == "3D" else ("y0", "y1", "y")
    held = {"x": 0, "y": 0, "z": 0} if axis == "z" else {"x": 0, "y": 0}
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support(bottom, held),),
        symmetry=("x0",) if kinematics == "axisymmetric" else (),
        contact=(Contact(top, obstacle=obstacle, **contact),),
    )


def small_sphere(size=0.5, **contact):
    """A sphere on a half-space, on a mesh as coarse as can be."""
    cells = {"fine": 5, "size": size, "extent": 60, "cells_outside": 8}
    return Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"), cell="quadrilateral", parameters=cells
        ),
        material=Material(1000, 0.3),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=Obstacle("paraboloid", 8, indentation=1), **contact),),
    )


def test_report_draws_the_paper_figures(tmp_path):
    write_run(slab(300), tmp_path)
    names = {picture.path.name for picture in report.write_report(tmp_path)}
    assert names == {*LINE, "convergence.png"}
    for name in ("contact_0.png", "deformed.png"):
        picture = pixels(tmp_path / name)
        assert has_colour(picture, COLOURS["STICK"]), name
        assert has_colour(picture, COLOURS["SLIP"]), name
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    verdict = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["verdict"]
    assert verdict in html.unescape(page)
    assert "contact_0.png" in page and "deformed.png" in page


def test_where_nothing_slips_nothing_is_drawn_slipping(tmp_path):
    body_and_contact(slab(100), tmp_path)
    for name in ("contact_0.png", "deformed.png"):
        assert not has_colour(pixels(tmp_path / name), COLOURS["SLIP"]), name


def test_three_dimensions(tmp_path):
    names = drawn(PULLED_BLOCK, tmp_path, box_body((4, 4, 2), comm=MPI.COMM_SELF))
    assert names >= {"contact_0.png", "deformed.png"}
    assert (tmp_path / "contact_0.png").stat().st_size > 10_000


def test_small_contact_zone_is_seen_from_near_by(tmp_path):
    import pyvista

    from fenics_contact.report.bodies.view import choose_view

    assert drawn(small_sphere(), tmp_path) == {*LINE, *BELOW, "axis_stress.png"}
    for name in ("contact_0.png", "deformed.png"):
        picture = pixels(tmp_path / name)
        assert has_colour(picture, COLOURS["STICK"]), name
        assert has_colour(picture, COLOURS["OPEN"]), name
        assert not has_colour(picture, COLOURS["SLIP"]), name  # no friction: nothing to mark
    result = read_result(tmp_path)
    table = ContactTable.read(tmp_path / "contact.csv")
    body = pyvista.get_reader(str(tmp_path / "fields.pvd")).read().combine()
    view = choose_view(body, result, table)
    assert view.is_near and view.factor == 1
    # the zone, of radius 2.83, in the middle of a square of 2.5 times that, inside the body
    assert view.low == pytest.approx([0, -3.6, 0], abs=0.5)
    assert view.high == pytest.approx([5, 0, 0], abs=0.5)
    assert 10 < view.body.n_cells < body.n_cells / 2


def test_neighbourhood_of_a_contact_zone():
    points = np.array([[0.0, 0], [1, 0], [2, 0], [50, 0]])
    low, high = neighbourhood(points, np.array([True, True, True, False]))
    assert (low, high) == (pytest.approx([-1.5, -2.5]), pytest.approx([3.5, 2.5]))
    for nothing in (np.zeros(4, dtype=bool), np.array([True, False, False, False])):
        low, high = neighbourhood(points, nothing)
        assert low[0] < 0 and high[0] > 50


def test_without_contact_nothing_is_drawn_below_it(tmp_path):
    body = box_body((4, 2), (1, 1), comm=MPI.COMM_SELF)
    assert drawn(pressed(Obstacle(gap=0.1), "axisymmetric"), tmp_path, body) == LINE


def test_pressure_in_three_dimensions(tmp_path):
    obstacle = Obstacle("paraboloid", 1, position=(0.5, 0.5, 0.5), indentation=0.03)
    body = box_body((4, 4, 2), comm=MPI.COMM_SELF)
    names = drawn(pressed(obstacle, "3D"), tmp_path, body)
    assert names == {"contact_0.png", "deformed.png", "stress_0.png"}
    assert has_colour(pixels(tmp_path / "contact_0.png"), COLOURS["OPEN"])


def test_where_no_obstacle_stands_the_gap_is_infinite(tmp_path):
    obstacle = Obstacle("flat punch", 0.5, position=(0, 1), indentation=0.01)
    body = box_body((8, 4), (2, 1), comm=MPI.COMM_SELF)
    drawn(pressed(obstacle, "axisymmetric"), tmp_path, body)
    assert ",inf," in (tmp_path / "contact.csv").read_text()


@pytest.mark.parametrize("kinematics", ["plane strain", "3D"])
def test_run_without_any_contact(kinematics, tmp_path):
    flat = kinematics != "3D"
    body = box_body((4, 2) if flat else (2, 2, 2), (1, 1, 1), comm=MPI.COMM_SELF)
    body_and_contact(pressed(Obstacle(gap=0.1), kinematics), tmp_path, body)
    assert not has_colour(pixels(tmp_path / "contact_0.png"), COLOURS["STICK"])
    assert has_colour(pixels(tmp_path / "contact_0.png"), COLOURS["OPEN"])


@pytest.mark.filterwarnings("error:.*(identical low|divide by zero)")
@pytest.mark.parametrize("kinematics", ["plane strain", "3D"])
def test_friction_that_never_acts_is_drawn_without_complaint_and_not_as_a_film(
    kinematics, tmp_path
):
    flat = kinematics != "3D"
    body = box_body((4, 2) if flat else (2, 2, 2), (1, 1, 1), comm=MPI.COMM_SELF)
    scene = pressed(Obstacle(gap=0.1), kinematics, friction_coefficient=0.3)
    scene = dataclasses.replace(scene, steps=Steps(number=FEWEST_STEPS))
    files.solve_and_write(Run(scene, MPI.COMM_SELF, body), tmp_path)
    result = read_result(tmp_path)
    names = {picture.path.name for picture in draw_pictures(tmp_path, result)}
    assert "contact_0.png" in names
    assert not any(name.endswith(".gif") for name in names)


@pytest.mark.parametrize("kinematics", ["plane strain", "3D"])
def test_pressure_and_traction_where_bonded(kinematics, tmp_path):
    flat = kinematics != "3D"
    body = box_body((4, 2) if flat else (2, 2, 2), (1, 1, 1), comm=MPI.COMM_SELF)
    scene = pressed(Obstacle(indentation=0.01), kinematics, contact="bonded")
    body_and_contact(scene, tmp_path, body)
    height, width = pixels(tmp_path / "contact_0.png").shape[:2]
    assert (height > width / 1.3) if flat else (width > 2 * height)  # two panels


def test_fields_hold_what_the_result_says(tmp_path):
    import pyvista

    write_run(slab(300), tmp_path)
    body = pyvista.get_reader(str(tmp_path / "fields.pvd")).read().combine()
    assert set(body.point_data) >= {
        "displacement",
        "stress",
        "contact_pressure",
        "friction_traction",
        "status",
    }
    top = np.isclose(body.points[:, 1], 1)
    assert top.sum() == 33
    assert (body["contact_pressure"][top] == 300).all()
    assert (body["contact_pressure"][~top] == 0).all()
    assert sorted(body["status"][top]) == [1] * 26 + [2] * 7
    assert (body["status"][~top] == -1).all()
    stress = body["stress"].reshape(-1, 3, 3)
    # far from the sliding end: pressure above, no strain along x, so σ_x = −ν p
    left = body.points[:, 0] < 1
    assert stress[left, 1, 1] == pytest.approx(-300, abs=0.5)
    assert stress[left, 0, 0] == pytest.approx(-90, abs=0.5)
    assert np.abs(stress[:, 2, 2]).max() < 1e-9


def test_axisymmetric_stress_on_the_axis(tmp_path):
    """A cylinder pulled along its axis: σ_z = 10 everywhere, on the axis too."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(Load("y1", traction=(0, 10)),),
    )
    import pyvista

    write_run(scene, tmp_path, box_body((3, 3), (1, 2), comm=MPI.COMM_SELF))
    body = pyvista.get_reader(str(tmp_path / "fields.pvd")).read().combine()
    stress = body["stress"].reshape(-1, 3, 3)
    assert stress[:, 1, 1] == pytest.approx(10, rel=1e-6)
    assert np.abs(stress[:, 2, 2]).max() < 1e-4
