"""Philox4x32-10 against its published answers, and against the package's numpy by way of a third.

numpy has Philox of 64-bit words only. The cipher written below for words of any width gives numpy's
numbers with 64 bits and must give the kernel's with 32.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.workload.trace.path.philox import numbers, philox

CONSTANTS = {
    32: ((0xD2511F53, 0xCD9E8D57), (0x9E3779B9, 0xBB67AE85)),
    64: (
        (0xD2E7470EE14C6C93, 0xCA5A826395121157),
        (0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B),
    ),
}
"""Multipliers and steps of the key (Salmon et al. 2011)."""


def slowly(counter: list[int], key: list[int], bits: int) -> list[int]:
    multipliers, steps = CONSTANTS[bits]
    below = 2**bits
    (a, b, c, d), (k, m) = counter, key
    for _ in range(10):
        one, other = multipliers[0] * a, multipliers[1] * c
        a, b, c, d = other // below ^ b ^ k, other % below, one // below ^ d ^ m, one % below
        k, m = (k + steps[0]) % below, (m + steps[1]) % below
    return [a, b, c, d]


@njit
def _blocks(words: NDArray[np.uint64], blocks: NDArray[np.uint64]) -> None:
    for i in range(len(words)):
        w = words[i]
        blocks[i, 0], blocks[i, 1], blocks[i, 2], blocks[i, 3] = philox(
            (w[4], w[5]), (w[0], w[1], w[2], w[3])
        )


@njit
def _numbers(places: NDArray[np.int64], drawn: NDArray[np.float64]) -> None:
    for i in range(len(places)):
        p = places[i]
        drawn[i, 0], drawn[i, 1], drawn[i, 2], drawn[i, 3] = numbers(p[0], p[1], p[2], p[3])


def blocks_of(words: list[list[int]]) -> list[list[int]]:
    blocks = np.zeros((len(words), 4), np.uint64)
    _blocks(np.array(words, np.uint64), blocks)
    return blocks.tolist()


PUBLISHED = [
    ([0] * 6, [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8]),
    ([0xFFFFFFFF] * 6, [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD]),
    (
        [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344, 0xA4093822, 0x299F31D0],
        [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
    ),
]
"""Counter and key, and the block: Random123's known answers of philox4x32 with 10 rounds."""


@pytest.mark.parametrize(("words", "block"), PUBLISHED)
def test_published_answers(words: list[int], block: list[int]) -> None:
    assert blocks_of([words]) == [block]


def test_words_of_any_width() -> None:
    rng = np.random.default_rng(7)
    for _ in range(20):
        counter = rng.integers(0, 2**63, 4).tolist()
        key = rng.integers(0, 2**63, 2).tolist()
        bits = np.random.Philox(counter=counter, key=key)
        counter[0] += 1  # numpy counts before it draws
        assert bits.random_raw(4).tolist() == slowly(counter, key, 64)
    words = rng.integers(0, 2**32, (200, 6)).tolist()
    assert blocks_of(words) == [slowly(row[:4], row[4:], 32) for row in words]


def test_numbers_lie_evenly_between_0_and_1() -> None:
    """Each in its place: by seed, root, event and dimension; 4 sigma of mean and of square."""
    places = np.array([(s, r, e, d) for s in (0, 9) for r in range(200) for e in range(20)
                       for d in range(3)])  # fmt: skip
    drawn = np.zeros((len(places), 4))
    _numbers(places, drawn)
    assert len(np.unique(drawn)) > 0.999 * drawn.size
    assert drawn.min() > 0
    assert drawn.max() < 1
    for power, mean, variance in ((1, 1 / 2, 1 / 12), (2, 1 / 3, 4 / 45)):
        off = (drawn**power).mean(axis=0) - mean
        assert (np.abs(off) < 4 * (variance / len(drawn)) ** 0.5).all()
    again = np.zeros((1, 4))
    _numbers(np.array([[2**32 - 1, 2**31 - 1, 5, 1]]), again)
    a, b, c, d = slowly([5, 1, 0, 0], [2**32 - 1, 2**31 - 1], 32)
    assert again[0].tolist() == [(word + 0.5) / 2**32 for word in (a, b, c, d)]
