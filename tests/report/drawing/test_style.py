"""Pictures are legible in grey, are the same in every run, and need no display of the user's."""

import os
import subprocess
import sys

import numpy as np
import pytest

from fenics_contact.report.bodies.picture import draw_body
from fenics_contact.report.bodies.view import obstacle_surface
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.contacts.section_stress import section_at
from fenics_contact.report.drawing import picture
from fenics_contact.report.drawing.cells import cells_of
from fenics_contact.report.drawing.fields import flat_outline, joined
from fenics_contact.report.drawing.figures import new_figure, save
from fenics_contact.report.drawing.style import COLOURS, LINES, ends_of_colours
from fenics_contact.report.hysteresis import last_loop
from fenics_contact.results.contact_points import BODY_OF_CELLS, ContactTable, facet_flags
from tests.messages import refused
from tests.records import made_contact, made_run

pytestmark = pytest.mark.serial
CONTACT = made_contact(
    name="top", contact="unilateral", law="static", parameters={"friction_coefficient": 0.5}
)


def points(x, y=0.0, status=None, normal=(0.0, 1.0, 0.0)):
    """Rows of a contact whose pressure and friction fall with |x|."""
    numbers = {name: np.zeros(len(x)) for name in ("gap", "traction_y", "traction_z")}
    numbers |= {"x": x, "y": y + 0 * x, "z": 0 * x, "traction_x": 1 - np.abs(x)}
    numbers |= {f"n{axis}": n + 0 * x for axis, n in zip("xyz", normal, strict=True)}
    numbers |= {f"slip_{axis}": 0.1 * x for axis in "xyz"} | {"contact_pressure": 2 - 2 * abs(x)}
    if status is None:
        status = np.select([abs(x) < 0.3, abs(x) < 0.6], ["STICK", "SLIP"], "OPEN")
    return ContactTable(np.full(len(x), "top"), status, numbers)


def luminance_of_colours(path):
    """Of each status, where its colour is in a picture: the median of what a grey copy has."""
    from PIL import Image

    picture = Image.open(path).convert("RGB")
    grey, pixels = np.asarray(picture.convert("L")) / 255, np.asarray(picture)
    found = {}
    for status, colour in COLOURS.items():
        wanted = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        mine = (pixels == wanted).all(axis=2)
        assert mine.sum() > 200, status
        found[status] = float(np.median(grey[mine]))
    return found


@pytest.mark.pdf
def test_text_of_a_pdf_can_be_edited_and_searched(tmp_path):
    """With parts of TrueType fonts, as publishers want them, and no letters drawn as outlines."""
    figure, _ = new_figure("of $1", (2, 2))
    save(figure, tmp_path / "picture.png")
    written = (tmp_path / "picture.pdf").read_bytes()
    assert b"/FontFile2" in written and b"/Type3" not in written


@pytest.mark.pdf
@pytest.mark.parametrize("kind", ["line", "map"])
def test_status_is_told_apart_in_grey(kind, tmp_path):
    """By a fifth of the way from black to white at least."""
    path = tmp_path / "contact_0.png"
    if kind == "line":
        line = strip(lambda p: 0 * p, lambda x: 0 * x, 41)
        draw_curves(line, points(np.linspace(-1, 1, 41)), CONTACT, "xy", path)
    else:
        x, y = (grid.ravel() for grid in np.meshgrid(*2 * [np.linspace(-1, 1, 15)]))
        draw_maps(sheet(15), points(x, y, normal=(0, 0, 1)), CONTACT, path)
    grey = sorted(luminance_of_colours(path).values())
    assert np.diff(grey).min() >= 0.2
    assert path.with_suffix(".pdf").read_bytes().startswith(b"%PDF")


def test_curves_that_share_a_panel_differ_by_more_than_their_hue():
    assert len({str(dashes) for _, dashes in LINES}) == len(LINES)


@pytest.mark.pdf
def test_figures_are_the_same_in_every_run_and_leave_matplotlib_as_it_was(tmp_path):
    import matplotlib

    before = dict(matplotlib.rcParams), matplotlib.get_backend()
    written = []
    for name in ("a.png", "b.png"):
        figure, (panel,) = new_figure("Costs 5 $ or 6 $", (3, 2))
        panel.plot([1, 2], [3, 4], label=r"$\sigma_T$")
        panel.legend()
        save(figure, tmp_path / name)
        path = tmp_path / name
        written.append((path.read_bytes(), path.with_suffix(".pdf").read_bytes()))
    assert written[0] == written[1]
    assert (dict(matplotlib.rcParams), matplotlib.get_backend()) == before


