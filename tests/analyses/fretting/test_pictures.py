"""Pictures and the page of runs that look for fretting: what they show, and damaged tables."""

import numpy as np
import pytest

from fenics_contact import FatigueLimits, Fretting, Run
from fenics_contact.analyses.fretting.page import FrettingTable, draw_fretting
from fenics_contact.report.drawing.fields import read_body
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.page.page import Content, page
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output.run_folder import write
from tests.analyses.fretting.test_fretting import LINE, block, body
from tests.messages import refused
from tests.report.test_gallery import coarse

assert coarse  # a fixture

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("kinematics", ["plane stress", "3D"])
def test_pictures_and_page(kinematics, tmp_path) -> None:
    """Of each criterion a panel along the surface or a map; the worst places in a table."""
    asked = Fretting(depth=0.6, begin=2, limits=FatigueLimits(5.0, 8.0), life=LINE)
    flat = kinematics != "3D"
    made = body(cells=(4, 2)) if flat else body("hexahedron", (2, 1, 1))
    prepared = Run(block(asked, degree=1, kinematics=kinematics), body=made)
    result = prepared.solve()
    write(prepared, result, tmp_path)
    table = FrettingTable.read(tmp_path / "fretting.csv")
    assert table is not None and result.fretting is not None
    assert table.values["swt"] == pytest.approx(result.fretting_places.values["swt"], rel=1e-7)
    assert np.count_nonzero(table.on("block.y0")) == (5 if flat else 6)
    record = read_result(tmp_path)
    points = ContactTable.read(tmp_path / "contact.csv")
    contacts = [(points.of("block.y0"), record.contacts[0])]
    with style():
        (drawn,) = draw_fretting(read_body(tmp_path), contacts, table, "xyz", tmp_path)
    assert drawn.path.name == "fretting_0.png" and drawn.path.exists()
    assert drawn.path.with_suffix(".pdf").exists()
    shown = page(Content("run", record, False, [], [], ""))
    for words in ('id="fretting"', "SWT", "Crossland", "Dang Van", "safety factor"):
        assert words in shown
    assert f"{result.fretting.worst['swt'].value:.4g}" in shown


def test_runs_without_fretting_have_no_table(tmp_path) -> None:
    assert FrettingTable.read(tmp_path / "fretting.csv") is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("body,contact,x\nb,,1\n", "fretting_table_lacks_y"),
        ("body,contact,x,y,z,swt\nb,,1,2,3,?\n", "fretting_table_has_a_word"),
    ],
)
def test_damaged_tables_are_refused(text, said, tmp_path) -> None:
    path = tmp_path / "fretting.csv"
    path.write_text(text)
    with refused(said):
        FrettingTable.read(path)
