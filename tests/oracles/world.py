"""The oracle's PEs, the queue of what is going to happen, and the messages that PEs send."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from oracles.costs import Stage, packing, unpacking
from oracles.ledger import Ledger
from oracles.network import Network, network_ps, receiving, sending
from oracles.state import PE, Message, Part
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.policy import Policy
from simmpp.workload.workload import Workload


@dataclass
class World:
    """The state of a run."""

    workload: Workload
    machine: Machine
    placement: Placement
    policy: PolicyParameters
    ready_order: str
    rules: Policy
    seed: int = 0
    """Of the policy's random numbers."""
    queue: list[tuple[Any, ...]] = field(default_factory=list)
    """A heap of (key, what happens, to whom); keys are the order of ties and never equal:
    arrivals (time, 0, destination, source, send number), instants (time, 1, PE, number, 0),
    heads of messages at links and ports (time, 2, source, send number, 0)."""
    ledger: Ledger = field(default_factory=Ledger)
    flying: list[Message] = field(default_factory=list)
    """Messages that have been packed and have not arrived."""

    def __post_init__(self) -> None:
        self.nb = self.placement.processors
        self.network = Network(self.machine)
        pes, n_islands = list(range(self.nb)), self.placement.islands
        cuts = [n * self.nb // n_islands for n in range(n_islands + 1)]
        self.islands = [pes[i:j] for i, j in pairwise(cuts)]
        self.owners = [int(o) for o in self.placement.owners]
        self.object_bytes = [int(b) for b in self.workload.object_bytes]
        self.rays_left = self.workload.n_rays
        offsets = [int(i) for i in self.workload.itinerary_offsets]
        objects = [int(o) for o in self.workload.itinerary_objects]
        self.itineraries = [objects[i:j] for i, j in pairwise(offsets)]
        self.positions = [0] * self.workload.n_rays
        self.ledger.ray_hops = [0] * self.workload.n_rays
        self.ledger.ray_ends = [0] * self.workload.n_rays
        rounds = self.workload.root_rounds
        self.round_of = [int(rounds[p]) if len(rounds) else 0 for p in self.workload.pixels]
        self.n_rounds = max(self.round_of, default=0) + 1
        together = min(self.placement.window, self.n_rounds)
        self.roots_at_once = self.workload.n_primaries * together // self.n_rounds
        self.done: set[int] = set()
        self.pes = [self.new_pe(k) for k in range(self.nb)]
        self.sampled = [pe.load for pe in self.pes]
        self.sampled_at = 0
        for pe in self.pes:
            self.sample_rays(pe)
            self.sample_bytes(pe)

    def new_pe(self, k: int) -> PE:
        """A PE before the start, its primary rays ready."""
        resident = {o for o in range(len(self.owners)) if self.owner_of(k, o) == k}
        first, end = (int(i) for i in self.placement.replica_offsets[k : k + 2])
        resident |= {int(o) for o in self.placement.replica_objects[first:end]}
        if self.rules.all_resident:
            resident = set(range(len(self.owners)))
        all_rays = [ray for ray, pe in enumerate(self.placement.pixel_pes) if pe == k]
        all_rays.sort(key=lambda ray: self.round_of[ray])  # those of a round stay as they are
        window = self.placement.window
        rays = [ray for ray in all_rays if self.round_of[ray] < window]
        share = self.roots_at_once // self.nb
        pe = PE(k, resident, rays, [share] * self.nb, ended_load=len(rays))
        pe.later, pe.round = [ray for ray in all_rays if ray not in rays], window
        pe.untouched = set(rays)
        return pe

    def island_of(self, k: int) -> list[int]:
        """The PEs of a PE's island."""
        return next(island for island in self.islands if k in island)

    def owner_of(self, k: int, obj: int) -> int:
        """The PE that owns an object in the island of another."""
        return self.island_of(k)[self.owners[obj]]

    def schedule(self, time: int, pe: PE, what: str) -> None:
        """Let a PE begin or dispatch at a time."""
        heapq.heappush(self.queue, ((time, 1, pe.number, pe.instants, 0), what, pe))
        pe.instants += 1

    def schedule_thread(self, time: int, pe: PE, what: str) -> None:
        """Let the thread of a PE serve, or have served, at a time."""
        key = (time, 1, self.nb + pe.number, pe.thread_instants, 0)
        heapq.heappush(self.queue, (key, what, pe))
        pe.thread_instants += 1

    def sample_loads(self, time: int) -> None:
        """If a multiple of the period has passed since all loads were sampled, sample them."""
        period = self.policy.sample_ps
        if period and time // period > self.sampled_at // period:
            self.sampled = [pe.ended_load for pe in self.pes]
            self.sampled_at = time

    def pay(self, account: str, pe: PE, clock: int, cost: int) -> int:
        """Charge a PE; returns the time when it has paid."""
        pe.paid[account] += cost
        return self.ledger.pay(account, pe.number, clock, cost)

    def send(
        self,
        clock: int,
        pe: PE,
        destination: int,
        parts: Sequence[Part],
        *,
        by_thread: bool = False,
    ) -> int:
        """Pack a message and let it depart; returns the time of that."""
        begin = clock
        cost = sending(self.machine, pe.number, destination, parts[0].kind)
        cost += sum(packing(self.machine, part.kind, part.payload_bytes) for part in parts)
        clock = self.pay("service" if by_thread else "communication", pe, clock, cost)
        load = pe.ended_load if by_thread else pe.load
        message = Message(pe.number, destination, pe.sends, tuple(parts), load, clock)
        message.credit, pe.owed[destination] = pe.owed[destination], 0
        self.flying.append(message)
        pe.sends += 1
        if self.machine.service != "nic" or message.asks_for_load:
            pe.last_departure[destination] = max(pe.last_departure[destination], clock)
        if message.carries:
            pe.peers.add(destination)
        self.ledger.sent.append(message)
        self.ledger.did(pe, begin, "answer" if by_thread else "send", clock, message)
        self.depart(clock, message)
        return clock

    def depart(self, time: int, message: Message) -> None:
        """A message sets off."""
        if self.machine.contention == "links":
            self.come_to(time, message, self.network.way(message))
        else:
            between = message.source, message.destination
            flight = network_ps(self.machine, *between, message.payload_bytes)
            self.let_arrive(time + flight, message)

    def unpacking(self, pe: PE, message: Message) -> int:
        """What a message costs who receives it."""
        cost = receiving(self.machine, pe.number, message.source)
        parts = message.parts
        return cost + sum(unpacking(self.machine, p.kind, p.payload_bytes) for p in parts)

    def come_to(self, time: int, message: Message, way: list[Stage]) -> None:
        """The head of a message will be at the first of these ports and links."""
        key = (time, 2, message.source, message.send_number, 0)
        heapq.heappush(self.queue, (key, "take", (message, way)))

    def take(self, time: int, head: tuple[Message, list[Stage]]) -> None:
        """The head of a message is at a port or link, and goes on when that is free."""
        message, ((what, busy, then), *rest) = head
        time = self.network.take(what, time, busy) + then
        if rest:
            self.come_to(time, message, rest)
        else:
            self.let_arrive(time, message)

    def let_arrive(self, time: int, message: Message) -> None:
        """A message travels, and will be there at a time."""
        key = (time, 0, message.destination, message.source, message.send_number)
        heapq.heappush(self.queue, (key, "arrive", message))

    def sample_rays(self, pe: PE) -> None:
        """Note how many rays a PE holds."""
        self.ledger.held_rays.append(pe.load)

    def sample_bytes(self, pe: PE) -> None:
        """Note how many bytes a PE holds."""
        n_bytes = self.held_bytes(pe) + pe.load * self.machine.ray_bytes
        self.ledger.held_bytes.append(n_bytes)

    def held_bytes(self, pe: PE) -> int:
        """Bytes of the objects that a PE holds."""
        held = pe.resident | self.pinned(pe) | set(pe.transient)
        return sum(self.object_bytes[o] for o in held)

    def pinned(self, pe: PE) -> set[int]:
        """Fetched objects that are there for a test that is to be made."""
        return {self.next_object(ray) for ray in pe.granted if ray != pe.stuck}

    def next_object(self, ray: int) -> int:
        """What a ray is to be tested against next."""
        return self.itineraries[ray][self.positions[ray]]
