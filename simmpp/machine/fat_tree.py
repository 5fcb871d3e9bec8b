"""The fat-tree: switches whose links up are as many as those down, or fewer by a factor.

Each PE has one link to a switch of level 1, and each switch ``arity`` links down; below the top it
has arity / oversubscription links up, each to another switch (a k-ary n-tree; Petrini and Vanneschi
1997, k-ary n-trees: high performance networks for massively parallel architectures). PEs are
numbered below the switches one after the other; the last ones may be left out.

A message goes up to the first level from which its destination can be reached and down again. The
destination alone says which way up: link (PE / links up below) mod links up (d-mod-k; Zahavi 2012,
Fat-tree routing and node ordering providing contention free traffic for MPI global collectives).
Switches that route adaptively would spread messages further.

With contention links are as on the torus. The links of the PEs are their ports: no other's messages
take them, so a head that has waited there waits nowhere else on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.common.errors import ConfigError
from simmpp.common.units import counted
from simmpp.machine.machine import FatTree, Machine
from simmpp.machine.transfer import slower

# What compiled code knows, behind the number of the topology; then of each level of switches.
_LATENCY, _HOP, _RATE, _GAP = range(1, 5)
_FIRST, _EACH = 5, 3
_REACH, _COPIES, _ROW = range(_EACH)
_UP, _DOWN = 0, 1
_FAR = 1 << 40
"""More PEs than there are."""

Network = NDArray[np.int64]
"""As ``topology.Network``."""


@dataclass(frozen=True)
class Tree:
    """A fat-tree as a ``topology``."""

    pe_count: int
    """PEs that it joins."""
    shape: FatTree
    """Of which at least the arity is given."""
    latency_ps: int
    """For each message."""
    hop_latency_ps: int
    """For each link."""
    bytes_per_s: int
    """Of links and ports, the slower of both."""
    gap_ps: int
    """For which the link of a PE is busy at least."""

    @classmethod
    def of(cls, machine: Machine) -> Tree:
        """That of a machine.

        Raises ConfigError, with the key, for one that can't be.
        """
        _check(machine.fat_tree, machine.processors)
        return cls(
            machine.processors,
            machine.fat_tree,
            machine.latency_ps,
            machine.hop_latency_ps,
            slower(machine.link_bytes_per_s, machine.injection_bytes_per_s),
            machine.port_gap_ps,
        )

    def __str__(self) -> str:
        of = self.shape
        ratio = f", {of.oversubscription}:1 at each" if of.oversubscription > 1 else ""
        return f"fat-tree of {counted(self.n_levels, 'level')}, arity {of.arity}{ratio}"

    @property
    def n_levels(self) -> int:
        """Levels of switches."""
        return self.shape.levels or self.height

    @property
    def height(self) -> int:
        """Level from which all PEs can be reached."""
        return next(n for n in range(1, 64) if self.shape.arity**n >= self.pe_count)

    @property
    def reaches(self) -> list[int]:
        """PEs below a switch of each level, if none is left out."""
        return [min(self.shape.arity**n, _FAR) for n in range(1, self.n_levels + 1)]

    @property
    def copies(self) -> list[int]:
        """Switches of the next level that a level's switches of one place lead to together.

        No more than PEs, of which each chooses one.
        """
        ups = self.shape.arity // self.shape.oversubscription
        return [min(ups**n, self.pe_count) for n in range(1, self.n_levels + 1)]

    @property
    def first_rows(self) -> list[int]:
        """Row of the first link up from each level but the top, and of what follows the last."""
        rows = [2 * self.pe_count]
        for reach, copies in zip(self.reaches[:-1], self.copies[:-1], strict=True):
            rows.append(rows[-1] + 2 * copies * -(-self.pe_count // reach))
        return rows

    @property
    def n_links(self) -> int:
        """Links, up and down."""
        return self.first_rows[-1]

    @property
    def diameter(self) -> int:
        """Most links between two PEs."""
        return 2 * self.height

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
        each = zip(self.reaches, self.copies, self.first_rows, strict=True)
        of_levels = [number for level in each for number in level]
        return [self.latency_ps, self.hop_latency_ps, self.bytes_per_s, self.gap_ps, *of_levels]

    def by_link(self, of_rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """What there is of each link between switches: (links, 2), up and down."""
        return of_rows.reshape(-1, 2)[self.pe_count :]


def _check(shape: FatTree, processors: int) -> None:
    if shape.arity < 2:
        raise ConfigError("missing key 'arity', of at least 2", where="fat_tree")
    if shape.oversubscription < 1 or shape.arity % shape.oversubscription:
        problem = f"value {shape.oversubscription}: expected a divisor of the arity {shape.arity}"
        raise ConfigError(problem, where="fat_tree.oversubscription")
    if shape.levels < 0 or (shape.levels and shape.arity**shape.levels < processors):
        problem = f"value {shape.levels}: expected room for {processors} PEs, not {shape.arity}"
        raise ConfigError(f"{problem} ^ {shape.levels}", where="fat_tree.levels")


# --- what compiled code asks; places of a head between PEs are negative: see _place ---


@kernel
def level_of(network: Network, source: int, destination: int) -> int:
    """The lowest level, from 1, from whose switches both PEs can be reached."""
    level = 1
    while True:
        reach = network[_FIRST + (level - 1) * _EACH + _REACH]
        if source // reach == destination // reach:
            return level
        level += 1


@kernel
def hops(network: Network, source: int, destination: int) -> int:
    """Links that a message crosses."""
    return 0 if source == destination else 2 * level_of(network, source, destination)


@kernel
def _place(level: int, way: int) -> int:
    """Of a head that comes to a link between a level and the next one, up or down: below 0."""
    return -1 - (2 * level + way)


@kernel
def enter(network: Network, source: int, destination: int) -> tuple[int, int]:
    """Where a head is behind its PE's port, and what it takes to the next link or port from there.

    The hops of both PEs' own links are paid here, as the latency is: all messages pay them.
    """
    behind_ps = network[_LATENCY] + 2 * network[_HOP]
    if level_of(network, source, destination) == 1:
        return destination, behind_ps
    return _place(1, _UP), behind_ps


@kernel
def next_link(network: Network, source: int, place: int, destination: int) -> tuple[int, int, int]:
    """Row of the link that a head is at, the next place, and how long it is on the way there."""
    level, way = (-1 - place) // 2, (-1 - place) % 2
    at = _FIRST + (level - 1) * _EACH
    pe = source if way == _UP else destination
    copies = network[at + _COPIES]
    link = (pe // network[at + _REACH]) * copies + destination % copies
    row = network[at + _ROW] + 2 * link + way
    if way == _UP:
        if level_of(network, source, destination) > level + 1:
            return row, _place(level + 1, _UP), network[_HOP]
        return row, _place(level, _DOWN), network[_HOP]
    return row, _place(level - 1, _DOWN) if level > 1 else destination, network[_HOP]
