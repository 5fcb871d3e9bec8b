"""Links and ports that serve one message at a time: virtual cut-through with unbounded buffers.

The head of a message takes its source's injection port, the directed links of dimension-order
routing and its destination's ejection port. Each serves whoever comes first: the head waits until
it is free, then it is busy for the time of the message's bytes, while the head goes on.
"""

from __future__ import annotations

from simmpp.compiled import njit

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
    stride, axis = 1, X
    for size in shape:
        at, to = here // stride % size, destination // stride % size
        if at != to:
            is_back = 1 if 2 * ((to - at) % size) > size else 0
            there = (at + (size - 1 if is_back else 1)) % size
            return here * ROWS_PER_PE + axis + is_back, here + (there - at) * stride
        stride *= size
        axis += 2
    return ejection_port(here), here
