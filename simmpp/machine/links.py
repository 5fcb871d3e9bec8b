"""Links and ports that serve one message at a time: virtual cut-through with unbounded buffers.

A message takes its source's injection port, the directed links of dimension-order routing and its
destination's ejection port, each when it is free; then that is busy for the time of the message's
bytes, while its head goes on. Messages book their whole way when they depart: one that departed
later waits behind it even where it would get there first. What that hides is measured against
first-come-first-served links in ``experiments/accuracy/contention.py``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit_reading as njit

CONTENTIONS = NO_CONTENTION, LINKS = ("none", "links")
"""What messages wait for: nothing, or links and ports."""
X, Y, Z, PORTS = 0, 2, 4, 6
"""First of the two rows of each kind in the 8 of a PE: links towards + and -, injection and
ejection port."""
ROWS_PER_PE = 8


@njit
def book(
    free_ps: NDArray[np.int64],
    shape: tuple[int, int, int],
    source: int,
    destination: int,
    depart_ps: int,
    latency_ps: int,
    hop_latency_ps: int,
    busy_ps: int,
) -> int:
    """Let a message that occupies links for ``busy_ps`` depart; returns when it arrives.

    ``free_ps`` (8 nb,) int64, from when on each link and port is free, is brought up to date. The
    latency is paid behind the injection port; as all messages pay it once between ports, anywhere
    else would give the same arrivals.
    """
    head_ps = _occupy(free_ps, source * ROWS_PER_PE + PORTS, depart_ps, busy_ps) + latency_ps
    here, stride, axis = source, 1, X
    for size in shape:
        at, to = here // stride % size, destination // stride % size
        forward = (to - at) % size
        is_back = 1 if 2 * forward > size else 0
        step = size - 1 if is_back else 1
        for _ in range(size - forward if is_back else forward):
            link = here * ROWS_PER_PE + axis + is_back
            head_ps = _occupy(free_ps, link, head_ps, busy_ps) + hop_latency_ps
            following = (at + step) % size
            here += (following - at) * stride
            at = following
        stride *= size
        axis += 2
    return busy_ps + _occupy(free_ps, destination * ROWS_PER_PE + PORTS + 1, head_ps, busy_ps)


@njit
def _occupy(free_ps: NDArray[np.int64], row: int, head_ps: int, busy_ps: int) -> int:
    """Take a link or port when it is free; returns when that is."""
    start_ps = max(head_ps, free_ps[row])
    free_ps[row] = start_ps + busy_ps
    return start_ps
