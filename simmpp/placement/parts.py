"""Cutting a row of things into near-equal parts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def cut(n: int, parts: int) -> NDArray[np.int32]:
    """The part of each of n things in a row, cut at floor(i n / parts): (n,) int32."""
    cuts = np.arange(parts + 1, dtype=np.int64) * n // parts
    return np.repeat(np.arange(parts, dtype=np.int32), np.diff(cuts))
