"""Pictures of two bodies that touch: nodes of both may lie at the same place."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Scene, Support
from fenics_contact.report.bodies.space import seen_points
from fenics_contact.report.bodies.view import choose_view
from fenics_contact.report.contacts.depth_curves import AxisStress, SurfaceDisplacement
from fenics_contact.report.drawing.fields import body_of_nodes, read_body
from fenics_contact.report.drawing.figures import surface_of
from fenics_contact.report.drawing.style import COLOURS
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.verification.boxes import Box, boxes
from tests.report.test_gallery import BELOW, LINE, coarse, drawn, has_colour, pixels, write_run  # noqa: F401

pytestmark = pytest.mark.serial


def squares(gap=0.0, cells=(4, 4)):
    """One above the other, with meshes that match so that nodes coincide."""
    parts = [Box("upper", (0, gap), (1, 1 + gap), cells), Box("lower", (0, -1), (1, 0), cells)]
    return boxes(parts, comm=MPI.COMM_SELF)


def pressed(kinematics="plane strain", down=0.01, aside=0.0, **contact):
    """The upper one is moved down and to the right by its top, without friction by default."""
    symmetry = ("upper.x0", "lower.x0") if kinematics == "axisymmetric" else ()
    across = {} if symmetry else {"x": 0}
    return Scene(
        kinematics=kinematics,
        symmetry=symmetry,
        material=(Material(1000, 0.3, on="upper"), Material(250, 0.1, on="lower")),
        support=(
            Support("lower.y0", {"y": 0, **across}),
            Support("upper.y1", {"y": -down, **({} if symmetry else {"x": aside})}),
        ),
        contact=(Contact("upper.y0", against="lower.y1", **contact),),
    )


def files_of(folder):
    """The body, the contact points and the result of a run."""
    result = read_result(folder)
    return read_body(folder), ContactTable.read(folder / "contact.csv"), result


def test_displacement_is_that_of_the_slave_where_nodes_coincide(tmp_path):
    assert drawn(pressed(aside=0.2), tmp_path, squares()) == {*LINE, *BELOW}
    body, table, result = files_of(tmp_path)
    found = SurfaceDisplacement.of(body, table, result.contacts[0])
    assert len(found.tangential) == 9
    assert found.tangential == pytest.approx(0.2, abs=0.02)  # the lower one stays
    assert surface_of(result.contacts[0]) == "'upper.y0' against 'lower.y1'"


@pytest.mark.parametrize("slave", ["on", "against"])
def test_stress_on_the_axis_is_that_of_the_slave(slave, tmp_path):
    scene = pressed("axisymmetric", slave=slave)
    if slave == "on":
        assert drawn(scene, tmp_path, squares()) == {*LINE, *BELOW, "axis_stress.png"}
    else:
        write_run(scene, tmp_path, squares())
    body, table, _ = files_of(tmp_path)
    stress = AxisStress.of(body, table)
    points = np.asarray(body.points)
    inside = points[:, 1] > 1e-9 if slave == "on" else points[:, 1] < -1e-9
    mine = (points[:, 0] < 1e-9) & inside
    expected = np.asarray(body["stress"]).reshape(-1, 3, 3)[mine]
    heights = np.abs(points[mine, 1])
    assert stress.depth == pytest.approx([0, *np.sort(heights)], abs=1e-12)
    assert stress.axial[1:] == pytest.approx(expected[np.argsort(heights), 1, 1])


def test_gaps_that_closed_are_not_torn_open_by_magnification(tmp_path):
    """Where bodies touch from the start, displacements may be magnified; else not."""
    factors = []
    for gap in (0.0, 0.01):
        folder = tmp_path / str(gap)
        write_run(pressed(down=0.005 + gap), folder, squares(gap))
        body, table, result = files_of(folder)
        assert result.contacts[0]["quantities"]["closed_gap"] == pytest.approx(gap)
        body["von Mises stress"] = np.zeros(body.n_points)
        factors.append(choose_view(body, result, table).factor)
    assert factors[0] >= 10 and factors[1] == 1


def test_contact_between_bodies_in_space_is_seen_at_its_edges_alone(tmp_path):
    parts = [
        Box("upper", (0, 0, 0), (1, 1, 0.5), (2, 2, 1)),
        Box("lower", (0, 0, -0.5), (1, 1, 0), (3, 3, 1)),
    ]
    held = {"x": 0, "y": 0}
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("lower.z0", {**held, "z": 0}), Support("upper.z1", {**held, "z": -0.01})),
        contact=(
            Contact("upper.z0", against="lower.z1", slave="against", friction_coefficient=0.5),
        ),
    )
    body = boxes(parts, "hexahedron", comm=MPI.COMM_SELF)
    assert drawn(scene, tmp_path, body) == {"contact_0.png", "deformed.png", *BELOW}
    assert has_colour(pixels(tmp_path / "deformed.png"), COLOURS["STICK"], 0.02)
    body, table, result = files_of(tmp_path)
    view = choose_view(body, result, table)
    view.body["displacement"][:] = 0.0
    x, y, _ = np.asarray(view.body.points).T
    points = np.asarray(view.body["status"]) >= 0
    outside = np.isclose(x, 1) | np.isclose(y, 1)  # the sides that face the eye
    assert view.towards.min() > 0.5
    assert (points & ~outside).sum() > 3
    assert (seen_points(view) == (points & outside)).all()
    view.body["displacement"][body_of_nodes(view.body) == 0, 2] = 1.0  # one looks in between
    assert (seen_points(view) == points).all()
    from_below = seen_points(dataclasses.replace(view, towards=-view.towards))
    assert (from_below == (points & (np.isclose(x, 0) | np.isclose(y, 0)))).all()
