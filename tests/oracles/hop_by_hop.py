"""A network whose links and ports serve whoever comes first: a SimPy process for each message.

The process asks for every link and port when its head gets there, and keeps it for the time of its
bytes while the head goes on. Heads of one instant ask in the order of source and send number.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import dataclass

import simpy
from simpy.events import Event

from oracles.network import WAYS
from simmpp.machine.machine import Machine


@dataclass(frozen=True, order=True)
class Sent:
    """A message that departs."""

    depart_ps: int
    source: int
    number: int
    destination: int
    n_bytes: int
    """With its header."""


class HopByHop:
    """What becomes of some traffic, given in order; the n-th message is known as n."""

    def __init__(self, machine: Machine, traffic: Iterable[Sent]) -> None:
        self.environment = simpy.Environment()
        self.arrivals_ps: dict[int, int] = {}
        self._resources: dict[tuple[str, ...], simpy.Resource] = {}
        self._machine = machine
        for n, sent in enumerate(traffic):
            self.environment.process(self._travel(n, sent))
        self.environment.run()

    def _travel(self, n: int, sent: Sent) -> Generator[Event, None, None]:
        way = WAYS[self._machine.topology]
        delay_ps = sent.depart_ps
        for what, busy_ps, then_ps in way(
            self._machine, sent.source, sent.destination, sent.n_bytes
        ):
            yield self._head_at(sent, delay_ps)
            yield from self._take(what, busy_ps)
            delay_ps = then_ps
        yield self.environment.timeout(delay_ps)
        self.arrivals_ps[n] = self.environment.now

    def _head_at(self, sent: Sent, delay_ps: int) -> Event:
        """The head comes to the next port or link: after all else at that instant."""
        head = Event(self.environment)
        head._ok, head._value = True, None
        priority = (sent.source + 1) << 64 | sent.number
        self.environment.schedule(head, priority, delay_ps)
        return head

    def _take(self, what: tuple[str, ...], busy_ps: int) -> Generator[Event, None, None]:
        """Wait for a link or port; it is given back later, whatever the message does."""
        if what not in self._resources:
            self._resources[what] = simpy.Resource(self.environment)
        resource = self._resources[what]
        request = resource.request()
        yield request
        release = self.environment.timeout(busy_ps)
        release.callbacks.append(lambda _: resource.release(request))
