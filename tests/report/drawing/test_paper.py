"""Figures for papers: their width, their data, and what is refused."""

import csv
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import main
from fenics_contact.report.drawing.figures import Paper, for_paper, new_figure, save, wanted

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


def drawn(folder, paper):
    with for_paper(paper):
        figure, (upper, lower) = new_figure("Two curves", (5.5, 4.0), nrows=2)
        upper.plot([0, 1, 2], [3.0, np.nan, 5.0], label="measured")
        upper.axhline(1.0)
        upper.set(xlabel="time", ylabel="force")
        lower.plot([0, 1], [7, 8])
        save(figure, folder / "curve.png")
    return folder / "figures" / f"curve.{paper.format}"


@pytest.mark.parametrize("width", [60.0, 86.0, 180.0])
def test_a_figure_has_the_width_asked_for(tmp_path, width):
    text = drawn(tmp_path, Paper("svg", width)).read_text(encoding="utf-8")
    points = float(re.search(r'<svg[^>]* width="([\d.]+)pt"', text)[1])
    assert points == pytest.approx(width / 25.4 * 72, rel=1e-4)
    assert [path.name for path in tmp_path.iterdir()] == ["figures"]


def test_a_pdf_too(tmp_path):
    content = drawn(tmp_path, Paper("pdf", 86.0)).read_bytes()
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+)", content)
    assert float(box[1]) == pytest.approx(86 / 25.4 * 72, rel=1e-3)


def test_the_data_of_curves(tmp_path):
    with drawn(tmp_path, Paper("svg")).with_suffix(".csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    found = [(r["panel"], r["x_label"], r["curve"], float(r["x"]), float(r["y"])) for r in rows]
    # Without what has no value, and without the line at 1 across the panel.
    assert found == [
        ("1", "time", "measured", 0, 3),
        ("1", "time", "measured", 2, 5),
        ("2", "", "", 0, 7),
        ("2", "", "", 1, 8),
    ]


def test_pages_are_as_ever_afterwards(tmp_path):
    drawn(tmp_path, Paper("svg", 86.0))
    assert wanted() is None
    figure, _ = new_figure("One", (5.5, 2.0))
    assert figure.get_figwidth() == 5.5


@pytest.mark.serial  # the command line waits for all ranks
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--figures", "png"], "invalid choice"),
        (["--figures", "pdf", "--width", "86"], "write a number and mm, cm, in or pt"),
        (["--figures", "pdf", "--width", "3mm"], "40 to 1000 mm"),
        (["--width", "86mm"], "say --figures"),
        (["--figures", "pdf"], "result.json"),
    ],
)
def test_what_is_refused(tmp_path, words, said, capsys, caplog):
    try:
        code = main(["report", str(tmp_path), *words])
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert said in capsys.readouterr().err + caplog.text
