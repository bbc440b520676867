"""Messages to the page, and its requests: read with distrust, the latest of each page counts."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from fenics_contact.explore.keys import MovedKey
from fenics_contact.results.records.record import plain

_WORD = 4  # bytes; every part begins at a multiple of it
_TYPES = {"f": "<f4", "i": "<i4"}


@dataclass(frozen=True)
class Message:
    """A message to the page.

    Attributes:
        kind: ``progress``, ``shape``, ``answer``, ``nothing`` (why there is none), ``scene``,
            ``refused`` or ``ended``.
        header: What it says, as JSON has it.
        arrays: By name, numbers only.
    """

    kind: str
    header: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def packed(self) -> bytes:
        """Length of the header, header, arrays, all little-endian."""
        parts, rows = [], []
        for name, values in self.arrays.items():
            letter = "i" if values.dtype.kind in "iub" else "f"
            packed = np.ascontiguousarray(values, dtype=_TYPES[letter])
            parts.append(packed.tobytes())
            rows.append([name, letter, packed.size])
        header = plain({"kind": self.kind, **self.header, "arrays": rows})
        head = json.dumps(header, allow_nan=False)
        text = head.encode()
        text += b" " * (-len(text) % _WORD)
        return b"".join([len(text).to_bytes(_WORD, "little"), text, *parts])


def said(kind: str, *words: str, number: int = 0) -> Message:
    """A message of sentences; with the number of the request that it answers, if any."""
    return Message(kind, {"said": list(words), "number": number})


Kind = Literal["follow", "solve", "scene"]
_KEYS = {"number", "kind", "values"}
_MOST = 2**53  # whole numbers that a browser counts to


@dataclass(frozen=True)
class Request:
    """A request of a page.

    Attributes:
        number: That the page counts its requests by.
        kind: ``follow``: a quick answer; ``solve``: a whole one; ``scene``: the scene's text.
        changes: Key → value, of keys that are shown.
    """

    number: int
    kind: Kind
    changes: Mapping[str, Any]


def read_request(text: str | bytes, keys: Sequence[MovedKey]) -> Request:
    """A request of the page, if it is one that may be made.

    Args:
        text: As it was sent.
        keys: That are shown; no other part of a scene can be moved.

    Raises:
        ValueError: It is not; says why.
    """
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError("not a request: no JSON") from None
    if not isinstance(found, dict) or set(found) != _KEYS:
        raise ValueError("not a request: it has number, kind and values, and nothing else")
    number, kind, values = found["number"], found["kind"], found["values"]
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number <= _MOST:
        raise ValueError("not a request: number counts requests")
    if kind not in get_args(Kind):
        raise ValueError(f"not a request: kind is one of {', '.join(get_args(Kind))}")
    if not isinstance(values, dict):
        raise ValueError("not a request: values has keys and numbers")
    shown = {one.key: one for one in keys}
    for key in values:
        if key not in shown:
            raise ValueError(f"'{key[:60]}' is not one of the keys that are shown")
    changes = {key: shown[key].taken(value) for key, value in values.items()}
    return Request(number, cast(Kind, kind), changes)


class Exchange:
    """Requests on their way from the pages to the thread that solves.

    Of each page the latest alone waits: what it asked for before is out of date.

    Args:
        called: What to call when a request comes, by whichever thread brings it.
    """

    def __init__(self, called: Callable[[], None] = lambda: None) -> None:
        self._changed = threading.Condition()
        self._waiting: dict[int, Request] = {}
        self._called = called

    def put(self, page: int, request: Request) -> None:
        """Have a page's request answered, in place of what it asked for before."""
        with self._changed:
            self._waiting.pop(page, None)  # so that a busy page does not keep others waiting
            self._waiting[page] = request
            self._changed.notify()
        self._called()

    def take(self, seconds: float = 0.0) -> tuple[int, Request] | None:
        """The page and the request that have waited longest; None if there is none in time."""
        with self._changed:
            if not self._waiting and seconds > 0:
                self._changed.wait(seconds)
            page = next(iter(self._waiting), None)
            return None if page is None else (page, self._waiting.pop(page))

    def has_newer(self, page: int) -> bool:
        """Whether a page has asked for something else meanwhile."""
        with self._changed:
            return page in self._waiting

    def forget(self, page: int) -> None:
        """Answer a page no more."""
        with self._changed:
            self._waiting.pop(page, None)
