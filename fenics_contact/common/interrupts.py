"""Ctrl-C and SIGTERM: the first asks the run to stop in good order, the second kills it."""

from __future__ import annotations

import os
import signal
from types import FrameType, TracebackType
from typing import Any, ClassVar

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_MESSAGE = "\nfenics-contact: stopping at the last {} that is done; again to kill\n"


class Interrupts:
    """While entered, signals only set a mark on this rank; handlers of before come back.

    Args:
        what: Of what the last that is done is kept.
    """

    entered: ClassVar[list[Interrupts]] = []

    def __init__(self, what: str = "load step") -> None:
        self._message = _MESSAGE.format(what).encode()
        self._requested = False
        self._before: dict[signal.Signals, Any] = {}

    def requested(self) -> bool:
        """Whether this rank was asked to stop."""
        return self._requested

    def __enter__(self) -> Interrupts:
        for number in _SIGNALS:
            self._before[number] = signal.signal(number, self._handle)
        self.entered.append(self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.entered.remove(self)
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._requested:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
        self._requested = True
        os.write(2, self._message)


def requested() -> bool:
    """Whether this rank was asked to stop, for what is called while it waits for something."""
    return any(found.requested() for found in Interrupts.entered)
