"""Which tests, and which cases of a test, a run takes, so that several runs share them.

A test has *cases*, one for each set of its parameters. Files of tests are in *quarters*, by their
names, the same on every machine; a file is never divided, for its tests share what its fixtures
have solved. *Serial* tests start processes of their own and run on one rank only: their quarters
are chosen apart.
"""

from __future__ import annotations

import zlib

QUARTERS = 4


def add_options(parser) -> None:
    """Those of pytest that choose a share."""
    parser.addoption(
        "--one-case-in", type=int, default=1, metavar="N", help="of each test, at least one case"
    )
    parser.addoption(
        "--but-one-case-in", type=int, default=0, metavar="N",
        help="without the cases that two ranks run with --one-case-in N",
    )  # fmt: skip
    parser.addoption(
        "--quarters", default="0123", metavar="DIGITS",
        help="of the files, those of these quarters, for tests that any number of ranks runs",
    )  # fmt: skip
    parser.addoption(
        "--quarters-of-serial", default="0123", metavar="DIGITS",
        help="of the files, those of these quarters, for tests that run on one rank only",
    )  # fmt: skip
    parser.addoption(
        "--turn", type=int, default=0, metavar="N",
        help="moves each quarter on by N, so that in four turns each run takes all files",
    )  # fmt: skip


def left_out(items, option, ranks):
    """Items that a run does not take.

    Args:
        items: Of pytest.
        option: From the name of an option to its value.
        ranks: Of the run.
    """
    turn = option("turn")
    gone = cases_left_out(items, option("one_case_in"), ranks)
    gone |= of_other_quarters(items, option("quarters"), option("quarters_of_serial"), turn)
    if others := option("but_one_case_in"):
        gone |= cases_for_two_ranks(items, others)
    return gone | {item for item in items if ranks > 1 and is_serial(item)}


def is_serial(item):
    return item.get_closest_marker("serial") is not None


def cases_of_tests(items):
    """Items by their tests' names."""
    tests = {}
    for item in items:
        tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    return tests


def cases_left_out(items, share, ranks):
    """All but every n-th case of each test; which is the first depends on its name and the ranks.

    So each test is seen, and among them each kind of cell, body and contact, in less time.
    """
    gone = set()
    for name, cases in cases_of_tests(items).items():
        every = min(share, len(cases))
        first = (zlib.crc32(name.encode()) + ranks) % every
        gone |= {case for n, case in enumerate(cases) if n % every != first}
    return gone


def cases_for_two_ranks(items, share):
    """Those that two ranks run with such a share, where one rank has other cases of the test."""
    items = [item for item in items if not is_serial(item)]
    several = [case for cases in cases_of_tests(items).values() if len(cases) > 1 for case in cases]
    return set(several) - cases_left_out(several, share, ranks=2)


def of_other_quarters(items, of_any, of_serial, turn):
    """Tests of files in none of the quarters: those of any number of ranks, and serial ones."""
    return {
        item
        for item in items
        if str(quarter(item, turn)) not in (of_serial if is_serial(item) else of_any)
    }


def quarter(item, turn=0):
    """Which quarter a test's file is in."""
    file = item.nodeid.partition("::")[0]
    return ((zlib.crc32(file.encode()) >> 8) - turn) % QUARTERS
