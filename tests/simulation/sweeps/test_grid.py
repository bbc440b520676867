"""Values of keys, and their combinations."""

import itertools

import pytest

from fenics_contact.simulation.sweeps.points import Axis, Grid
from tests.messages import refused

MU = "contact.0.friction_coefficient"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.1,0.2", (0.1, 0.2)),
        (" .1 , .2", (0.1, 0.2)),
        ("0:1:11", (0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1)),
        ("1:7:3", (1, 4, 7)),
        ("3:1:3,10", (3, 2, 1, 10)),
        ("1e-3:-1e-3:3", (1e-3, 0.0, -1e-3)),
        (".5:1.:2", (0.5, 1.0)),
        ("static,incremental", ("static", "incremental")),
        ("'a,b.geo',c.geo", ("a,b.geo", "c.geo")),
        ("true,false", (True, False)),
        ("[1, 0],[2, 0]", ([1, 0], [2, 0])),
        ("{ x = 1, y = 2 }", ({"x": 1, "y": 2},)),
        ("4 mm,5 mm", ("4 mm", "5 mm")),
    ],
)
def test_values_are_numbers_ranges_words_and_lists(text, values):
    found = Axis.of(f"{MU}={text}").values
    assert found == values
    assert [type(one) for one in found] == [type(one) for one in values]


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ([MU], "vary_without_values"),
        (["=1"], "vary_without_key"),
        (["contact.'=1"], "vary_with_open_quote"),
        ([f"{MU}="], "vary_value_is_missing"),
        ([f"{MU}=1,,2"], "vary_value_is_missing_between"),
        ([f"{MU}=0:1"], "range_without_number"),
        ([f"{MU}=0:1:1"], "range_of_1_number"),
        ([f"{MU}=0:1:0"], "range_of_0_numbers"),
        ([f"{MU}=0:x:3"], "range_to_a_letter"),
        ([f"{MU}=0:1:200000"], "range_of_too_many_values"),
        ([f"{MU}=1:1000:1000", "a=1:1000:1000"], "too_many_points_to_vary"),
        ([f"{MU}=1,2,1.0"], "vary_a_value_twice"),
        ([f"{MU}=1", f"{MU}=2"], "key_varied_twice"),
        (["contact.0=1", f"{MU}=2"], "part_and_all_varied"),
    ],
)
def test_what_is_written_otherwise_is_refused_in_one_sentence(settings, said):
    with refused(said):
        Grid(settings)


@pytest.mark.parametrize("key", [MU, "contact.0.'friction_coefficient'"])
def test_a_key_is_either_set_or_varied(key):
    with refused("key_set_and_varied", key=key):
        Grid([f"{MU}=1,2"], [f"{key}=3"])
    assert len(Grid(["load.0.traction.0=1,2"], ["load.0.traction=[0, 5]"])) == 2


def test_the_last_key_runs_fastest():
    grid = Grid(["a=1,2", "b=x,y,z"])
    assert list(grid.values()) == list(itertools.product((1, 2), ("x", "y", "z")))
    assert next(grid.settings()) == ("a=1", "b=x")


@pytest.mark.parametrize("counts", [(5,), (3, 4), (2, 3, 4), (3, 3, 3)])
def test_a_snake_goes_from_neighbour_to_neighbour(counts):
    """Also on what is left of it where one key has one value."""
    grid = Grid([f"k{n}=1:{count}:{count}" for n, count in enumerate(counts)])
    values = list(grid.values())
    order = grid.snake()
    assert sorted(order) == list(range(len(grid)))
    for axis in range(len(counts)):
        kept = [values[n] for n in order if values[n][axis] == 2]
        for path in (kept, [values[n] for n in order]):
            for one, other in itertools.pairwise(path):
                assert sum(abs(a - b) for a, b in zip(one, other, strict=True)) == 1