def test_last_loop():
    """An ellipse after a first quarter: its area, whatever straight part is added, and its sign."""
    t = np.linspace(0, 4 * np.pi, 401)
    for stiffness in (0.0, 30.0):
        x = np.concatenate([np.linspace(0, 2, 20), 2 * np.cos(t)])
        y = np.concatenate([np.linspace(0, 0, 20), np.sin(t)]) + stiffness * x
        loop = last_loop(x, y)
        assert loop.work == pytest.approx(-2 * np.pi, rel=1e-3)
        assert last_loop(x, -y).work == -loop.work
        assert loop.is_thin == (stiffness > 0)
        if stiffness:
            assert loop.compliance == pytest.approx(1 / stiffness, rel=0.01)
        assert (loop.first, loop.last) == (220, 420)  # the second of the two
    assert last_loop(np.linspace(0, 1, 9), np.linspace(0, 1, 9)) is None
    there_and_back = np.array([0, 1, 2, 1, 0.5])
    assert last_loop(there_and_back, there_and_back) is None


def with_facets(body, axis):
    """The body, with what files say of its cells: facets at 0 along an axis are the contact's."""
    cell, cells = cells_of(body)
    at = np.asarray(body.points)[:, axis] == 0
    facets = [list(facet) for facet in cell.facets]
    flags = sum(at[cells[:, one]].all(axis=1) << number for number, one in enumerate(facets))
    body.cell_data[facet_flags("top")] = flags.astype(np.uint8)
    body.cell_data[BODY_OF_CELLS] = np.zeros(body.n_cells, dtype=np.int16)
    return body


def strip(displacement, status, number=11):
    """A flat body of one row of cells with a contact above."""
    import pyvista

    x, y = np.meshgrid(np.linspace(-1, 1, number), [-1.0, 0.0], indexing="ij")
    sheet = [values[:, :, None] for values in (x, y, 0 * x)]
    body = pyvista.StructuredGrid(*sheet).cast_to_unstructured_grid()
    above = np.asarray(body.points)[:, 1] == 0
    body["displacement"] = displacement(np.asarray(body.points))
    body["status"] = np.where(above, status(np.asarray(body.points)[:, 0]), -1.0)
    return with_facets(body, 1)


def sheet(number):
    """A body in space of one layer of cells with a contact above, at z = 0."""
    import pyvista

    along = np.linspace(-1, 1, number)
    corners = np.meshgrid(along, along, [-1.0, 0.0], indexing="ij")
    body = pyvista.StructuredGrid(*corners).cast_to_unstructured_grid()
    body["status"] = np.where(np.asarray(body.points)[:, 2] == 0, 0.0, -1.0)
    return with_facets(body, 2)


def test_obstacle_is_where_the_gap_says_at_all_times():
    """A parabola that has sunk in by .3, and by .2 before; gaps are magnified as well."""
    x = np.linspace(-1, 1, 11)
    body = strip(lambda p: 0 * p + [0.5, -0.1, 0], lambda x: np.where(abs(x) < 0.1, 1.0, 0.0))
    rows = points(x)
    rows.numbers["gap"][:] = x**2 - 0.3 + 0.1  # u_n = −.1
    obstacle = obstacle_surface(body, rows, CONTACT)
    for factor in (1, 10):
        expected = np.stack([x, factor * (x**2 - 0.3), 0 * x], axis=1)
        assert obstacle.at(factor) == pytest.approx(expected)
    before = strip(
        lambda p: np.stack([0 * p[:, 0], p[:, 0] ** 2 - 0.2, 0 * p[:, 0]], axis=1),
        lambda x: np.where(abs(x) < 0.5, 2.0, 0.0),
    )
    assert obstacle.then(before).at(1)[:, 1] == pytest.approx(x**2 - 0.2)
    apart = strip(lambda p: 0 * p, lambda x: 0 * x)
    assert obstacle.then(apart) is None
    foundation = made_contact(name="top", contact="winkler", law="static")
    assert obstacle_surface(body, rows, foundation) is None


