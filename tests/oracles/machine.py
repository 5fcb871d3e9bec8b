"""The simulated machine in plain Python: every activity of every PE, step by step.

One heap of instants with the order of ties written out; each step searches all rays, objects
and PEs instead of keeping counts. Nothing of it is shared with the package but its data classes.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

from oracles.costs import copy_ps, intersection_ps, network_ps
from oracles.rules import RULES, Rule, Rules, View, minimum_load
from oracles.state import PE, Message
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD, MESSAGE_KINDS, OBJECT, RAYS, REQUEST
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


@dataclass
class Outcome:
    """Everything that a run gives back; a list has one entry per PE."""

    makespan_ps: int
    messages_by_kind: tuple[int, int, int, int]
    messages_received: int
    bytes_sent: int
    rays: int
    tests: int
    rays_sent: int
    compute_ps: list[int]
    communication_ps: list[int]
    waiting_ps: list[int]
    peak_rays: int
    peak_bytes: int
    events: int
    rules_never_fired: tuple[str, ...]
    arrivals: list[tuple[int, int, int, int, str, int]]
    """(time, destination, source, send number, message kind, payload bytes)."""
    activities: list[tuple[int, int, str, int, int]]
    """(begin, PE, "receive <kind>" or "compute", end, tests)."""
    tested: list[tuple[int, int]]
    """(ray, object) in the order performed: by the beginnings of the computes."""


@dataclass
class _Simulation:
    workload: Workload
    machine: Machine
    placement: Placement
    policy: PolicyParameters
    ready_order: str
    rules: Rules
    heap: list[tuple[Any, ...]] = field(default_factory=list)
    sent: list[Message] = field(default_factory=list)
    received: int = 0
    spans: list[tuple[str, int, int, int]] = field(default_factory=list)
    """(account, PE, from, to) of every cost paid."""
    arrivals: list[tuple[int, int, int, int, str, int]] = field(default_factory=list)
    activities: list[tuple[int, int, str, int, int]] = field(default_factory=list)
    makespan: int = 0
    peak_rays: int = 0
    peak_bytes: int = 0

    def __post_init__(self) -> None:
        self.nb = self.placement.processors
        self.owners = [int(o) for o in self.placement.owners]
        self.object_bytes = [int(b) for b in self.workload.object_bytes]
        self.rays_left = self.workload.n_rays
        offsets = [int(i) for i in self.workload.itinerary_offsets]
        objects = [int(o) for o in self.workload.itinerary_objects]
        self.itineraries = [objects[i:j] for i, j in pairwise(offsets)]
        self.positions = [0] * self.workload.n_rays
        self.tested: list[tuple[int, int]] = []
        self.current: dict[int, tuple[int, str, int]] = {}
        self.pes = [self.new_pe(k) for k in range(self.nb)]
        for pe in self.pes:
            self.sample_rays(pe)
            self.sample_bytes(pe)

    def new_pe(self, k: int) -> PE:
        resident = {o for o, owner in enumerate(self.owners) if owner == k}
        first, end = (int(i) for i in self.placement.replica_offsets[k : k + 2])
        resident |= {int(o) for o in self.placement.replica_objects[first:end]}
        if self.policy.name == "replicated":
            resident = set(range(len(self.owners)))
        rays = [ray for ray, pe in enumerate(self.placement.pixel_pes) if pe == k]
        share = Fraction(self.workload.n_primaries, self.nb)
        return PE(k, resident, rays, [share] * self.nb, ended_load=len(rays))

    # --- the event loop ---

    def run(self) -> None:
        for pe in self.pes:
            self.schedule(0, pe, self.begin)
        while self.heap:
            time = self.heap[0][0]
            if self.rays_left == 0 and time >= self.makespan:
                return
            *_, handle, what = heapq.heappop(self.heap)
            handle(time, what)
        if self.rays_left:
            raise AssertionError(f"{self.rays_left} rays left and nothing scheduled")

    def schedule(self, time: int, pe: PE, handle: Any) -> None:
        heapq.heappush(self.heap, (time, 1, pe.number, pe.instants, 0, handle, pe))
        pe.instants += 1

    def arrive(self, time: int, message: Message) -> None:
        kind = MESSAGE_KINDS[message.kind]
        self.arrivals.append(
            (
                time,
                message.destination,
                message.source,
                message.send_number,
                kind,
                message.payload_bytes,
            )
        )
        pe = self.pes[message.destination]
        pe.inbox.append(message)
        if pe.asleep:
            pe.asleep = False
            self.schedule(time, pe, self.begin)

    def begin(self, time: int, pe: PE) -> None:
        pe.ended_load = pe.load
        pe.refresh_allowed = True
        if pe.inbox:
            message = pe.inbox.popleft()
            work_end = self.receive(time, pe, message)
            self.current[pe.number] = (time, f"receive {MESSAGE_KINDS[message.kind]}", 0)
        elif pe.ready:
            tests_before = len(self.tested)
            work_end = self.compute(time, pe)
            n_tests = len(self.tested) - tests_before
            self.current[pe.number] = (time, "compute", n_tests)
        else:
            pe.asleep = True
            return
        self.sample_bytes(pe)
        self.schedule(work_end, pe, self.dispatch)

    def end_activity(self, pe: PE, end: int) -> None:
        begin, kind, n_tests = self.current.pop(pe.number)
        self.activities.append((begin, pe.number, kind, end, n_tests))

    # --- receive ---

    def receive(self, time: int, pe: PE, message: Message) -> int:
        cost = self.machine.receive_startup_ps
        cost += copy_ps(self.machine.unpack[message.kind], message.payload_bytes)
        clock = self.pay("communication", pe, time, cost)
        self.received += 1
        pe.known_load[message.source] = Fraction(message.load)
        pe.heard[message.source] = clock
        if message.kind in (OBJECT, RAYS):
            pe.partners.add(message.source)
        if message.kind == REQUEST:
            size = self.object_bytes[message.obj]
            clock = self.send(clock, pe, OBJECT, message.source, size, obj=message.obj)
        elif message.kind == OBJECT:
            self.release(pe, message.obj)
        elif message.kind == RAYS:
            pe.make_ready(list(message.rays), self.ready_order)
        else:
            pe.refresh_allowed = False
        self.sample_rays(pe)
        return clock

    def release(self, pe: PE, obj: int) -> None:
        pe.in_flight[obj] -= 1
        waiting = pe.rays_of(obj)
        released = waiting if self.policy.merge_requests else waiting[:1]
        pe.unfile(released)
        pe.granted.update(released)
        pe.make_ready(released, self.ready_order)
        if pe.rays_of(obj) and pe.in_flight[obj] == 0:
            pe.sendable_since[obj] = pe.next_rank()
        if self.placement.transient > 0:
            pe.keep(obj, self.placement.transient)

    # --- compute ---

    def compute(self, time: int, pe: PE) -> int:
        clock = self.pay("communication", pe, time, self.machine.probe_ps)
        tests_left = self.machine.quantum
        while tests_left > 0 and pe.ready:
            ray = pe.ready[0]
            while True:
                itinerary, position = self.itineraries[ray], self.positions[ray]
                if position == len(itinerary):
                    clock = self.finish(clock, pe, ray)
                    break
                obj = itinerary[position]
                if not (ray in pe.granted or obj in pe.resident or obj in pe.transient):
                    pe.ready.remove(ray)
                    pe.file(ray, obj)
                    break
                if tests_left == 0:
                    break
                clock = self.test(clock, pe, ray, obj)
                tests_left -= 1
        return clock

    def test(self, clock: int, pe: PE, ray: int, obj: int) -> int:
        self.tested.append((ray, obj))
        self.positions[ray] += 1
        pe.granted.discard(ray)
        pe.use(obj)
        return self.pay("compute", pe, clock, intersection_ps(self.machine, self.workload, obj))

    def finish(self, clock: int, pe: PE, ray: int) -> int:
        clock = self.pay("compute", pe, clock, self.machine.ray_ps)
        self.makespan = max(self.makespan, clock)
        self.rays_left -= 1
        children = [c for c, parent in enumerate(self.workload.parents) if parent == ray]
        pe.ready.remove(ray)
        pe.make_ready(children, self.ready_order)
        self.sample_rays(pe)
        return clock

    # --- dispatch ---

    def dispatch(self, time: int, pe: PE) -> None:
        nothing_else = not pe.ready and not pe.inbox
        messages_before = len(self.sent)
        clock = time
        if self.rules.may_send:
            clock = self.send_rays(clock, pe, nothing_else, self.rules.may_send)
        if self.rules.may_ask:
            clock = self.ask(clock, pe, nothing_else, self.rules.may_ask)
        if self.policy.load_info == "piggyback" and pe.refresh_allowed:
            clock = self.refresh(clock, pe)
        self.end_activity(pe, clock)
        if len(self.sent) > messages_before:
            self.schedule(clock, pe, self.begin)
        else:
            self.begin(clock, pe)

    def others(self, pe: PE) -> list[int]:
        return [(pe.number + step) % self.nb for step in range(1, self.nb)]

    def sendable(self, pe: PE, owner: int) -> list[int]:
        """Rays that may be sent to an owner, in the order of the message."""
        objects = {o for _, o, _ in pe.waiting if self.owners[o] == owner and not pe.in_flight[o]}
        by_age = sorted(objects, key=lambda o: pe.sendable_since[o])
        return [ray for o in by_age for ray in pe.rays_of(o)]

    def send_rays(self, clock: int, pe: PE, nothing_else: bool, may_send: Rule) -> int:
        minimum = minimum_load(self.policy, self.workload.n_primaries, self.nb)
        for owner in self.others(pe):
            rays = self.sendable(pe, owner)
            if not rays or not (len(rays) >= self.policy.batch or nothing_else):
                continue
            known, age = self.known_load(clock, pe, owner)
            if not may_send(View(pe.load, len(rays), nothing_else, minimum, known, age)):
                continue
            pe.unfile(rays)
            size = len(rays) * self.machine.ray_bytes
            clock = self.send(clock, pe, RAYS, owner, size, rays=tuple(rays))
        return clock

    def known_load(self, clock: int, pe: PE, owner: int) -> tuple[Fraction | None, int]:
        """What a PE knows of the owner's load, and for how long it has."""
        if self.policy.load_info == "none":
            return None, clock
        if self.policy.load_info == "exact":
            return Fraction(self.pes[owner].ended_load), 0
        return pe.known_load[owner], clock - pe.heard[owner]

    def unasked(self, pe: PE, obj: int) -> list[tuple[int, int, int]]:
        """Entries of the wait file that no request in flight will serve."""
        entries = [entry for entry in pe.waiting if entry[1] == obj]
        if self.policy.merge_requests:
            return [] if pe.in_flight[obj] else entries
        return entries[pe.in_flight[obj] :]

    def ask(self, clock: int, pe: PE, nothing_else: bool, may_ask: Rule) -> int:
        at_least = self.rules.ask_at_least or self.policy.ask_at_least
        oldest = {o: self.unasked(pe, o) for o in {o for _, o, _ in pe.waiting}}
        for obj in sorted((o for o in oldest if oldest[o]), key=lambda o: oldest[o][0]):
            n = len(oldest[obj])
            if not (n >= at_least or nothing_else) or not may_ask(View(pe.load, n, nothing_else)):
                continue
            for _ in oldest[obj][:1] if self.policy.merge_requests else oldest[obj]:
                size = self.machine.request_bytes
                clock = self.send(clock, pe, REQUEST, self.owners[obj], size, obj=obj)
                pe.in_flight[obj] += 1
        return clock

    def refresh(self, clock: int, pe: PE) -> int:
        if self.policy.refresh_ps is None:
            return clock
        for other in self.others(pe):
            silence = clock - pe.last_departure[other]
            if other in pe.partners and silence >= self.policy.refresh_ps:
                clock = self.send(clock, pe, LOAD, other, 0)
        return clock

    # --- costs, messages and samples ---

    def pay(self, account: str, pe: PE, clock: int, cost: int) -> int:
        self.spans.append((account, pe.number, clock, clock + cost))
        return clock + cost

    def send(
        self,
        clock: int,
        pe: PE,
        kind: int,
        destination: int,
        payload_bytes: int,
        obj: int = -1,
        rays: tuple[int, ...] = (),
    ) -> int:
        cost = self.machine.send_startup_ps + copy_ps(self.machine.pack[kind], payload_bytes)
        clock = self.pay("communication", pe, clock, cost)
        arrival = clock + network_ps(self.machine, pe.number, destination, payload_bytes)
        message = Message(
            kind,
            pe.number,
            destination,
            pe.sends,
            payload_bytes,
            pe.load,
            clock,
            arrival,
            obj,
            rays,
        )
        pe.sends += 1
        pe.last_departure[destination] = clock
        if kind in (OBJECT, RAYS):
            pe.partners.add(destination)
        self.sent.append(message)
        key = (arrival, 0, destination, pe.number, message.send_number)
        heapq.heappush(self.heap, (*key, self.arrive, message))
        return clock

    def sample_rays(self, pe: PE) -> None:
        self.peak_rays = max(self.peak_rays, pe.load)

    def sample_bytes(self, pe: PE) -> None:
        pinned = {self.itineraries[ray][self.positions[ray]] for ray in pe.granted}
        held = pe.resident | pinned | set(pe.transient)
        n_bytes = sum(self.object_bytes[o] for o in held) + pe.load * self.machine.ray_bytes
        self.peak_bytes = max(self.peak_bytes, n_bytes)

    # --- the result ---

    def account(self, name: str, pe: int) -> int:
        end = self.makespan
        return sum(
            min(to, end) - min(since, end)
            for account, number, since, to in self.spans
            if account == name and number == pe
        )

    def outcome(self) -> Outcome:
        for number in list(self.current):
            time, *_ = self.current[number]
            ends = [to for _, pe, since, to in self.spans if pe == number and since >= time]
            self.end_activity(self.pes[number], max(ends))
        activities = [
            (t, pe, kind, min(to, self.makespan), n) for t, pe, kind, to, n in self.activities
        ]
        sent = [m for m in self.sent if m.departure <= self.makespan]
        rules = {"send": (self.rules.may_send, RAYS), "ask": (self.rules.may_ask, REQUEST)}
        compute = [self.account("compute", k) for k in range(self.nb)]
        communication = [self.account("communication", k) for k in range(self.nb)]
        return Outcome(
            makespan_ps=self.makespan,
            messages_by_kind=tuple(sum(m.kind == k for m in sent) for k in range(4)),  # type: ignore[arg-type]
            messages_received=self.received,
            bytes_sent=sum(m.payload_bytes + self.machine.header_bytes for m in sent),
            rays=self.workload.n_rays - self.rays_left,
            tests=len(self.tested),
            rays_sent=sum(len(m.rays) for m in sent),
            compute_ps=compute,
            communication_ps=communication,
            waiting_ps=[self.makespan - a - b for a, b in zip(compute, communication, strict=True)],
            peak_rays=self.peak_rays,
            peak_bytes=self.peak_bytes,
            events=len(self.activities) + len(self.arrivals),
            rules_never_fired=tuple(
                rule
                for rule, (exists, kind) in rules.items()
                if exists and not any(m.kind == kind for m in sent)
            ),
            arrivals=sorted(self.arrivals),
            activities=sorted(activities, key=lambda row: row[:2]),
            tested=self.tested,
        )


def simulate(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters,
    ready_order: str = "depth-first",
    rules: Rules | None = None,
) -> Outcome:
    """Run a workload on a machine without network contention, under a policy or other rules."""
    rules = rules or RULES[policy.name]
    simulation = _Simulation(workload, machine, placement, policy, ready_order, rules)
    simulation.run()
    return simulation.outcome()
