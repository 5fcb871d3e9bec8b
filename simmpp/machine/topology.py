"""Which PEs a network joins and how: one object, and two functions that compiled code calls.

A further topology is a file like ``torus``, a line in TOPOLOGIES and in each function here, and its
word in a field of ``Machine``. Its links are drawn if ``report.run_figures.drawing`` knows how.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.machine import torus
from simmpp.machine.machine import Machine

Network = NDArray[np.int64]
"""A topology as compiled code gets it: (4,) int64, its number in ``TOPOLOGIES`` and its sizes."""


class Topology(Protocol):
    """A network without its constants."""

    @property
    def pe_count(self) -> int:
        """PEs that it joins."""

    @property
    def n_links(self) -> int:
        """Links and ports that serve one message at a time."""

    @property
    def diameter(self) -> int:
        """Most links between two PEs."""

    @property
    def sizes(self) -> tuple[int, int, int]:
        """What the compiled functions need to know."""

    def by_link(self, of_rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """What there is of each row (n_links,), of the links only, arranged for a drawing."""

    def __str__(self) -> str: ...


TOPOLOGIES: tuple[Callable[[tuple[int, int, int]], Topology], ...] = (torus.Torus,)


def topology_of(machine: Machine) -> Topology:
    """The network of a machine."""
    return TOPOLOGIES[0](machine.shape)


def network_of(topology: Topology) -> Network:
    """The same for compiled code."""
    return np.array([TOPOLOGIES.index(type(topology)), *topology.sizes], np.int64)


@kernel
def hops(network: Network, source: int, destination: int) -> int:
    """Links that a message crosses."""
    return torus.hops(network[1], network[2], network[3], source, destination)


@kernel
def next_link(network: Network, here: int, destination: int) -> tuple[int, int]:
    """Row of the link that leads from a node to a PE, and the node behind that link.

    Nodes are PEs and, from ``pe_count`` on, switches, if there are any.
    """
    return torus.link_towards((network[1], network[2], network[3]), here, destination)


@kernel
def port(network: Network, pe: int, out: int) -> int:
    """Row of the port through which messages enter the network from a PE (0) or leave it (1)."""
    return torus.port(pe, out)
