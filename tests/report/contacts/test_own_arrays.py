"""What laws keep of their own is drawn: on lines and maps, in films, as colours to choose."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.report.bodies.view_3d import make_view
from fenics_contact.report.contacts.film import frame_rows
from fenics_contact.report.contacts.line import shown_arrays
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.report.report import write_report
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from tests.contact.laws.test_own_arrays import polished  # noqa: F401
from tests.simulation.output.test_run_folder import block, cycled

pytestmark = [pytest.mark.serial, pytest.mark.usefixtures("polished")]


STEPS = 4  # pressed on, to one side, to the other, back


def written(folder, kinematics="plane strain", cells=(8, 4)):
    prepared = Run(cycled(STEPS, kinematics), MPI.COMM_SELF, block(MPI.COMM_SELF, cells))
    assert files.solve_and_write(prepared, folder).converged
    return read_result(folder)


@pytest.mark.parametrize(("kinematics", "cells"), [("plane strain", (8, 4)), ("3D", (4, 3, 2))])
def test_pictures_and_the_view_show_them(tmp_path, kinematics, cells):
    pytest.importorskip("pyvista")
    result = written(tmp_path, kinematics, cells)
    pictures = {picture.path.name: picture for picture in write_report(tmp_path)}
    assert "slid way and drift" in pictures["contact_0.png"].caption
    body, table = read_body(tmp_path), ContactTable.read(tmp_path / "contact.csv")
    view = make_view(body, result, table)
    assert view.shown["slid way"] == "(length)"
    assert view.surface.fields["slid way"].max() == pytest.approx(table.numbers["slid_way"].max())
    assert view.surface.fields["drift"].ndim == 1  # of vectors the size
    assert "slid way" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_frames_of_films_have_those_of_their_step(tmp_path):
    pytest.importorskip("pyvista")
    result = written(tmp_path)
    body, table = read_body(tmp_path), ContactTable.read(tmp_path / "contact.csv")
    body["slid_way"] = 2 * np.asarray(body["slid_way"])
    rows = frame_rows(table, body, result.contacts[0])
    twice = 2 * table.numbers["slid_way"].max()
    assert rows.numbers["slid_way"].max() == pytest.approx(twice)


def test_what_is_zero_everywhere_is_not_drawn(tmp_path):
    result = written(tmp_path)
    table, contact = ContactTable.read(tmp_path / "contact.csv"), result.contacts[0]
    assert list(shown_arrays(table, contact)) == ["slid way", "drift"]
    table.numbers["slid_way"][:] = 0.0
    assert list(shown_arrays(table, contact)) == ["drift"]
