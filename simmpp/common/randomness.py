"""Named random streams of one root seed: a draw depends on its name, never on what ran before."""

from __future__ import annotations

import hashlib

import numpy as np


def generator(seed: int, stream: str, pe: int = 0) -> np.random.Generator:
    """The generator of SeedSequence(seed, stream name, PE)."""
    name = int.from_bytes(hashlib.sha256(stream.encode()).digest()[:8], "little")
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, name, pe])))


def key(seed: int, stream: str) -> int:
    """A 63-bit key of SeedSequence(seed, stream name), for numbers that are drawn by counting."""
    name = int.from_bytes(hashlib.sha256(stream.encode()).digest()[:8], "little")
    return int(np.random.SeedSequence([seed, name]).generate_state(1, np.uint64)[0]) >> 1
