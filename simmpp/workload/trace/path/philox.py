"""Random numbers by counting: a function of where they are used, never of what was drawn before.

Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3"), keyed by the seed
and the number of the root. A path is the same whoever computes it, in whatever order.
"""

from __future__ import annotations

import numpy as np

from simmpp.common.compiled import kernel

ROUNDS = 10
MULTIPLIERS = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
STEPS = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
"""What the key grows by from round to round."""
LOW, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)
Word = np.uint64
Block = tuple[Word, Word, Word, Word]
"""Four words of 32 bits, each in one of 64, so that products are whole."""


@kernel
def philox(key: tuple[Word, Word], counter: Block) -> Block:
    """The block that the cipher makes of a counter."""
    (k, m), (a, b, c, d) = key, counter
    for _ in range(ROUNDS):
        one, other = MULTIPLIERS[0] * a, MULTIPLIERS[1] * c
        a, c = (other >> HALF) ^ b ^ k, (one >> HALF) ^ d ^ m
        b, d = other & LOW, one & LOW
        k, m = (k + STEPS[0]) & LOW, (m + STEPS[1]) & LOW
    return a, b, c, d


@kernel
def numbers(seed: int, root: int, event: int, dimension: int) -> tuple[float, float, float, float]:
    """Four numbers above 0 and below 1, each a multiple of 2^-33.

    ``event`` counts along a path, ``dimension`` the blocks that one event takes.
    """
    key = np.uint64(seed), np.uint64(root)
    zero = np.uint64(0)
    a, b, c, d = philox(key, (np.uint64(event), np.uint64(dimension), zero, zero))
    return _between(a), _between(b), _between(c), _between(d)


@kernel
def _between(word: Word) -> float:
    return (float(word) + 0.5) * 2.0**-32
