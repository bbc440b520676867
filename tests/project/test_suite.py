"""What `make test` leaves out on one rank, and on two; and how it has forms compiled."""

import gc
import subprocess
from collections import OrderedDict, namedtuple
from pathlib import Path

import pytest
import ufl
from dolfinx import fem, jit
from xdist.scheduler import LoadFileScheduling

from tests.compiled_headers import command_of_forms, compiled, is_tiny, options
from tests.conftest import loaded_once, without_listing
from tests.longest_first import LONGEST, LongestFirst
from tests.scenes import ROOT, box_body
from tests.shares import cases_for_two_ranks, cases_left_out, left_out, of_other_quarters

pytestmark = pytest.mark.serial


class Item(namedtuple("Item", "nodeid")):
    """A case of a test, as pytest has them."""

    def get_closest_marker(self, name):
        return name if name in self.nodeid else None


ITEMS = [Item(f"test_{of}[{case}]") for of in "abcdefghij" for case in range(7)]
ITEMS += [Item("test_alone"), Item("test_of_two[a]"), Item("test_of_two[b]")]


def test_no_test_is_left_out_and_other_cases_of_others():
    kept = set(ITEMS) - cases_left_out(ITEMS, 3, ranks=2)
    assert {item.nodeid.partition("[")[0] for item in kept} == {
        item.nodeid.partition("[")[0] for item in ITEMS
    }
    assert len(kept) < len(ITEMS) / 2
    cases = {item.nodeid.partition("[")[2] for item in kept}
    assert cases > {f"{case}]" for case in range(7)}


def test_without_the_option_everything_is_run():
    assert not cases_left_out(ITEMS, 1, ranks=2)


def test_one_rank_and_two_run_all_cases_together():
    """And each of them all tests; on one rank, all cases of a test that two never run."""
    serial = [Item(f"test_serial[{case}]") for case in range(4)]
    on_two = set(ITEMS) - cases_left_out(ITEMS, 3, ranks=2)
    on_one = {*ITEMS, *serial} - cases_for_two_ranks([*ITEMS, *serial], 3)
    assert on_one | on_two == {*ITEMS, *serial}
    assert on_one & on_two == {Item("test_alone")}
    assert on_one >= set(serial)


def test_one_rank_runs_other_cases_of_a_test_than_two():
    of_one, of_two = (set(ITEMS) - cases_left_out(ITEMS, 6, ranks) for ranks in (1, 2))
    assert of_one & of_two == {Item("test_alone")}


FILES = [
    Item(f"tests/{n}/test_of_{n % 7}.py::test_{n}[{case}]") for n in range(400) for case in "ab"
]
SERIAL = [Item(f"{item.nodeid}-serial") for item in FILES]


def of_quarters(any_ranks, serial, turn=0, ranks=1):
    """What a run with these options takes."""
    options = {
        "turn": turn,
        "quarters": any_ranks,
        "quarters_of_serial": serial,
        "one_case_in": 1,
        "but_one_case_in": 0,
    }
    items = [*FILES, *SERIAL]
    return set(items) - left_out(items, options.__getitem__, ranks)


def test_four_runs_share_the_files():
    """Each file is taken by one of them, with all its cases; serial tests by one of two."""
    wheel, image = of_quarters("01", "012"), of_quarters("2", "3")
    wheel_on_two, image_on_two = (of_quarters(q, "0123", ranks=2) for q in "31")
    assert wheel | image | wheel_on_two == {*FILES, *SERIAL}
    assert not wheel & image
    assert not wheel_on_two & image_on_two
    assert not (wheel_on_two | image_on_two) & set(SERIAL)
    assert of_quarters("0123", "0123") == {*FILES, *SERIAL}


def test_in_four_turns_each_run_takes_all_files():
    taken = [of_quarters("3", "3", turn) for turn in range(48, 52)]
    assert set().union(*taken) == {*FILES, *SERIAL}
    assert sum(len(some) for some in taken) == len(FILES) + len(SERIAL)


