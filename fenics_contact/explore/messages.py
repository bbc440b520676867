"""Messages to the page: a header in JSON, then arrays as they are in memory."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
