"""A workload's arrays can't be changed; those that it was made of stay the caller's."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from simmpp.model.synthetic import synthetic
from simmpp.workload.workload import frozen


def test_the_callers_arrays_stay_writable() -> None:
    mine = np.full(6, 8, np.int64)
    workload = frozen(dataclasses.replace(synthetic(4, 2, 6), object_bytes=mine))
    mine[0] = 9
    with pytest.raises(ValueError, match="read-only"):
        workload.object_bytes[0] = 9
    assert workload.object_bytes.flags.c_contiguous
