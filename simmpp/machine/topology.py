"""Which PEs a network joins and how: one object, and functions that compiled code calls.

A further topology is a file like ``torus`` or ``levels``, a line in TOPOLOGIES, a branch in each
function here, and its word in ``machine.TOPOLOGY_NAMES``. Its links are drawn if
``report.run_figures`` knows how.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.common.errors import ConfigError
from simmpp.common.validate import require_word
from simmpp.machine import fat_tree, levels, torus
from simmpp.machine.machine import FAT_TREE, LEVELS, POLLED, TORUS, Machine

Network = NDArray[np.int64]
"""A topology as compiled code gets it: (n,) int64, its number in TOPOLOGIES and its own numbers."""


class Topology(Protocol):
    """A network with its constants."""

    @property
    def pe_count(self) -> int:
        """PEs that it joins."""

    @property
    def n_links(self) -> int:
        """Links and ports that serve one message at a time."""

    @property
    def diameter(self) -> int:
        """Most ``hops`` between two PEs."""

    @property
    def longest_ps(self) -> int:
        """Latency between the two PEs that are farthest from each other."""

    @property
    def rates(self) -> list[int]:
        """Bandwidths that messages may have; 0 is unlimited."""

    @property
    def numbers(self) -> list[int]:
        """What the compiled functions need to know."""

    def by_link(self, of_rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """What there is of each row (n_links,), of the links only, arranged for a drawing."""

    def __str__(self) -> str: ...


TOPOLOGIES: dict[str, Callable[[Machine], Topology]] = {
    TORUS: torus.Torus.of,
    LEVELS: levels.Blocks.of,
    FAT_TREE: fat_tree.Tree.of,
}
_TORUS, _LEVELS, _FAT_TREE = range(len(TOPOLOGIES))


def topology_of(machine: Machine) -> Topology:
    """The network of a machine.

    Raises ConfigError, with the key, where the machine can't have such a one.
    """
    require_word("topology", machine.topology, tuple(TOPOLOGIES))
    return TOPOLOGIES[machine.topology](machine)


def require_torus(machine: Machine) -> None:
    """Raise ConfigError for what the analytical model does not know: its PEs serve themselves."""
    for key, known in {"topology": TORUS, "service": POLLED}.items():
        if (value := getattr(machine, key)) != known:
            problem = f"value {value!r}: expected {known} for the paper's analytical model"
            raise ConfigError(problem, where=f"machine.{key}")


def network_of(topology: Topology) -> Network:
    """The same for compiled code."""
    kinds = {torus.Torus: _TORUS, levels.Blocks: _LEVELS, fat_tree.Tree: _FAT_TREE}
    return np.array([kinds[type(topology)], *topology.numbers], np.int64)


@kernel
def hops(network: Network, source: int, destination: int) -> int:
    """How far it is: links that a message crosses, or the level that it goes out to."""
    if network[0] == _TORUS:
        return torus.hops(network[1], network[2], network[3], source, destination)
    if network[0] == _LEVELS:
        return levels.hops(network, source, destination)
    return fat_tree.hops(network, source, destination)


@kernel
def latency_ps(network: Network, source: int, destination: int) -> int:
    """What the head of a message takes where it does not wait."""
    if network[0] == _TORUS:
        n_hops = torus.hops(network[1], network[2], network[3], source, destination)
        return network[4] + n_hops * network[5]
    if network[0] == _LEVELS:
        return levels.latency_ps(network, source, destination)
    return network[1] + fat_tree.hops(network, source, destination) * network[2]


@kernel
def bytes_per_s(network: Network, source: int, destination: int) -> int:
    """Bandwidth from one PE to another."""
    if network[0] == _TORUS:
        return network[6]
    if network[0] == _LEVELS:
        return levels.bytes_per_s(network, source, destination)
    return network[3]


@kernel
def send_startup_ps(network: Network, source: int, destination: int, else_ps: int) -> int:
    """What any message costs its sender: levels have their own, others ``else_ps``."""
    if network[0] == _LEVELS:
        return levels.send_startup_ps(network, source, destination)
    return else_ps


@kernel
def receive_startup_ps(network: Network, source: int, destination: int, else_ps: int) -> int:
    """Likewise its receiver."""
    if network[0] == _LEVELS:
        return levels.receive_startup_ps(network, source, destination)
    return else_ps


@kernel
def port(network: Network, pe: int, out: int) -> int:
    """Row of the port through which messages enter the network from a PE (0) or leave it (1)."""
    return torus.port(pe, out) if network[0] == _TORUS else 2 * pe + out


@kernel
def held_ps(network: Network, n_bytes: int, busy_ps: int) -> int:
    """How long a message keeps the port of a PE busy; ``busy_ps`` is what its bytes take."""
    if network[0] == _TORUS:
        return max(network[7], busy_ps)
    if network[0] == _LEVELS:
        return levels.held_ps(network, 0, n_bytes)
    return max(network[4], busy_ps)


@kernel
def enter(network: Network, source: int, destination: int) -> tuple[int, int]:
    """The node where the head of a message is behind its PE's port; the time from there on.

    Nodes are PEs and what lies between, as the topology numbers it. At its destination the head is
    before the port there.
    """
    if network[0] == _TORUS:
        return source, network[4]
    if network[0] == _LEVELS:
        return levels.enter(network, source, destination)
    return fat_tree.enter(network, source, destination)


@kernel
def next_link(
    network: Network, source: int, here: int, destination: int, n_bytes: int, busy_ps: int
) -> tuple[int, int, int, int]:
    """Row of the link from a node to a PE; the node behind it; how long the link is busy with the
    message, and how long its head is on the way to that node."""
    if network[0] == _TORUS:
        link, there = torus.link_towards((network[1], network[2], network[3]), here, destination)
        return link, there, busy_ps, network[5]
    if network[0] == _LEVELS:
        return levels.next_port(network, source, here, destination, n_bytes)
    link, there, behind_ps = fat_tree.next_link(network, source, here, destination)
    return link, there, busy_ps, behind_ps
