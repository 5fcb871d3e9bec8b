"""Links and ports that serve one message at a time: virtual cut-through with unbounded buffers.

The head of a message takes its source's injection port, the directed links of dimension-order
routing and its destination's ejection port. Each serves whoever comes first: the head waits until
it is free, then it is busy for the time of the message's bytes, while the head goes on. From the
injection port to the first link the head takes the machine's latency (as every message pays it once
between ports, anywhere else would give the same arrivals), over each link the hop latency. Heads
that come at the same instant are served by (source, send number).
"""

from __future__ import annotations

from simmpp.compiled import njit_reading as njit

CONTENTIONS = NO_CONTENTION, LINKS = ("none", "links")
"""What messages wait for: nothing, or links and ports."""
X, Y, Z, PORTS = 0, 2, 4, 6
"""First of the two rows of each kind in the 8 of a PE: links towards + and -, injection and
ejection port."""
ROWS_PER_PE = 8


@njit
def injection_port(pe: int) -> int:
    """Its row."""
    return pe * ROWS_PER_PE + PORTS


@njit
def ejection_port(pe: int) -> int:
    """Its row."""
    return pe * ROWS_PER_PE + PORTS + 1


@njit
def link_towards(shape: tuple[int, int, int], here: int, destination: int) -> tuple[int, int]:
    """Row of the link that leads from a PE to another one's, and the PE behind that link.

    Dimension order x, y, z, the shortest way round, halfway towards +.
    """
    x_size, y_size, z_size = shape
    here_row, row_to = here // x_size, destination // x_size
    x, x_to = here - here_row * x_size, destination - row_to * x_size
    if x != x_to:
        return _link(here, X, 1, x_size, x, x_to)
    z, z_to = here_row // y_size, row_to // y_size
    y, y_to = here_row - z * y_size, row_to - z_to * y_size
    if y != y_to:
        return _link(here, Y, x_size, y_size, y, y_to)
    return _link(here, Z, x_size * y_size, z_size, z, z_to)


@njit
def _link(here: int, row: int, stride: int, size: int, at: int, to: int) -> tuple[int, int]:
    """The link from coordinate ``at`` of a ring of ``size`` on the way to another one."""
    forward = to - at if to > at else to - at + size
    if 2 * forward > size:
        return here * ROWS_PER_PE + row + 1, here + (stride * (size - 1) if at == 0 else -stride)
    return here * ROWS_PER_PE + row, here + (stride * (1 - size) if at + 1 == size else stride)
