"""What follows the slider of a report: numbers are those of the files, in their places."""

import base64
import gzip
import json
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.report.contacts.moving import moving_curves, moving_maps
from fenics_contact.report.drawing.fields import read_series, times_of_fields
from fenics_contact.report.drawing.figures import new_figure, save, style
from fenics_contact.report.drawing.picture import Picture, frame_of, numbers, save_frame
from fenics_contact.report.load_steps import draw_history
from fenics_contact.report.page.view_page import ContactSteps, followers, slider_html
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from tests.report.test_gallery import coarse  # noqa: F401
from tests.scenes import box_body
from tests.simulation.output.test_run_folder import block, cycled

pytestmark = pytest.mark.serial
KINDS = {"STICK": 0, "SLIP": 1, "OPEN": 2}


def solved(scene, folder, body):
    files.solve_and_write(Run(scene, MPI.COMM_SELF, body), folder)
    return folder


def moving(folder):
    """The first contact in all load steps, and the bodies with their fields."""
    bodies = [body for _, body in read_series(folder, range(len(times_of_fields(folder))))]
    result, table = read_result(folder), ContactTable.read(folder / "contact.csv")
    steps = ContactSteps(result, table)
    assert len(list(steps.watched((1.0, body) for body in bodies[:-1]))) == len(bodies) - 1
    return steps.contacts(bodies[-1])[0], bodies, result


def on_top(body, axis):
    """Numbers of the nodes of the contact, along x."""
    (top,) = np.nonzero(np.isclose(body.points[:, axis], body.points[:, axis].max()))
    return top[np.lexsort(body.points[top].T[::-1])]


