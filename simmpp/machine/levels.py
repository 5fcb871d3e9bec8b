"""Blocks of PEs in larger blocks: node, group, system; with one level, a crossbar.

A message goes as far out as the innermost block that has both PEs: that block's *level* says its
latency and its bandwidth, whatever lies between. PEs are numbered block by block, so a block is
some that follow each other; the last one may have fewer.

With contention a message leaves its PE and then each block that does not have both by one of that
block's ports, and enters those of its destination likewise. A port serves whoever comes first, for
the time of the message's bytes at the bandwidth of the port's own level, or for the level's gap if
that is longer; the head goes on meanwhile. Between the last port out and the first one in the head
takes the latency, and from the last port on the message arrives at the bandwidth of its own level:
alone, a message takes the same time with contention and without. Which port of a block is the PE's
number within it modulo the ports, as of nodes with a network card for each accelerator.

Source: the nodes of Alps have four accelerators and four cards (CSCS, docs/alps/hardware.md); what
lies outside of a block is a crossbar here, where adaptive routing would spread messages.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from math import prod

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.common.errors import ConfigError
from simmpp.machine.machine import Level, Machine
from simmpp.machine.transfer import transfer_ps

# What compiled code knows of each level, one after the other, behind the number of the topology.
_EACH = 9
_BLOCK, _INNER, _LATENCY, _RATE, _GAP, _PORTS, _ROW, _SEND, _RECEIVE = range(1, 1 + _EACH)
_OUT, _IN = 0, 1


Network = NDArray[np.int64]
"""As ``topology.Network``."""


@dataclass(frozen=True)
class Blocks:
    """Levels as a ``topology``."""

    pe_count: int
    """PEs that they join."""
    levels: tuple[Level, ...]
    """The innermost first."""

    @classmethod
    def of(cls, machine: Machine) -> Blocks:
        """Those of a machine.

        Raises ConfigError, with the key, for levels that can't be.
        """
        _check(machine.levels, machine.processors)
        return cls(machine.processors, machine.levels)

    def __str__(self) -> str:
        sizes = [*(level.size for level in self.levels[:-1]), self.n_blocks[-1]]
        named = zip(self.levels, sizes, strict=True)
        return ", ".join(f"{level.name} of {size}" for level, size in named)

    @property
    def block_sizes(self) -> list[int]:
        """PEs in a block of each level; the outermost has all."""
        sizes = accumulate((level.size for level in self.levels[:-1]), int.__mul__)
        return [*(min(size, self.pe_count) for size in sizes), self.pe_count]

    @property
    def n_blocks(self) -> list[int]:
        """What the ports of each level belong to: PEs, then blocks of the level below."""
        return [-(-self.pe_count // inner) for inner in (1, *self.block_sizes[:-1])]

    @property
    def first_rows(self) -> list[int]:
        """Row of the first port of each level, and of what follows the last."""
        ports = (2 * n * level.ports for n, level in zip(self.n_blocks, self.levels, strict=True))
        return [*accumulate(ports, initial=0)]

    @property
    def n_links(self) -> int:
        """Ports, in and out."""
        return self.first_rows[-1]

    @property
    def diameter(self) -> int:
        """The outermost level, counted from 1."""
        return len(self.levels)

    @property
    def longest_ps(self) -> int:
        """Latency between the two PEs that are farthest from each other."""
        return max(level.latency_ps for level in self.levels)

    @property
    def rates(self) -> list[int]:
        """Bandwidths that messages may have."""
        return [level.bytes_per_s for level in self.levels]

    @property
    def numbers(self) -> list[int]:
        """What the compiled functions know."""
        sizes = self.block_sizes
        each = zip(sizes, [1, *sizes], self.levels, self.first_rows, strict=False)
        return [
            number
            for block, inner, level, row in each
            for number in (block, inner, level.latency_ps, level.bytes_per_s, level.gap_ps,
                           level.ports, row, level.send_startup_ps, level.receive_startup_ps)
        ]  # fmt: skip

    def by_link(self, of_rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """What there is of each port beyond those of PEs: (ports, 2), out and in."""
        return of_rows.reshape(-1, 2)[self.pe_count :]


def _check(levels: tuple[Level, ...], processors: int) -> None:
    if not levels:
        problem = "expected at least one level, such as {system: {latency: 1 us}}"
        raise ConfigError(problem, where="levels")
    for level in levels[:-1]:
        if level.size < 1:
            problem = "missing key 'size': only the outermost level has all there are"
            raise ConfigError(problem, where=f"levels.{level.name}")
    if levels[0].ports != 1:
        problem = f"value {levels[0].ports}: expected none, for a PE has one port"
        raise ConfigError(problem, where=f"levels.{levels[0].name}.ports")
    room = prod(level.size for level in levels)
    if levels[-1].size and room < processors:
        problem = f"value {levels[-1].size}: expected room for {processors} PEs, not for {room}"
        raise ConfigError(problem, where=f"levels.{levels[-1].name}.size")


# --- what compiled code asks; places of a head between PEs are negative: see _place ---


@kernel
def level_of(network: Network, source: int, destination: int) -> int:
    """Index of the innermost level whose block has both PEs."""
    level = 0
    while True:
        block = network[level * _EACH + _BLOCK]
        if source // block == destination // block:
            return level
        level += 1


@kernel
def hops(network: Network, source: int, destination: int) -> int:
    """The level that a message goes out to, from 1."""
    return 0 if source == destination else 1 + level_of(network, source, destination)


@kernel
def latency_ps(network: Network, source: int, destination: int) -> int:
    """What the head of a message takes where it does not wait."""
    return network[level_of(network, source, destination) * _EACH + _LATENCY]


@kernel
def bytes_per_s(network: Network, source: int, destination: int) -> int:
    """Bandwidth between two PEs."""
    return network[level_of(network, source, destination) * _EACH + _RATE]


@kernel
def send_startup_ps(network: Network, source: int, destination: int) -> int:
    """What any message between two PEs costs its sender."""
    return network[level_of(network, source, destination) * _EACH + _SEND]


@kernel
def receive_startup_ps(network: Network, source: int, destination: int) -> int:
    """What it costs its receiver."""
    return network[level_of(network, source, destination) * _EACH + _RECEIVE]


@kernel
def held_ps(network: Network, level: int, n_bytes: int) -> int:
    """How long a message keeps a port of a level busy."""
    at = level * _EACH
    return max(network[at + _GAP], transfer_ps(n_bytes, network[at + _RATE]))


@kernel
def _place(level: int, way: int) -> int:
    """Of a head that comes to a port of a level, out of a block or into one: below 0."""
    return -1 - (2 * level + way)


@kernel
def enter(network: Network, source: int, destination: int) -> tuple[int, int]:
    """Where a head is behind its PE's port, and what it takes to the next one from there."""
    if level_of(network, source, destination) == 0:
        return destination, network[_LATENCY]
    return _place(1, _OUT), 0


@kernel
def next_port(
    network: Network, source: int, place: int, destination: int, n_bytes: int
) -> tuple[int, int, int, int]:
    """Row of the port that a head is at; the next place; how long it is busy, and the way there."""
    level, way = (-1 - place) // 2, (-1 - place) % 2
    at = level * _EACH
    pe = source if way == _OUT else destination
    inner, ports = network[at + _INNER], network[at + _PORTS]
    block = pe // inner
    row = network[at + _ROW] + 2 * (block * ports + (pe - block * inner) % ports) + way
    busy_ps = held_ps(network, level, n_bytes)
    if way == _OUT:
        if level_of(network, source, destination) > level:
            return row, _place(level + 1, _OUT), busy_ps, 0
        return row, _place(level, _IN), busy_ps, network[at + _LATENCY]
    return row, _place(level - 1, _IN) if level > 1 else destination, busy_ps, 0
