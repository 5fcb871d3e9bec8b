"""The 3-D torus: where PEs sit, how far apart, and which links and ports lie between two of them.

Contention is virtual cut-through with unbounded buffers (Kermani and Kleinrock 1979, Virtual
cut-through: a new computer communication switching technique, Computer Networks 3, 267-286), the
way dimension-order routing as on the T3E (Scott and Thorson 1996, The Cray T3E network: adaptive
routing in a high performance 3D torus, Hot Interconnects IV; its adaptive routing is left out).

The head of a message takes its source's injection port, the directed links of dimension-order
routing and its destination's ejection port. Each serves whoever comes first: the head waits until
it is free, then it is busy for the time of the message's bytes (a port at least for the machine's
gap between messages), while the head goes on. From the
injection port to the first link the head takes the machine's latency (as every message pays it once
between ports, anywhere else would give the same arrivals), over each link the hop latency. Heads
that come at the same instant are served by (source, send number).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.machine.machine import Machine
from simmpp.machine.transfer import slower

CONTENTIONS = NO_CONTENTION, LINKS = ("none", "links")
"""What messages wait for: nothing, or links and ports."""
X, Y, Z, PORTS = 0, 2, 4, 6
"""First of the two rows of each kind in the 8 of a PE: links towards + and -, injection and
ejection port."""
ROWS_PER_PE = 8
DIRECTIONS = ("+x", "-x", "+y", "-y", "+z", "-z")
"""Of a PE's links, in the order of their rows."""


@dataclass(frozen=True)
class Torus:
    """A torus as a ``topology``."""

    sizes: tuple[int, int, int]
    """PEs along x, y, z; PE k = x + X (y + Y z)."""
    latency_ps: int
    """For each message."""
    hop_latency_ps: int
    """For each link."""
    bytes_per_s: int
    """Of links and ports, the slower of both."""
    gap_ps: int
    """For which a port is busy at least."""

    @classmethod
    def of(cls, machine: Machine) -> Torus:
        """That of a machine."""
        return cls(
            machine.shape,
            machine.latency_ps,
            machine.hop_latency_ps,
            slower(machine.link_bytes_per_s, machine.injection_bytes_per_s),
            machine.port_gap_ps,
        )

    def __str__(self) -> str:
        return " x ".join(map(str, self.sizes))

    @property
    def pe_count(self) -> int:
        """PEs that it joins."""
        return prod(self.sizes)

    @property
    def n_links(self) -> int:
        """Links and ports that serve one message at a time."""
        return ROWS_PER_PE * self.pe_count

    @property
    def diameter(self) -> int:
        """Most links between two PEs."""
        return across(self.sizes)

    @property
    def longest_ps(self) -> int:
        """Latency between the two PEs that are farthest from each other."""
        return self.latency_ps + self.diameter * self.hop_latency_ps

    @property
    def rates(self) -> list[int]:
        """Bandwidths that messages may have."""
        return [self.bytes_per_s]

    @property
    def numbers(self) -> list[int]:
        """What the compiled functions know."""
        return [*self.sizes, self.latency_ps, self.hop_latency_ps, self.bytes_per_s, self.gap_ps]

    def by_link(self, of_rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """What there is of each row by PE and DIRECTIONS: (nb, 6), without the ports."""
        return of_rows.reshape(-1, ROWS_PER_PE)[:, : len(DIRECTIONS)]


@kernel
def port(pe: int, out: int) -> int:
    """Row of the port through which messages enter the network from a PE (0) or leave it (1)."""
    return pe * ROWS_PER_PE + PORTS + out


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


@kernel
def _link(here: int, row: int, stride: int, size: int, at: int, to: int) -> tuple[int, int]:
    """The link from coordinate ``at`` of a ring of ``size`` on the way to another one."""
    forward = to - at if to > at else to - at + size
    if 2 * forward > size:
        return here * ROWS_PER_PE + row + 1, here + (stride * (size - 1) if at == 0 else -stride)
    return here * ROWS_PER_PE + row, here + (stride * (1 - size) if at + 1 == size else stride)


def default_shape(processors: int) -> tuple[int, int, int]:
    """The most cubic torus of that many PEs: X >= Y >= Z with the least X + Y + Z.

    Source: near-cubic partitions of the T3E (ESTIMATE: real ones also held system PEs).
    """
    shapes = (
        (processors // (y * z), y, z)
        for z in range(1, round(processors ** (1 / 3)) + 2)
        if processors % z == 0
        for y in range(z, processors // z + 1)
        if y * y * z <= processors and processors % (y * z) == 0
    )
    return min(shapes, key=lambda shape: (sum(shape), shape))


def rounder(processors: int) -> list[int]:
    """The nearest numbers of PEs, below and above, whose torus is at most half as far across.

    None are looked for beyond an eighth of the number; none if it has a round torus itself.
    """
    most, reach = across(default_shape(processors)) // 2, processors // 8
    found = []
    for way in (-1, 1):
        near = (processors + way * n for n in range(1, reach + 1))
        found += [nb for nb in near if across(default_shape(nb)) <= most][:1]
    return found


def across(shape: tuple[int, int, int]) -> int:
    """Most links between two PEs of a torus."""
    return sum(size // 2 for size in shape)


@kernel
def ring_distance(size: int, a: int, b: int) -> int:
    """Hops from a to b on a ring of ``size`` PEs, the shortest way round."""
    forward = abs(b - a)
    return min(forward, size - forward)


@njit
def hops(x_size: int, y_size: int, z_size: int, source: int, destination: int) -> int:
    """Links that a message crosses the shortest way round; PE k = x + X (y + Y z)."""
    source_row, destination_row = source // x_size, destination // x_size
    return (
        ring_distance(x_size, source % x_size, destination % x_size)
        + ring_distance(y_size, source_row % y_size, destination_row % y_size)
        + ring_distance(z_size, source_row // y_size, destination_row // y_size)
    )
