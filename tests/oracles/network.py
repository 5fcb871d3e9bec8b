"""Links and ports that serve one message at a time, in plain Python, by names instead of numbers.

The latency is paid before the ejection port, not behind the injection port as in the package: all
messages pay it once, so it makes no difference where.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from oracles.costs import transfer_ps
from oracles.state import Message
from simmpp.machine.machine import UNLIMITED, Machine

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


@dataclass
class Network:
    """From when on each link and port is free."""

    machine: Machine
    free: defaultdict[tuple[str, ...], int] = field(default_factory=lambda: defaultdict(int))

    def transfer_ps(self, message: Message) -> int:
        """How long a message keeps a link or port busy."""
        limits = (self.machine.link_bytes_per_s, self.machine.injection_bytes_per_s)
        slowest = min((b for b in limits if b != UNLIMITED), default=UNLIMITED)
        return transfer_ps(message.payload_bytes + self.machine.header_bytes, slowest)

    def way(self, message: Message) -> list[tuple[tuple[str, ...], int]]:
        """Ports and links of a message, and how long its head takes from each to the next."""
        between = links(self.machine.shape, message.source, message.destination)
        stages = [(link, self.machine.hop_latency_ps) for link in between]
        stages[-1] = (stages[-1][0], stages[-1][1] + self.machine.latency_ps)
        ejection = (("ejection", str(message.destination)), self.transfer_ps(message))
        return [(("injection", str(message.source)), 0), *stages, ejection]

    def take(self, what: tuple[str, ...], head: int, busy: int) -> int:
        """Wait for a link or port, and keep it busy; returns when it was free."""
        start = max(head, self.free[what])
        self.free[what] = start + busy
        return start
