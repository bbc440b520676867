"""What is drawn of damping is what the run says, a curve a mode and value."""

import pytest
from mpi4py import MPI

from fenics_contact.analyses.vibration import page as damping_curves
from fenics_contact.analyses.vibration.page import draw_damping
from tests.records import made_run
from tests.report.contacts.test_captions import cycled

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


def rows(mode, amplitudes, **by):
    return [
        {
            **{"mode": mode, "driven": a, "amplitude": a, "natural_frequency": 10 - a},
            **{"damping_ratio": a / 9, "loss": a**3, "loop_area": a**3, "contacts": {"top": a**3}},
            **{"kind": "steady loop", "cycles": 2, "by": by},
        }
        for a in amplitudes
    ]


def test_a_curve_a_mode_and_value(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(damping_curves, "save", lambda figure, path: drawn.append(figure))
    found = [*rows(1, (1, 2), mu=0.1), *rows(1, (1, 2, 3), mu=0.2), *rows(2, (5,), mu=0.1)]
    (picture,) = draw_damping(tmp_path, made_run(cycled() | {"damping": found}))
    assert picture.path.name == "damping.png"
    frequency, ratio = drawn[0].axes
    assert [list(one.get_xdata()) for one in ratio.lines] == [[1, 2], [1, 2, 3], [5]]
    assert list(frequency.lines[1].get_ydata()) == [9, 8, 7]
    assert list(ratio.lines[1].get_ydata()) == pytest.approx([1 / 9, 2 / 9, 3 / 9])
    words = [text.get_text() for text in ratio.get_legend().get_texts()]
    assert words == ["mode 1, mu = 0.1", "mode 1, mu = 0.2", "mode 2, mu = 0.1"]


def test_one_amplitude_is_no_curve(tmp_path):
    assert not draw_damping(tmp_path, made_run(cycled() | {"damping": rows(1, (1,))}))
    assert not draw_damping(tmp_path, made_run(cycled()))


def test_bars_are_drawn_where_they_are_known(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(damping_curves, "save", lambda figure, path: drawn.append(figure))
    found = rows(1, (1, 2, 3))
    for row, bar in zip(found, (0.5, None, 0.25), strict=True):
        row["errors"] = {"damping_ratio": {"total": bar}, "natural_frequency": {"total": None}}
    (picture,) = draw_damping(tmp_path, made_run(cycled() | {"damping": found}))
    assert picture.caption.endswith("Bars are estimated errors.")
    frequency, ratio = drawn[0].axes
    assert not frequency.containers
    ((_, _, (lines,)),) = ratio.containers
    ends = [segment[:, 1].tolist() for segment in lines.get_segments()]
    assert ends == [pytest.approx([1 / 9 - 0.5, 1 / 9 + 0.5]), pytest.approx([1 / 12, 7 / 12])]
