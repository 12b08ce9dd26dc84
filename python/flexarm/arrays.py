"""Arrays of results: doubles that nobody writes to."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer[Any]]


def frozen(values: ArrayLike) -> Floats:
    """Return a read-only copy."""
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


def read_only(values: Floats) -> Floats:
    """Return the same numbers in their place, read-only from here: for arrays that nobody else writes to."""
    view = values.view()
    view.setflags(write=False)
    return view
