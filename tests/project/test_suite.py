"""What `make test` leaves out on two ranks."""

from collections import namedtuple

import pytest

from tests.conftest import cases_left_out

pytestmark = pytest.mark.serial
Item = namedtuple("Item", "nodeid")
ITEMS = [Item(f"test_{of}[{case}]") for of in "abcdefghij" for case in range(7)]
ITEMS += [Item("test_alone"), Item("test_of_two[a]"), Item("test_of_two[b]")]


def test_no_test_is_left_out_and_other_cases_of_others():
    kept = set(ITEMS) - cases_left_out(ITEMS, 3)
    assert {item.nodeid.partition("[")[0] for item in kept} == {
        item.nodeid.partition("[")[0] for item in ITEMS
    }
    assert len(kept) < len(ITEMS) / 2
    cases = {item.nodeid.partition("[")[2] for item in kept}
    assert cases > {f"{case}]" for case in range(7)}


def test_without_the_option_everything_is_run():
    assert not cases_left_out(ITEMS, 1)
