"""What is drawn of wear over load steps is what the steps say, of the contacts that wear."""

import pytest
from mpi4py import MPI

from fenics_contact.report import load_steps as wear
from fenics_contact.report.load_steps import draw_worn_history
from tests.records import made_run
from tests.report.contacts.test_captions import cycled

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


def with_wear(wearing):
    """Two contacts, of which some wear, the deepest by the square of the time."""
    result = cycled()
    result["contacts"] = [result["contacts"][0] | {"name": name} for name in ("top", "side")]
    for step in result["steps"]:
        (contact,), time = step["contacts"], step["load_factor"]
        lost = {"worn_volume": time - 1, "max_wear_depth": time**2 - 1}
        more = [lost if name in wearing else {} for name in ("top", "side")]
        step["contacts"] = [{"quantities": contact["quantities"] | one} for one in more]
    return made_run(result)


@pytest.mark.parametrize("wearing", [("top",), ("side",), ("top", "side")])
def test_curves_are_the_steps(wearing, monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(wear, "save", lambda figure, path: drawn.append(figure))
    result = with_wear(wearing)
    (picture,) = draw_worn_history(tmp_path, result)
    assert picture.path.name == "history_wear.png" and len(picture.followed.places) == 2
    (figure,) = drawn
    times = [step.load_factor for step in result.steps]
    expected = [[t - 1 for t in times], [t**2 - 1 for t in times]]
    for panel, values in zip(figure.axes, expected, strict=True):
        curves = {one.get_label(): one for one in panel.get_lines()}
        assert list(curves) == [f"'{name}'" for name in wearing]
        for curve in curves.values():
            assert curve.get_xdata() == pytest.approx(times)
            assert curve.get_ydata() == pytest.approx(values)
        assert (panel.get_legend() is not None) == (len(wearing) > 1)


def test_without_wear_there_is_none(tmp_path):
    assert draw_worn_history(tmp_path, with_wear(())) == []
