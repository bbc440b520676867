"""Damaged files at random, as ``benchmarks/damaged_files.py`` draws and judges them: a few."""

import sys

import pytest

from tests.mesh.soundness.draws import ANY, EITHER, REFUSAL, SAME, draw
from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

from damaged_files import judged, row_of

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("number", [*range(8), 35])
def test_no_damage_is_solved_wrongly(number):
    """The last has one more line of elements than it says."""
    row = row_of(1, number, 60)
    assert not row["is_wrong"], row


def test_what_is_not_trusted_leaves_the_rows_alone(capfd):
    """A cell of next to no volume: the program says its checks where the rows of a worker go."""
    row = row_of(31337, 189, 60)
    assert row["came"] == "not trusted" and "do not trust it" in row["words"]
    assert capfd.readouterr().out == ""


def test_draws_stay_the_same():
    assert draw(3, 4) == draw(3, 4)
    assert draw(3, 4).text != draw(3, 5).text


@pytest.mark.parametrize(
    ("must", "code", "words", "values", "is_wrong"),
    [
        (EITHER, 2, "a: b\n", [], False),
        (SAME, 2, "a: b\n", [], True),
        (EITHER, 2, "a\nb\n", [], True),
        (EITHER, 1, "", [], True),
        (EITHER, 0, "", [1.005], False),
        (EITHER, 0, "", [1.02], True),
        (ANY, 0, "", [1.02], False),
        (REFUSAL, 0, "", [1.0], True),
        (EITHER, 4, "", [], False),
        (SAME, 3, "", [], True),
    ],
)
def test_what_is_wrong(must, code, words, values, is_wrong):
    assert judged(must, code, words, values, [1.0])[1] == is_wrong
