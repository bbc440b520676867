"""Names of numpy's arrays by what they hold; docstrings give their shapes."""

from __future__ import annotations

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
