"""What a page may ask for, and that the latest counts."""

import json
import threading
import time

import pytest
from mpi4py import MPI

from fenics_contact import Study
from fenics_contact.explore.keys import moved_keys
from fenics_contact.explore.messages import Exchange, Request, read_request
from tests.scenes import slab

KEY = "contact.0.friction_coefficient"


@pytest.fixture(scope="module")
def keys():
    return moved_keys(Study(slab(), MPI.COMM_SELF), [f"{KEY}=0:1"])


def text(number=1, kind="follow", **values):
    return json.dumps({"number": number, "kind": kind, "values": values})


def test_a_request_moves_what_is_shown(keys):
    assert read_request(text(7, "solve", **{KEY: 0.25}), keys) == Request(7, "solve", {KEY: 0.25})


@pytest.mark.parametrize(
    "wrong",
    [
        text(**{"load.0.traction.0": 1}),
        text(**{"mesh.0.file": "/etc/passwd"}),
        text(**{"../../etc/passwd": 0.5}),
        text(**{KEY: 1.01}),
        text(**{KEY: -0.01}),
        text(**{KEY: "0.5"}),
        text(**{KEY: True}),
        text(**{KEY: None}),
        text(**{KEY: [0.5]}),
        text(**{KEY: {"along": "x"}}),
        text(number=-1),
        text(number=1.5),
        text(number="1"),
        text(number=True),
        text(kind="run"),
        text(kind=None),
        '{"number": 1, "kind": "follow", "values": {"' + KEY + '": NaN}}',
        '{"number": 1, "kind": "follow", "values": {"' + KEY + '": Infinity}}',
        '{"number": 1, "kind": "follow", "values": {"' + KEY + '": 1e999}}',
        '{"number": 1, "kind": "follow", "values": []}',
        '{"number": 1, "kind": "follow"}',
        '{"number": 1, "kind": "follow", "values": {}, "out": "here"}',
        "[1]",
        "null",
        "",
        "[" * 100_000,
        b"\xff\xfe",
    ],
)
def test_anything_else_is_refused_in_a_sentence(keys, wrong):
    with pytest.raises(ValueError) as error:
        read_request(wrong, keys)
    assert 5 < len(str(error.value)) < 200


def test_of_each_page_the_latest_request_is_taken():
    exchange = Exchange()
    for number in range(5):
        exchange.put(0, Request(number, "follow", {}))
    exchange.put(1, Request(9, "follow", {}))
    assert exchange.has_newer(0)
    assert exchange.take() == (0, Request(4, "follow", {}))
    assert not exchange.has_newer(0)
    exchange.put(0, Request(5, "solve", {}))  # the page that has waited longer comes first
    assert exchange.take() == (1, Request(9, "follow", {}))
    exchange.forget(0)
    assert exchange.take() is None


def test_who_waits_is_woken():
    exchange = Exchange()
    threading.Timer(0.05, lambda: exchange.put(3, Request(1, "follow", {}))).start()
    start = time.monotonic()
    assert exchange.take(30) == (3, Request(1, "follow", {}))
    assert time.monotonic() - start < 15
