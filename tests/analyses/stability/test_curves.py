"""What is drawn of steady sliding is what the run says: frequencies, and what grows."""

import pytest
from mpi4py import MPI

from fenics_contact.analyses.stability import page as curves
from fenics_contact.analyses.stability.page import draw_stability
from fenics_contact.analyses.stability.words import stability_words
from tests.records import made_run

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")


def point(coefficient, frequencies, rates):
    return {
        **{"friction_coefficient": coefficient, "frequencies": frequencies},
        **{"growth_rates": rates, "largest_growth_rate": max(0.0, *rates)},
    }


def found(curve, critical=None):
    of_sliding = {"friction_coefficient": 0.3, "modes": [], "critical_coefficient": critical}
    return made_run({"stability": of_sliding | {"curve": curve}})


def test_frequencies_of_all_modes_and_rates_of_those_that_grow(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(curves, "save", lambda figure, path: drawn.append(figure))
    curve = [point(0.0, [1, 2], [0, 0]), point(0.2, [1.4, 1.6], [-1e-9, 1e-9])]
    curve.append(point(0.4, [1.5, 1.5], [-2.0, 2.0]))
    (picture,) = draw_stability(tmp_path, found(curve, critical=0.25))
    assert picture.path.name == "stability.png"
    frequency, growth = drawn[0].axes
    by_name = {line.get_label(): line for line in frequency.lines}
    assert sorted(by_name["steady"].get_ydata()) == [1, 1.4, 1.5, 1.6, 2]
    assert list(by_name["grows"].get_xdata()) == [0.4]
    assert list(by_name["critical, 0.25"].get_xdata()) == [0.25, 0.25]
    assert "of the scene, 0.3" in by_name
    assert [list(line.get_ydata()) for line in growth.lines[:4]] == [[], [], [2], [0, 1e-9, 2]]


def test_one_coefficient_is_no_curve(tmp_path):
    assert not draw_stability(tmp_path, found([point(0.3, [1, 2], [0, 0])]))
    assert not draw_stability(tmp_path, made_run({}))


def test_the_sentence_has_the_units_of_the_run():
    mode = {"number": 2, "frequency": 3.0, "growth_rate": 0.5, "damping_ratio": -0.1}
    of_sliding = {"friction_coefficient": 0.3, "modes": [mode | {"grows": True}]}
    of_sliding |= {"critical_coefficient": None, "curve": []}
    units = {"length": "mm", "force": "N", "stress": "MPa", "energy": "mJ"}
    run = made_run({"stability": of_sliding, "units": units})
    said = stability_words(run.stability, run.units)
    assert "number 2, at a rate of 0.5 1/s and a frequency of 3 Hz." in said
    assert "at a rate of 0.5 and a frequency of 3." in stability_words(run.stability, None)
