"""Names of numpy's arrays by what they hold; docstrings give their shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]
AnyIntegers = NDArray[np.integer[Any]]
Words = NDArray[np.str_]
