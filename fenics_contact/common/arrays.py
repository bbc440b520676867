"""Names of numpy's arrays by what they hold, and vectors of 2D with a third component."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]
AnyIntegers = NDArray[np.integer[Any]]
Words = NDArray[np.str_]
# Of the entries of an array that may be of any of these.
Kind = TypeVar("Kind", bound=np.generic)


def in_3d(vectors: Array | Sequence[complex]) -> Array:
    """Vectors (..., components) with zeros up to three components, (..., 3)."""
    values = np.asarray(vectors)
    found: Array = np.zeros((*values.shape[:-1], 3), dtype=np.result_type(values, float))
    found[..., : values.shape[-1]] = values
    return found
