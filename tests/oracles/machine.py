"""The simulated machine in plain Python: every activity of every PE, step by step.

One heap of instants with the order of ties written out; each step searches all rays, objects
and PEs instead of keeping counts. Nothing of it is shared with the package but its data
classes and the hooks of policies, which it calls as plain Python.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable
from typing import Any

from oracles.costs import intersection_ps
from oracles.ledger import Outcome
from oracles.network import distance
from oracles.pace import Go, draw_noise, speed_now
from oracles.serving import Serving
from oracles.state import PE, Message, Part
from simmpp.machine.machine import Machine
from simmpp.machine.messages import LOAD, MESSAGE_KINDS, OBJECT, RAYS, REQUEST, STEAL, USER
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.reads import names_in
from simmpp.workload.workload import Workload


class Simulation(Serving):
    """The event loop and the activities of a PE."""

    def run(self) -> None:
        """Handle instants in order until no ray is left."""
        for pe in self.pes:
            self.schedule(0, pe, "begin")
        handlers: dict[str, Callable[[int, Any], None]] = {
            "arrive": self.arrive,
            "begin": self.begin,
            "dispatch": self.dispatch,
            "take": self.take,
            "serve": self.serve,
            "served": self.served,
            "rest": self.rest,
            "wake": self.wake,
            "round": self.round_begins,
        }
        while self.queue:
            (time, *_), what, whom = heapq.heappop(self.queue)
            is_done = self.rays_left == 0 and not any(self.outstanding.values())
            if is_done and time >= self.ledger.makespan_ps:
                return
            done = len(self.ledger.tested) + len(self.ledger.finished_ps)
            handlers[what](time, whom)
            if what != "take":
                self.note_event(len(self.ledger.tested) + len(self.ledger.finished_ps) > done)
        if self.rays_left and self.credits and not self.has_escape:
            self.infeasible = True
        elif self.rays_left:
            raise AssertionError(f"{self.rays_left} rays left and nothing scheduled")

    def begin(self, time: int, pe: PE) -> None:
        """Receive, else compute, else sleep."""
        self.sample_loads(time)
        self.look_for_rounds(time, pe)
        pe.ended_load, pe.worked = pe.load, pe.paid.copy()
        pe.refresh_allowed = True
        if pe.owes:
            work_end = self.reduce(time, pe)
            self.ledger.open[pe.number] = (time, "receive load", 0)
        elif pe.inbox:
            message = pe.inbox.popleft()
            work_end = self.receive(time, pe, message)
            self.ledger.open[pe.number] = (time, f"receive {MESSAGE_KINDS[message.kind]}", 0)
        elif self.can_unpack(pe):
            work_end = self.unpack(time, pe)
            self.ledger.open[pe.number] = (time, "receive rays", 0)
        elif self.has_ready(pe):
            tests_before = len(self.ledger.tested)
            work_end = self.compute(time, pe)
            n_tests = len(self.ledger.tested) - tests_before
            self.ledger.open[pe.number] = (time, "compute", n_tests)
        else:
            self.fall_asleep(time, pe)
            return
        self.sample_bytes(pe)
        self.note_memory(pe)
        self.schedule(work_end, pe, "dispatch")

    def receive(self, time: int, pe: PE, message: Message) -> int:
        """Unpack one message, or take it over, and do what it asks for; returns the end of that."""
        if self.machine.service == "thread":
            clock = self.pay("communication", pe, time, self.machine.handoff_ps)
        else:
            clock = self.pay("communication", pe, time, self.unpacking(pe, message))
            self.ledger.received += 1
            self.hear_load(clock, pe, message)
        if message.carries or message.n_pixels:
            self.get_on(pe)
        if message.n_rays or message.n_pixels:
            pe.asked = set()
        pe.refresh_allowed = not message.count(LOAD)
        far = distance(self.machine, message.source, pe.number)
        for part in message.parts:
            if part.kind == RAYS:
                if not self.credits:
                    pe.make_ready(list(part.rays), self.ready_order)
                self.cross(part.rays, far)
            elif part.kind == OBJECT and part.escape:
                assert pe.stuck is not None
                self.cross([pe.stuck], 2 * far)
                pe.granted.add(pe.stuck)
                pe.make_ready([pe.stuck], self.ready_order)
            elif part.kind == OBJECT:
                self.cross(self.release(pe, part.obj), 2 * far)
            elif part.kind == STEAL:
                self.take_pixels(pe, part)
                self.cross(part.pixels or (), far)
        self.ledger.did(pe, time, "receive", clock, message)
        wanted = [part for part in message.parts if part.kind == REQUEST]
        if wanted and self.machine.service == "pe":
            answer = [
                Part(OBJECT, self.object_bytes[part.obj], part.obj, escape=part.escape)
                for part in wanted
            ]
            clock = self.send(clock, pe, message.source, answer)
        if message.count(USER):
            clock = self.hear(clock, pe, message)
        self.take_deposits(clock, message)
        if message.count(STEAL):
            clock = self.answer_thief(clock, pe, message)
        self.sample_rays(pe)
        return clock

    def cross(self, rays: Iterable[int], links: int) -> None:
        """Something crossed links for these rays."""
        for ray in rays:
            self.ledger.ray_hops[ray] += links

    def release(self, pe: PE, obj: int) -> list[int]:
        """A fetched object is here: grant waiting rays their test; returns these."""
        pe.in_flight[obj] -= 1
        waiting = pe.rays_of(obj)
        released = waiting if self.policy.merge_requests else waiting[:1]
        pe.unfile(released)
        pe.granted.update(released)
        pe.fetched += 1
        pe.released += len(released)
        pe.make_ready(released, self.ready_order)
        if pe.rays_of(obj) and pe.in_flight[obj] == 0:
            pe.sendable_since[obj] = pe.next_rank()
        if self.n_kept or self.placement.transient_bytes:
            pe.keep(obj, self.is_too_much)
        return released

    def compute(self, time: int, pe: PE) -> int:
        """Up to a quantum of tests; returns the end of that."""
        clock = self.pay("communication", pe, time, self.machine.probe_ps)
        pe.go = Go.begun(self.machine, speed_now(self.machine, pe.number, time), clock)
        pe.go.noise = draw_noise(self.machine, self.seed, pe.number, pe.goes)
        pe.goes += 1
        done_before = len(self.ledger.finished_ps)
        tests_left = self.machine.quantum
        while tests_left > 0 and (ray := self.next_ray(pe)) is not None:
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
                    pe.cut = True
                    break
                clock = self.test(clock, pe, ray, obj)
                tests_left -= 1
        done = len(self.ledger.finished_ps) - done_before
        clock = self.pay("compute", pe, clock, pe.go.end - clock)
        if pe.go.leaves_lanes_empty:
            self.ledger.finished_ps[done_before:] = [clock] * done
            for ray in pe.go.finished:
                self.ledger.ray_ends[ray] = clock
        self.end_rounds()
        tests = self.machine.quantum - tests_left
        self.ledger.did(pe, time, "compute", clock, None, tests=tests, rays=done)
        return clock

    def test(self, clock: int, pe: PE, ray: int, obj: int) -> int:
        """One intersection."""
        self.ledger.tested.append((ray, obj))
        self.get_on(pe)
        pe.go.tests_ps.append(intersection_ps(self.machine, self.workload, obj, ray))
        clock = self.pay("compute", pe, clock, pe.go.now - clock)
        self.positions[ray] += 1
        self.leave(pe, ray, self.positions[ray] - 1)
        was_granted = ray in pe.granted
        if was_granted and self.itineraries[ray][self.positions[ray] :][:1] == [obj]:
            pe.use(obj)
            return clock
        pe.granted.discard(ray)
        if pe.stuck == ray:
            pe.stuck, was_granted = None, False
        pe.use(obj)
        if was_granted and obj in pe.transient and obj not in self.pinned(pe) and self.rules.keep:
            pe.clock = clock
            draws = "random" in names_in(self.rules.keep)
            unasked = len(self.unasked(pe, obj))
            rank = int(self.rules.keep(self.view_of_object(pe, obj, unasked, False, draws)))
            pe.worth[obj] = rank
            if rank <= 0:
                pe.transient.remove(obj)
        return clock

    def is_too_much(self, objects: list[int]) -> bool:
        """Do these fetched objects exceed the room for them?"""
        if self.placement.transient_bytes:
            return sum(self.object_bytes[o] for o in objects) > self.placement.transient_bytes
        return len(objects) > self.n_kept

    def finish(self, clock: int, pe: PE, ray: int) -> int:
        """A ray is shaded and leaves its children here."""
        pe.go.rays_ps += self.machine.ray_ps
        clock = self.pay("compute", pe, clock, pe.go.now - clock)
        self.ledger.finished_ps.append(clock)
        self.ledger.ray_ends[ray] = clock
        pe.go.finished.append(ray)
        self.done.add(ray)
        self.get_on(pe)
        self.rays_left -= 1
        self.alive += len(self.children[ray]) - 1
        pe.ready.remove(ray)
        pe.finished += 1
        pe.make_ready(self.children[ray], self.ready_order)
        self.sample_rays(pe)
        self.note_memory(pe)
        return clock

    def dispatch(self, time: int, pe: PE) -> None:
        """The work is done: send, and begin anew."""
        self.sample_loads(time)
        self.look_for_rounds(time, pe)
        messages_before, pe.worked = len(self.ledger.sent), pe.paid.copy()
        clock = self.send_all(time, pe)
        self.note_stalls(time, pe)
        self.note_memory(pe)
        if pe.number in self.ledger.open:  # not when it was woken
            self.ledger.end_activity(pe.number, clock)
        if len(self.ledger.sent) > messages_before:
            self.schedule(clock, pe, "begin")
        else:
            self.begin(clock, pe)


def simulate(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    policy: PolicyParameters,
    ready_order: str = "depth-first",
    seed: int = 0,
) -> Outcome:
    """Run a workload on a machine, under a policy; ``seed`` is of its random numbers."""
    rules = policy.rules
    simulation = Simulation(workload, machine, placement, policy, ready_order, rules, seed)
    simulation.run()
    has = {"send": rules.send, "ask": rules.ask}
    outcome = simulation.ledger.outcome(
        machine.processors, machine.header_bytes, tuple(rule for rule in has if has[rule])
    )
    outcome.memory = simulation.memory_columns()
    time_ps, n_messages, n_bytes = simulation.reduction()
    outcome.reduction_ps = time_ps
    outcome.tally_messages += n_messages
    outcome.bytes_sent += n_bytes
    outcome.makespan_ps += time_ps
    outcome.communication_ps = [ps + time_ps for ps in outcome.communication_ps]
    outcome.bytes_sent += simulation.round_messages * machine.header_bytes
    outcome.round_messages = simulation.round_messages
    outcome.round_ends = simulation.round_ends()
    return outcome
