"""What ranks get to know of each other in a run, in bytes."""

from __future__ import annotations

import pickle
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fenics_contact.common import parallel

GATHERINGS = ("_to_every_rank", "_to_root", "_received", "_from_root", "_summed")


class Traffic:
    """Counts what this rank holds after each gathering.

    Attributes:
        largest: By the function that gathered, the most bytes that one gathering left.
        total: Bytes of all gatherings.
    """

    def __init__(self) -> None:
        self.largest: dict[str, int] = defaultdict(int)
        self.total = 0

    def take(self, found: object) -> None:
        """Count what a gathering gave."""
        size, name = len(pickle.dumps(found)), _caller()
        self.largest[name] = max(self.largest[name], size)
        self.total += size

    @property
    def peak(self) -> int:
        """The most bytes that one gathering left."""
        return max(self.largest.values(), default=0)


def _caller() -> str:
    frame = sys._getframe(1)
    while frame and Path(frame.f_code.co_filename).stem in ("traffic", "parallel"):
        frame = frame.f_back
    assert frame is not None
    return f"{Path(frame.f_code.co_filename).stem}.{frame.f_code.co_name}"


@contextmanager
def counted() -> Iterator[Traffic]:
    """Count all gatherings meanwhile; they all go through one module of the program."""
    traffic, before = Traffic(), {name: getattr(parallel, name) for name in GATHERINGS}

    def counting(name: str):
        def gather(comm, *given):
            found = before[name](comm, *given)
            traffic.take(found)
            return found

        return gather

    for name in GATHERINGS:
        setattr(parallel, name, counting(name))
    try:
        yield traffic
    finally:
        for name, own in before.items():
            setattr(parallel, name, own)
