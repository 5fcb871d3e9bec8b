"""What the oracle's PE sends at the end of an activity: rays, requests, its load."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction

from oracles.network import distance
from oracles.rules import View, numbers
from oracles.state import PE, Part
from oracles.world import World
from simmpp.machine.messages import LOAD, RAYS, REQUEST
from simmpp.policy.rules import Rule

Parcel = tuple[int, list[Part]]
"""A destination, and what goes to it in one message."""


class Dispatch(World):
    """The policy's two rules, and the refresh of loads."""

    def send_all(self, time: int, pe: PE) -> int:
        """Send all that may be sent from a time on; returns the end of that."""
        pe.clock = time
        decisions = self.decisions(pe)
        # One by one, what has been decided departs before the next decision; else all are made
        # before the first message is packed.
        if self.policy.packing == "none":
            messages: Iterable[Parcel] = ((owner, [part]) for owner, part in decisions)
        else:
            messages = self.packed(pe, list(decisions))
        for destination, parts in messages:
            pe.clock = self.send(pe.clock, pe, destination, parts)
        if self.policy.load_info == "piggyback" and pe.refresh_allowed:
            self.refresh(pe)
        return pe.clock

    def decisions(self, pe: PE) -> Iterator[tuple[int, Part]]:
        """To whom what goes: rays, then requests; each is decided when it is drawn."""
        nothing_else = not pe.ready and not pe.inbox
        if self.rules.may_send:
            yield from self.rays_to_send(pe, nothing_else, self.rules.may_send)
        if self.rules.may_ask:
            yield from self.requests(pe, nothing_else, self.rules.may_ask)

    def packed(self, pe: PE, decided: list[tuple[int, Part]]) -> Iterator[Parcel]:
        """Messages of what has been decided, those that may share one together."""
        shared = {"requests": ((RAYS,), (REQUEST,)), "all": ((RAYS, REQUEST),)}
        for kinds in shared[self.policy.packing]:
            for other in self.others(pe):
                parts = [part for to, part in decided if to == other and part.kind in kinds]
                if parts:
                    yield other, parts

    def others(self, pe: PE) -> list[int]:
        """All other PEs, beginning with the next one."""
        return [(pe.number + step) % self.nb for step in range(1, self.nb)]

    def sendable(self, pe: PE, owner: int) -> list[int]:
        """Rays that may be sent to an owner, in the order of the message."""
        objects = {o for _, o, _ in pe.waiting if self.owners[o] == owner and not pe.in_flight[o]}
        by_age = sorted(objects, key=lambda o: pe.sendable_since[o])
        return [ray for o in by_age for ray in pe.rays_of(o)]

    def rays_to_send(
        self, pe: PE, nothing_else: bool, may_send: Rule
    ) -> Iterator[tuple[int, Part]]:
        """One batch to each owner that the rule allows."""
        for owner in self.others(pe):
            rays = self.sendable(pe, owner)
            known, age = self.known_load(pe.clock, pe, owner)
            seen = {"nothing_else": nothing_else, "known_load": known, "age_ps": age}
            if not rays or not may_send(self.view(pe, owner, waiting=len(rays), **seen)):
                continue
            pe.unfile(rays)
            yield owner, Part(RAYS, len(rays) * self.machine.ray_bytes, rays=tuple(rays))

    def view(self, pe: PE, owner: int, **seen: int | Fraction) -> View:
        """What a rule of this PE sees when it decides about something that another one owns."""
        hops = distance(self.machine, pe.number, owner) if self.rules.knows_hops else 0
        own = numbers(self.policy, self.workload.n_primaries, self.nb)
        return View(load=pe.load, hops=hops, **own, **seen)

    def known_load(self, clock: int, pe: PE, owner: int) -> tuple[Fraction, int]:
        """What a PE knows of the owner's load, and for how long it has."""
        if self.policy.load_info == "none":
            return Fraction(-1), clock
        if self.policy.load_info == "exact":
            return Fraction(self.pes[owner].ended_load), 0
        return pe.known_load[owner], clock - pe.heard[owner]

    def unasked(self, pe: PE, obj: int) -> list[tuple[int, int, int]]:
        """Entries of the wait file that no request in flight will serve."""
        entries = [entry for entry in pe.waiting if entry[1] == obj]
        if self.policy.merge_requests:
            return [] if pe.in_flight[obj] else entries
        return entries[pe.in_flight[obj] :]

    def requests(self, pe: PE, nothing_else: bool, may_ask: Rule) -> Iterator[tuple[int, Part]]:
        """Requests for each object that the rule allows."""
        oldest = {o: self.unasked(pe, o) for o in {o for _, o, _ in pe.waiting}}
        seen = {"nothing_else": nothing_else, "known_load": -1, "age_ps": 0}
        for obj in sorted((o for o in oldest if oldest[o]), key=lambda o: oldest[o][0]):
            view = self.view(pe, self.owners[obj], waiting=len(oldest[obj]), **seen)
            if not may_ask(view):
                continue
            for _ in oldest[obj][:1] if self.policy.merge_requests else oldest[obj]:
                yield self.owners[obj], Part(REQUEST, self.machine.request_bytes, obj)
                pe.in_flight[obj] += 1

    def refresh(self, pe: PE) -> None:
        """The own load to every partner that was sent nothing for long."""
        if self.policy.refresh_ps is None or not self.rules.knows_loads:
            return
        for other in self.others(pe):
            silence = pe.clock - pe.last_departure[other]
            if other in pe.peers and silence >= self.policy.refresh_ps:
                pe.clock = self.send(pe.clock, pe, other, [Part(LOAD, 0)])
