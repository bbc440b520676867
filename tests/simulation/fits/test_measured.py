"""Tables of measured curves are read, or refused in a sentence that says where."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.simulation.fits.measured import read_measured
from tests.messages import refused
from tests.simulation.studies.cases import MU, ON_A_FLOOR

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")


def read(tmp_path, text, of=None):
    path = tmp_path / "data.csv"
    path.write_text(text, encoding="utf-8")
    return read_measured(path, dataclasses.replace(ON_A_FLOOR), of)


def test_a_curve_over_time_with_uncertainties(tmp_path):
    text = "time,friction_force_x,friction_force_x_error\n# day 1\n0.5, 1, .1\n\n1,2,.2\n"
    found = read(tmp_path, text)
    assert found.over == ("time",) and found.quantity == "friction_force_x" and len(found) == 2
    assert found.at.tolist() == [[0.5], [1.0]] and found.values.tolist() == [1, 2]
    assert found.uncertainties is not None and found.uncertainties.tolist() == [0.1, 0.2]


def test_a_curve_over_a_quantity(tmp_path):
    found = read(tmp_path, "y1.reaction_y,normal_force\n-1,1\n-2,2\n")
    assert found.over == ("y1.reaction_y",) and found.uncertainties is None


def test_a_table_of_a_sweep(tmp_path):
    text = f"{MU},load.0.traction.0,exit_code,normal_force,normal_force_error,max_slip\n"
    found = read(tmp_path, f"{text}.1,1,0,5,.1,0\n.2,1,3,,,\n.3,1,0,6,.2,0\n", "normal_force")
    assert found.over == (MU, "load.0.traction.0")
    assert np.allclose(found.at, [[0.1, 1], [0.3, 1]]) and found.values.tolist() == [5, 6]
    assert found.uncertainties is not None and found.uncertainties.tolist() == [0.1, 0.2]


@pytest.mark.parametrize(
    ("text", "of", "said"),
    [
        ("", None, "data_is_empty"),
        ("time\n1\n", None, "data_of_one_column"),
        ("time,time\n1,1\n", None, "data_column_twice"),
        ("time,normal_fors\n1,1\n", None, "data_column_misspelt"),
        ("tim,normal_force\n1,1\n", None, "data_column_tim"),
        ("time,friction_force\n1,1\n", None, "data_of_a_vector"),
        ("time,normal_force\n1\n", None, "data_row_too_short"),
        ("time,normal_force\n1,1\n2,two\n", None, "data_is_a_word"),
        ("time,normal_force\n1,\n", None, "data_cell_is_empty"),
        ("time,normal_force,max_slip\n1,1,1\n", None, "data_of_two_quantities"),
        ("time,normal_force\n1,1\n", "normal_forc", "data_without_the_column"),
        ("time,normal_force,normal_force_error\n1,1,0\n", None, "data_error_is_zero"),
        (f"{MU},exit_code,normal_force\n1,3,1\n", None, "data_has_no_answer"),
    ],
)
def test_what_cannot_be_read_is_refused_in_a_sentence(tmp_path, text, of, said):
    with refused(said):
        read(tmp_path, text, of)


def test_a_file_that_is_not_there(tmp_path):
    with refused("data_cannot_be_read"):
        read_measured(tmp_path / "none.csv", ON_A_FLOOR)
