"""The page of a fit says what its files say; files that are damaged are refused."""

import json

import pytest
from mpi4py import MPI

from fenics_contact.report.page.fit import write_fit_page
from fenics_contact.results.fit_record import FitRecord, FittedParameter
from fenics_contact.results.records.record import UnitsRecord
from tests.messages import refused

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")

MU, E = "contact.0.friction_coefficient", "material.0.youngs_modulus"
CURVE = "time,friction_force_x,friction_force_x_error,run,residual\n1,2,.1,2.05,.05\n2,3,.1,3,0\n"


def record(**changes):
    known = FittedParameter(
        value=0.29936, low=0.2951, high=0.3036, start=0.2, noise=0.0041, discretisation=0.0013
    )
    lost = FittedParameter(
        value=1003.0, low=None, high=None, start=900.0, noise=None, discretisation=None
    )
    values = {
        "parameters": {MU: known, E: lost},
        "confidence": 0.95,
        "residual": 0.0354,
        "evaluations": 5,
        "converged": True,
        "verdict": "The best values were found.",
        "quantity": "friction_force_x",
        "over": ["time"],
        "rows": 2,
        "misfit": 0.8,
        "correlations": [[1.0, -0.25], [-0.25, 1.0]],
        "singular_values": [1.2, 0.7],
        "notes": ["A note <b>."],
        "checks": [],
        "title": "A block & a punch",
        "scene": "block.toml",
        "measured": "loop.csv",
        "units": UnitsRecord(length="mm", force="N", stress="MPa", energy="mJ"),
    }
    return FitRecord(**values | changes)


def write(folder, curve=CURVE, **changes):
    content = json.dumps(record(**changes).as_dict())
    (folder / "fit.json").write_text(content, encoding="utf-8")
    (folder / "fit.csv").write_text(curve, encoding="utf-8")


@pytest.mark.pdf
def test_the_page_has_values_intervals_and_pictures(tmp_path):
    write(tmp_path)
    text = write_fit_page(tmp_path).read_text(encoding="utf-8")
    for said in (
        "A block &amp; a punch",
        "A note &lt;b&gt;.",
        "0.299, 95%: 0.2951 to 0.3036",
        "1003 MPa, not determined by the data",
        "-0.250",
        "root mean square: 0.0354 N",
        "friction force x over time, 2 rows of loop.csv",
    ):
        assert said in text, said
    assert text.count("data:image/png;base64,") == 2
    assert 'class="verdict ok"' in text
    for name in ("fit.png", "residual.png", "fit.pdf"):
        assert (tmp_path / name).stat().st_size > 1000


def test_a_fit_over_several_keys_that_did_not_end(tmp_path):
    curve = f"{MU},{E},friction_force_x,run,residual\n.1,1,2,2,0\n.2,1,3,3,0\n"
    write(tmp_path, curve, over=[MU, E], converged=False, misfit=None, units=None)
    text = write_fit_page(tmp_path).read_text(encoding="utf-8")
    assert 'class="verdict bad"' in text and "Misfit" not in text


@pytest.mark.parametrize(
    ("curve", "changes", "said"),
    [
        ("time,normal_force,run,residual\n1,1,1,0\n", {}, "fit_table_of_another_quantity"),
        (CURVE, {"rows": 3}, "fit_table_lacks_a_row"),
        (CURVE.replace("2.05", "x"), {}, "fit_table_has_a_word"),
        (CURVE, {"evaluations": "many"}, "fit_result_damaged"),
    ],
)
def test_damaged_files_are_refused(tmp_path, curve, changes, said):
    write(tmp_path, curve, **changes)
    with refused(said):
        write_fit_page(tmp_path)


def test_a_folder_without_a_fit(tmp_path):
    with refused("fit_result_cannot_be_read"):
        write_fit_page(tmp_path)
