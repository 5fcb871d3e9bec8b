"""What the oracle's PE sends at the end of an activity: rays, requests, its load."""

from __future__ import annotations

from fractions import Fraction

from oracles.rules import Rule, View, minimum_load
from oracles.state import PE
from oracles.world import World
from simmpp.machine.messages import LOAD, RAYS, REQUEST


class Dispatch(World):
    """The policy's two rules, and the refresh of loads."""

    def send_all(self, time: int, pe: PE) -> int:
        """Send all that may be sent from a time on; returns the end of that."""
        nothing_else = not pe.ready and not pe.inbox
        clock = time
        if self.rules.may_send:
            clock = self.send_rays(clock, pe, nothing_else, self.rules.may_send)
        if self.rules.may_ask:
            clock = self.ask(clock, pe, nothing_else, self.rules.may_ask)
        if self.policy.load_info == "piggyback" and pe.refresh_allowed:
            clock = self.refresh(clock, pe)
        return clock

    def others(self, pe: PE) -> list[int]:
        """All other PEs, beginning with the next one."""
        return [(pe.number + step) % self.nb for step in range(1, self.nb)]

    def sendable(self, pe: PE, owner: int) -> list[int]:
        """Rays that may be sent to an owner, in the order of the message."""
        objects = {o for _, o, _ in pe.waiting if self.owners[o] == owner and not pe.in_flight[o]}
        by_age = sorted(objects, key=lambda o: pe.sendable_since[o])
        return [ray for o in by_age for ray in pe.rays_of(o)]

    def send_rays(self, clock: int, pe: PE, nothing_else: bool, may_send: Rule) -> int:
        """One message to each owner that the rule allows."""
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
        """Requests for each object that the rule allows."""
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
        """The own load to every partner that was sent nothing for long."""
        if self.policy.refresh_ps is None or not self.rules.knows_loads:
            return clock
        for other in self.others(pe):
            silence = clock - pe.last_departure[other]
            if other in pe.partners and silence >= self.policy.refresh_ps:
                clock = self.send(clock, pe, LOAD, other, 0)
        return clock