@pytest.fixture(scope="module")
def flat(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flat") / "run"
    return solved(cycled(8), folder, block(MPI.COMM_SELF))


def test_curves_of_every_step_are_those_of_the_fields(flat, tmp_path):
    contact, bodies, _ = moving(flat)
    with style():
        frame, panels = moving_curves(contact, "xy", tmp_path / "frame.png")
    (pressure,), (traction,), *_, (strip,) = panels
    assert len(frame.panels) == len(panels) and (tmp_path / "frame.png").exists()
    for step, body in enumerate(bodies):
        top = on_top(body, 1)
        assert pressure["x"] == pytest.approx(body.points[top, 0], rel=1e-5, abs=1e-9)
        assert pressure["y"][step] == pytest.approx(body["contact_pressure"][top], rel=1e-3)
        friction = body["friction_traction"][top, 0]
        assert traction["y"][step] == pytest.approx(friction, rel=1e-3, abs=1e-3)
        names = np.array(["OPEN", "STICK", "SLIP"])[body["status"][top].astype(int)]
        assert pressure["kinds"][step] == [KINDS[name] for name in names]
        assert strip["runs"][step][0][0] == 0 and strip["runs"][step][-1][1] == 2
    bounds = [side for step in traction["bounds"] for side in step]
    assert len(bounds) >= len(bodies) - 1  # nothing rubs before it is moved


def test_gap_and_slip_are_in_the_fields(flat):
    """Of a flat obstacle at depth d, moved along by U: d + gap = −u_y, and slip = u_x − U."""
    _, bodies, result = moving(flat)
    for body, step in zip(bodies, result.steps, strict=True):
        top, found = on_top(body, 1), step.contacts[0].quantities
        u, depth = body["displacement"][top], found["indentation"]
        assert body["gap"][top] == pytest.approx(-depth - u[:, 1], abs=1e-9)
        moved = found["obstacle_displacement"][0]
        assert body["slip"][top, 0] == pytest.approx(u[:, 0] - moved, abs=1e-9)
        off = np.setdiff1d(np.arange(body.n_points), top)
        assert not body["gap"][off].any() and not body["slip"][off].any()


def test_the_last_step_is_that_of_contact_csv(flat, tmp_path):
    contact, *_ = moving(flat)
    with style():
        _, panels = moving_curves(contact, "xy", tmp_path / "frame.png")
    table = ContactTable.read(flat / "contact.csv")
    for (layer,), column in zip(panels, ("contact_pressure", "traction_x"), strict=False):
        found = dict(zip(layer["x"], layer["y"][-1], strict=True))
        written = dict(zip(table.numbers["x"], table.numbers[column], strict=True))
        assert {x: pytest.approx(written[x], rel=1e-3, abs=1e-6) for x in found} == found


def test_maps_of_every_step_are_those_of_the_fields(tmp_path):
    body = box_body((3, 2, 1), (2, 1, 0.5), comm=MPI.COMM_SELF)
    contact, bodies, _ = moving(solved(cycled(4, "3D"), tmp_path / "run", body))
    with style():
        frame, panels = moving_maps(contact, tmp_path / "frame.png")
    assert len(frame.panels) == 3
    marks, slips = panels[0]
    places = np.column_stack([marks["x"], marks["y"]])
    for (colours, *_), name in zip(
        panels[1:], ("contact_pressure", "friction_traction"), strict=True
    ):
        seen = []
        for step, body in enumerate(bodies):
            top = on_top(body, 2)
            nodes = [top[np.hypot(*(body.points[top, :2] - p).T).argmin()] for p in places]
            values = body[name][nodes]
            values = np.linalg.norm(values, axis=1) if values.ndim > 1 else values
            assert colours["values"][step] == pytest.approx(values, rel=1e-3, abs=1e-3)
            seen += values.tolist()
        assert colours["high"] == pytest.approx(max(seen))
        assert max(colours["triangles"]) < len(places)
        corners = np.reshape(colours["corners"], (-1, 2))
        assert corners == pytest.approx(places[colours["triangles"]], rel=1e-4)
    assert any(slips["at"])


def test_what_is_over_the_load_steps_is_marked(flat):
    """All pictures over the load steps, and of contacts, follow; others say that they do not."""
    contact, _, result = moving(flat)
    others = [Picture(flat / name, "", "") for name in ("deformed.png", "animation_0.gif")]
    times = [step.load_factor for step in result.steps]
    with style():
        pictures = [*draw_history(flat, result), Picture(flat / "contact_0.png", "", ""), *others]
        found = followers([contact], "xy", pictures, times, result)
    text = slider_html(times, found)
    (packed,) = re.findall(r'id="steps-data">([^<]*)<', text)
    assert json.loads(gzip.decompress(base64.b64decode(packed))) == found
    by_file = {one["file"]: one for one in found["pictures"]}
    assert set(by_file) == {
        *("contact_0.png", "history_loops.png", "history_forces.png"),
        *("history_areas.png", "history_energy.png"),
    }
    assert found["ofTheEnd"] == ["deformed.png"]
    for panel in by_file["history_forces.png"]["panels"]:
        (layer,) = panel["layers"]
        assert layer["type"] == "time" and layer["x"] == pytest.approx(times)
        low, high = panel["x"]
        assert low <= min(times) and max(times) <= high
    force = [step.quantities["friction_force"][0] for step in result.steps]
    dots = [panel["layers"][0] for panel in by_file["history_loops.png"]["panels"]]
    assert any(dot["y"] == pytest.approx(force, rel=1e-4, abs=1e-6) for dot in dots)
    assert all(dot["type"] == "dot" and len(dot["x"]) == len(times) for dot in dots)


def test_one_step_has_no_slider():
    assert slider_html([1.0]) == ""


@pytest.mark.parametrize("tight", [False, True])
@pytest.mark.parametrize("kind", ["frame", "still"])
def test_panels_are_where_they_are_drawn(tight, kind, tmp_path):
    """A red dot in the picture is where the panel's numbers say."""
    from matplotlib import image

    figure, panels = new_figure("A title", (4, 3), ncols=2)
    for panel, x in zip(panels, (2.0, 5.0), strict=True):
        panel.plot([0, 10], [-1, 3], alpha=0)
        panel.plot([x], [1.5], "o", color="red", markersize=9)
        panel.set_ylabel("numbers")
    if tight:
        panels[0].set_aspect("equal")
    path = tmp_path / "picture.png"
    if kind == "frame":
        found = save_frame(figure, panels, path, tight)
    elif tight:
        return  # stills over the load steps are not cut
    else:
        save(figure, path)
        found = frame_of(figure, panels)
    picture = image.imread(path)
    height, width = picture.shape[:2]
    red = (picture[..., 0] > 0.8) & (picture[..., 1:3] < 0.2).all(axis=-1)
    for panel, x in zip(found.panels, (2.0, 5.0), strict=True):
        left, top, across, up = panel.box
        column = width * (left + across * (x - panel.x[0]) / (panel.x[1] - panel.x[0]))
        row = height * (top + up * (panel.y[1] - 1.5) / (panel.y[1] - panel.y[0]))
        rows, columns = np.nonzero(red[:, int(width * left) : int(width * (left + across))])
        assert columns.mean() + int(width * left) + 0.5 == pytest.approx(column, abs=1.5)
        assert rows.mean() + 0.5 == pytest.approx(row, abs=1.5)


def test_numbers_for_pages():
    assert numbers(np.array([1.23456, np.nan, -1e-20, np.inf, 0.0])) == [
        *(1.235, None, -1e-20, None, 0.0)
    ]
