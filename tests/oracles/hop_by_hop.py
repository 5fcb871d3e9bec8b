"""A network whose links and ports serve whoever comes first: a SimPy process for each message.

The process asks for every link and port when its head gets there, and keeps it for the time of its
bytes while the head goes on. The package instead books the whole way at departure; where messages
come to each link in the order of their departures, both are the same.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Iterable
from dataclasses import dataclass
from functools import cache

import simpy
from simpy.events import Event

from oracles.network import Way, links
from simmpp.machine.machine import Machine


@dataclass(frozen=True, order=True)
class Sent:
    """A message that departs; in the order in which the package books ways."""

    depart_ps: int
    source: int
    number: int
    destination: int
    busy_ps: int
    """How long it occupies each link and port."""


class HopByHop:
    """What becomes of some traffic, given in order; the n-th message is known as n."""

    def __init__(self, machine: Machine, traffic: Iterable[Sent]) -> None:
        self.environment = simpy.Environment()
        self.latency_ps, self.hop_latency_ps = machine.latency_ps, machine.hop_latency_ps
        self.arrivals_ps: dict[int, int] = {}
        self.served: defaultdict[tuple[str, ...], list[int]] = defaultdict(list)
        """Which messages each link and port took, one after the other."""
        self._resources: dict[tuple[str, ...], simpy.Resource] = {}
        self._way = cache(lambda source, destination: links(machine.shape, source, destination))
        self.environment.process(self._depart(traffic))
        self.environment.run()

    @property
    def keeps_order(self) -> bool:
        """Does every link and port serve messages in the order of their departures?"""
        return all(numbers == sorted(numbers) for numbers in self.served.values())

    def _depart(self, traffic: Iterable[Sent]) -> Generator[Event, None, None]:
        for n, sent in enumerate(traffic):
            if sent.depart_ps > self.environment.now:
                yield self.environment.timeout(sent.depart_ps - self.environment.now)
            self.environment.process(self._travel(n, sent))

    def _travel(self, n: int, sent: Sent) -> Generator[Event, None, None]:
        environment, way = self.environment, self._way_of(sent)
        yield from self._take(("injection", str(sent.source)), n, sent.busy_ps)
        yield environment.timeout(self.latency_ps)
        for link in way:
            yield from self._take(link, n, sent.busy_ps)
            yield environment.timeout(self.hop_latency_ps)
        yield from self._take(("ejection", str(sent.destination)), n, sent.busy_ps)
        yield environment.timeout(sent.busy_ps)
        self.arrivals_ps[n] = environment.now

    def _way_of(self, sent: Sent) -> Way:
        return self._way(sent.source, sent.destination)

    def _take(self, what: tuple[str, ...], n: int, busy_ps: int) -> Generator[Event, None, None]:
        """Wait for a link or port; it is given back later, whatever the message does."""
        if what not in self._resources:
            self._resources[what] = simpy.Resource(self.environment)
        resource = self._resources[what]
        request = resource.request()
        yield request
        self.served[what].append(n)
        release = self.environment.timeout(busy_ps)
        release.callbacks.append(lambda _: resource.release(request))