@pytest.mark.parametrize("count", [0, 1])
def test_points_are_told_of_where_there_are_contacts(count, tmp_path):
    body = strip(lambda p: 0 * p, lambda x: 0 * x)
    body["von Mises stress"] = np.asarray(body.points)[:, 0]
    result = made_run({"contacts": count * [dict(CONTACT)]})
    drawn = draw_body(body, result, points(np.linspace(-1, 1, 11)), tmp_path / "deformed.png")
    assert ("Points: " in drawn.caption) == (count > 0)


def test_pieces_of_two_ranks_are_one_body_and_two_bodies_stay_two():
    """Nodes at the same place are one where they are of one body."""
    left = strip(lambda p: 0.1 * p, lambda x: 0 * x)
    pieces = [left, left.copy()]
    pieces[1].points[:, 0] += 2 * (1 + 1e-15)
    pieces[1]["displacement"] = 0.1 * np.asarray(pieces[1].points)
    body = pieces[0].merge(pieces[1], merge_points=False)
    assert body.n_points == 44 and len(flat_outline(body)) == 2
    one = joined(body)
    assert one.n_points == 42 and len(flat_outline(one)) == 1
    assert one["displacement"] == pytest.approx(0.1 * np.asarray(one.points))
    body.cell_data[BODY_OF_CELLS][10:] = 1
    assert joined(body).n_points == 44


def test_cut_through_half_a_zone_in_space():
    """It lies just inside the plane of symmetry, along the friction; σ_xz = τ is its shear."""
    import pyvista

    ends = ((-1, 1), (0, 1), (-1, 0))
    corners = np.meshgrid(*(np.linspace(*two, 9) for two in ends), indexing="ij")
    body = pyvista.StructuredGrid(*corners).cast_to_unstructured_grid()
    x, _, z = np.asarray(body.points).T
    shear = 1 - (x - 0.25) ** 2 - (z + 0.5) ** 2
    stress = np.zeros((len(x), 9))
    stress[:, 2] = stress[:, 6] = shear
    body["stress"] = stress
    body["status"] = np.where(z == 0, 0.0, -1.0)
    with_facets(body, 2)
    across, along = (g.ravel() for g in np.meshgrid(np.linspace(-1, 1, 17), np.linspace(0, 1, 9)))
    status = np.where(np.hypot(across, along) < 0.5, "STICK", "OPEN")
    section = section_at(body, points(across, along, status, (0, 0, 1)), CONTACT, flat=False)
    assert section.axes == (0, 2) and 0 < section.across < 0.01
    value, place = section.peak
    assert value == pytest.approx(1) and place == pytest.approx([0.25, -0.5])
    assert section.high - section.low == pytest.approx([2, 1], abs=0.3)


def test_without_anything_to_draw_on_there_is_one_sentence(monkeypatch):
    monkeypatch.setattr(picture, "_draws_by_egl", lambda: False)
    monkeypatch.setenv("DISPLAY", ":7777")  # nobody is there
    monkeypatch.setenv("PATH", "/nowhere")
    with (
        refused("pictures_need_a_display"),
        picture.display(),
    ):
        raise AssertionError
    assert os.environ["DISPLAY"] == ":7777"


@pytest.mark.parametrize("name", [None, ":7777"])
def test_a_body_is_drawn_without_a_display_and_beside_one_that_is_dead(name):
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    environment |= {"DISPLAY": name} if name else {}
    drawing = (
        "from fenics_contact.report.drawing.picture import display\n"
        "with display():\n"
        "    import pyvista\n"
        "    plotter = pyvista.Plotter(off_screen=True, window_size=(60, 60))\n"
        "    plotter.add_mesh(pyvista.Cube())\n"
        "    print(plotter.screenshot(return_img=True).std() > 1)\n"
        "    plotter.close()\n"  # before its display goes
    )
    done = subprocess.run(
        [sys.executable, "-c", drawing],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0 and done.stdout.strip() == "True", done.stderr


@pytest.mark.parametrize(
    ("given", "ends"),
    [
        ((2.0, 5.0), (2.0, 5.0)),
        ((10.0 - 1e-11, 10.0 + 1e-11), (0.0, 10.0 + 1e-11)),
        ((-3.0, -3.0), (-3.0, 0.0)),
        ((0.0, 0.0), (0.0, 1.0)),
    ],
)
def test_colours_do_not_show_round_off(given, ends):
    assert ends_of_colours(*given) == ends
