"""What is recorded of rays, and whether there is room for it: asked before minutes are spent."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.common.units import format_bytes

BYTES_PER_RAY = 100
"""Memory that every ray takes at least: two vectors with their temporaries, numbers."""
BYTES_PER_TEST = 8
"""An entry of an itinerary, twice while batches are joined."""
MOST_RAYS = 2**31 - 1
"""Ray numbers are int32."""
FEW = 1024
"""Paths from which the rays of all are estimated, within some per cent."""
LOWER = "a lower resolution"
GOLDEN = 2654435769
"""2^32 over the golden ratio: its multiples lie evenly, and on no rows or columns of a picture."""


class NoRoom(ConfigError):
    """More than this machine can hold; of a part there would be room."""


class Recorded(NamedTuple):
    """What is recorded of a run of rays, in workload order."""

    kinds: NDArray[np.uint8]
    parents: NDArray[np.int32]
    """Ray numbers; -1 for primary rays."""
    n_children: NDArray[np.int32]
    hits: NDArray[np.int32]
    distances: NDArray[np.float64]
    """Normalised."""
    n_tests: NDArray[np.int32]
    """Lengths of the itineraries."""
    objects: NDArray[np.int32]
    """The itineraries, one after the other."""


def few_roots(n_roots: int) -> NDArray[np.int32]:
    """A few roots from all over a picture, rising."""
    if n_roots <= FEW:
        return np.arange(n_roots, dtype=np.int32)
    places = np.arange(FEW, dtype=np.int64) * GOLDEN % 2**32
    return np.unique(places * n_roots >> 32).astype(np.int32)


def require_numbers(n_rays: int, name: str) -> None:
    """Raise ConfigError for more rays than can be numbered."""
    if n_rays > MOST_RAYS:
        problem = f"the picture has more than {MOST_RAYS} rays: lower its resolution or max_depth"
        raise ConfigError(problem, where=name)


def require_memory(n_primaries: int, name: str) -> None:
    """Refuse at once what would end in the system's killing the process, minutes later."""
    refuse(n_primaries * BYTES_PER_RAY, f"{n_primaries} primary rays take", LOWER, name)


def require_room(n_roots: int, few: list[Recorded], name: str) -> None:
    """Refuse paths of which all would take more than there is, by a few of them."""
    traced = sum(int((batch.parents < 0).sum()) for batch in few)
    share = n_roots / max(traced, 1)
    n_rays = int(share * sum(len(batch.kinds) for batch in few))
    n_tests = int(share * sum(len(batch.objects) for batch in few))
    if n_rays > 1.1 * MOST_RAYS:  # what is nearer is counted
        problem = f"{n_roots} paths have about {n_rays} rays, expected at most {MOST_RAYS}"
        raise ConfigError(f"{problem}: fewer samples, or a lower resolution", where=name)
    size, takes = n_rays * BYTES_PER_RAY + n_tests * BYTES_PER_TEST, f"{n_roots} paths take about"
    refuse(size, takes, f"fewer samples, or {LOWER}", name)


def refuse(size_bytes: int, takes: str, expected: str, name: str) -> None:
    """Raise NoRoom for more bytes than the machine has."""
    memory_bytes = _bytes_there_are()
    if memory_bytes is not None and size_bytes > memory_bytes:
        there = f"{takes} {format_bytes(size_bytes)}, there are {format_bytes(memory_bytes)}"
        raise NoRoom(f"{there}: expected {expected}", where=name)


def _bytes_there_are() -> int | None:
    """Of this machine's memory; None where the system does not say."""
    if not hasattr(os, "sysconf"):  # Windows
        return None
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
