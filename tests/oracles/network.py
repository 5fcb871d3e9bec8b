"""Links and ports that serve one message at a time: plain Python, names instead of numbers."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from oracles import blocks, tree
from oracles.costs import Stage, hops_from, slowest, transfer_ps
from oracles.state import Message
from simmpp.machine.machine import Level, Machine
from simmpp.machine.messages import LOAD, REQUEST

Way = list[tuple[str, ...]]


def links(shape: tuple[int, int, int], source: int, destination: int) -> Way:
    """Names of the links from one PE to another: x, then y, then z, the shorter way round."""
    x_size, y_size, _ = shape
    here, there = (
        [pe % x_size, pe // x_size % y_size, pe // (x_size * y_size)]
        for pe in (source, destination)
    )
    way: Way = []
    for axis, size in enumerate(shape):
        forward = [(here[axis] + n) % size for n in range(size)].index(there[axis])
        backward = [(here[axis] - n) % size for n in range(size)].index(there[axis])
        step = 1 if forward <= backward else -1
        while here[axis] != there[axis]:
            way.append(("link", str(here), "xyz"[axis], "+" if step > 0 else "-"))
            here[axis] = (here[axis] + step) % size
    return way


def torus_way(machine: Machine, source: int, destination: int, n_bytes: int) -> list[Stage]:
    """Ports and links of a torus."""
    busy_ps = transfer_ps(n_bytes, slowest(machine))
    at_port_ps = max(busy_ps, machine.port_gap_ps)
    between = links(machine.shape, source, destination)
    stages = [(link, busy_ps, machine.hop_latency_ps) for link in between]
    ejection = ("ejection", str(destination)), at_port_ps, busy_ps
    # Where the latency is paid matters to messages that others of their instant have caused.
    return [(("injection", str(source)), at_port_ps, machine.latency_ps), *stages, ejection]


WAYS = {"torus": torus_way, "levels": blocks.way, "fat-tree": tree.way}
"""All that a message takes on its way, by topology."""


def distance(machine: Machine, source: int, destination: int) -> int:
    """Links between two PEs, or levels."""
    if machine.topology == "torus":
        return hops_from(machine.shape, source)[destination]
    of = {"levels": blocks.distance, "fat-tree": tree.distance}[machine.topology]
    return of(machine, source, destination)


def startups_ps(machine: Machine, source: int, destination: int) -> tuple[int, int]:
    """What a message costs its sender and its receiver, whatever its size."""
    of: Machine | Level = machine
    if machine.topology == "levels":
        of = blocks.level_between(machine, source, destination)
    return of.send_startup_ps, of.receive_startup_ps


def sending(machine: Machine, pe: int, other: int, kind: int) -> int:
    """What a PE pays for a message besides packing it; the kind is that of its first part."""
    if machine.service == "nic" and kind in (REQUEST, LOAD):
        return machine.get_startup_ps
    return startups_ps(machine, pe, other)[0]


def receiving(machine: Machine, pe: int, other: int) -> int:
    """What a PE, or its thread, pays for a message from another, besides unpacking it."""
    return machine.completion_ps if machine.service == "nic" else startups_ps(machine, other, pe)[1]


def network_ps(machine: Machine, source: int, destination: int, payload_bytes: int) -> int:
    """Time from departure to arrival on an empty network."""
    n_bytes = payload_bytes + machine.header_bytes
    if machine.topology == "levels":
        level = blocks.level_between(machine, source, destination)
        return level.latency_ps + transfer_ps(n_bytes, level.bytes_per_s)
    hops_ps = distance(machine, source, destination) * machine.hop_latency_ps
    return machine.latency_ps + hops_ps + transfer_ps(n_bytes, slowest(machine))


@dataclass
class Network:
    """From when on each link and port is free."""

    machine: Machine
    free: defaultdict[tuple[str, ...], int] = field(default_factory=lambda: defaultdict(int))

    def way(self, message: Message) -> list[Stage]:
        """Ports and links of a message."""
        n_bytes = message.payload_bytes + self.machine.header_bytes
        way = WAYS[self.machine.topology]
        return way(self.machine, message.source, message.destination, n_bytes)

    def take(self, what: tuple[str, ...], head: int, busy: int) -> int:
        """Wait for a link or port, and keep it busy; returns when it was free."""
        start = max(head, self.free[what])
        self.free[what] = start + busy
        return start