def test_quarters_of_the_suite_are_about_as_large():
    """And which quarter a test is in does not go by which of its cases are run."""
    cases = set(FILES) - cases_left_out(FILES, 2, ranks=2)
    for quarter in "0123":
        taken = set(FILES) - of_other_quarters(FILES, quarter, "", turn=0)
        assert len(taken) == pytest.approx(len(FILES) / 4, rel=0.2)
        assert len(taken & cases) == pytest.approx(len(FILES) / 8, rel=0.3)


def test_files_that_take_longest_are_begun_first(monkeypatch):
    assert all((ROOT / file).is_file() for file in LONGEST)
    begun = []
    monkeypatch.setattr(
        LoadFileScheduling,
        "_assign_work_unit",
        lambda self, node: begun.append(self.workqueue.popitem(last=False)[0]),
    )
    scheduler = LongestFirst.__new__(LongestFirst)  # which wants a run of pytest-xdist
    scheduler.workqueue = OrderedDict.fromkeys(["many.py", LONGEST[1], "few.py", LONGEST[0]])
    while scheduler.workqueue:
        scheduler._assign_work_unit(None)
    assert begun == [LONGEST[0], LONGEST[1], "many.py", "few.py"]


def test_forms_are_not_optimised():
    """Their options are in place before dolfinx first looks for them, which it does once."""
    arguments = jit.get_options()["cffi_extra_compile_args"]
    assert arguments == options()
    assert arguments[0] == "-O0"


def test_options_go_by_the_compiler(monkeypatch):
    monkeypatch.setenv("CC", "/usr/bin/tcc")
    assert "-include" not in options()
    monkeypatch.setenv("CC", "gcc")
    assert options()[-2:] == ["-include", str(compiled())]


@pytest.mark.skipif(is_tiny(), reason="reads all headers in no time")
def test_the_compiler_takes_the_headers_that_it_has_compiled(tmp_path):
    """With the options that forms have; what Python.h includes is then not read."""
    source = tmp_path / "form.c"
    source.write_text("#define _CFFI_\n#include <Python.h>\n#include <ufcx.h>\nufcx_form form;\n")
    command = [*command_of_forms(), "-H", "-c", source, "-o", tmp_path / "form.o"]
    for included in ([], ["-include", compiled()]):
        done = subprocess.run([*command, *included], capture_output=True, text=True, check=True)
        assert ("/object.h" in done.stderr) is not bool(included), done.stderr


def test_forms_are_searched_for_once_and_again_when_they_have_gone(tmp_path):
    searched = []

    def load(name, objects, folder, timeout):
        searched.append(name)
        return (["a form"], "its module") if done.exists() else (None, None)

    done = tmp_path / "form.c.cached"
    find = loaded_once(load)
    assert find("form", ["a"], tmp_path, 1) == (None, None)  # it is to be compiled
    done.touch()
    for _ in range(3):
        assert find("form", ["a"], tmp_path, 1) == (["a form"], "its module")
    assert len(searched) == 2
    find("form", ["b"], tmp_path, 1)
    find("form", ["a"], tmp_path / "other", 1)
    assert len(searched) == 4
    done.unlink()
    assert find("form", ["a"], tmp_path, 1) == (None, None)


def test_forms_that_are_there_are_loaded_by_their_names(tmp_path):
    fem.form(1.0 * ufl.dx(domain=box_body((1, 1)).mesh))  # there is one
    cache = Path(jit.get_options()["cache_dir"])
    name = next(cache.glob("libffcx_forms_*.c.cached")).name.partition(".")[0]
    find = without_listing(lambda *wanted: (None, None))
    assert find(name, [], cache, 1)[1].__name__ == name
    assert find(name, [], tmp_path, 1) == (None, None)


def test_no_garbage_is_looked_for_in_what_is_imported():
    assert gc.get_freeze_count() > 10_000
