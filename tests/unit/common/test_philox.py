"""Draws by counting are numpy's."""

from __future__ import annotations

import numpy as np
import pytest

from simmpp.common.compiled import njit
from simmpp.common.philox import philox
from simmpp.common.randomness import key


@njit
def draw(seed: int, stream: int, counter: int) -> int:
    return philox(seed, stream, counter)


@pytest.mark.parametrize("seed", [0, 1, key(4711, "policy")])
def test_draws_are_those_of_numpy(seed: int) -> None:
    for stream in (0, 1, 63):
        for counter in (1, 2, 10**12):
            bits = np.random.Philox(key=[seed, stream], counter=counter - 1)
            assert draw(seed, stream, counter) == bits.random_raw() >> 1


def test_keys_differ_by_seed_and_name() -> None:
    keys = {key(seed, name) for seed in range(50) for name in ("policy", "other")}
    assert len(keys) == 100
    assert all(0 <= each < 1 << 63 for each in keys)
