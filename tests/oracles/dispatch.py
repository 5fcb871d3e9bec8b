"""What the oracle's PE sends at the end of an activity: rays, requests, its load."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from oracles.state import PE, WHOSE_LOAD, Part
from oracles.view import Views, numbers, random_draw
from simmpp.machine.messages import LOAD, RAYS, REQUEST
from simmpp.policy.policy import Hook
from simmpp.policy.reads import knows_loads, names_in

Parcel = tuple[int, list[Part]]
"""A destination, and what goes to it in one message."""


class Dispatch(Views):
    """The policy's hooks send and ask, and the refresh of loads."""

    def send_all(self, time: int, pe: PE) -> int:
        """Send all that may be sent from a time on; returns the end of that."""
        pe.clock = time
        deposits = self.batches(pe, self.nothing_else(pe))
        decisions = self.decisions(pe)
        # One by one, what has been decided departs before the next decision; else all are made
        # before the first message is packed.
        if self.policy.packing == "none":
            messages: Iterable[Parcel] = ((owner, [part]) for owner, part in decisions)
        else:
            messages = self.packed(pe, list(decisions))
        for destination, parts in messages:
            pe.clock = self.send(pe.clock, pe, destination, parts)
        for owner, batch in deposits:
            pe.clock = self.send(pe.clock, pe, owner, [batch])
        if self.policy.load_info == "piggyback" and pe.refresh_allowed:
            self.refresh(pe)
        for other in self.due_credits(pe):
            pe.clock = self.send(pe.clock, pe, other, [Part(LOAD, 0)])
            self.credit_messages.append(self.ledger.sent[-1])
        return pe.clock

    def decisions(self, pe: PE) -> Iterator[tuple[int, Part]]:
        """To whom what goes: rays, then requests; each is decided when it is drawn."""
        nothing_else = self.nothing_else(pe)
        if self.rules.send:
            yield from self.rays_to_send(pe, nothing_else, self.rules.send)
        if self.rules.ask:
            yield from self.requests(pe, nothing_else, self.rules.ask)
        stuck_for = self.escape(pe)
        if stuck_for is not None:
            request = Part(REQUEST, self.machine.request_bytes, stuck_for, escape=True)
            yield self.owner_of(pe.number, stuck_for), request

    def packed(self, pe: PE, decided: list[tuple[int, Part]]) -> Iterator[Parcel]:
        """Messages of what has been decided, those that may share one together."""
        shared = {"requests": ((RAYS,), (REQUEST,)), "all": ((RAYS, REQUEST),)}
        if self.machine.service == "nic":  # a get is a message of its own
            for kind in (RAYS, REQUEST):
                for other in self.others(pe):
                    alone = [part for to, part in decided if to == other and part.kind == kind]
                    yield from ((other, [part]) for part in alone)
            return
        for kinds in shared[self.policy.packing]:
            for other in self.others(pe):
                parts = [part for to, part in decided if to == other and part.kind in kinds]
                if parts:
                    yield other, parts

    def number(self, count: int | str) -> int:
        """A number, or that of the policy so called."""
        if isinstance(count, str):
            own = dict(zip(self.rules.parameters, self.policy.numbers, strict=True))
            known = numbers(self.policy, self.roots_at_once, self.nb)
            return (known | own)[count]
        return count

    def is_asked(self, waiting: int, count: int | str, nothing_else: bool) -> bool:
        """Do enough rays wait, or is nothing else to do?"""
        return waiting > 0 and (nothing_else or waiting >= self.number(count))

    def is_asked_to_send(self, pe: PE, other: int, nothing_else: bool) -> bool:
        """Do enough rays wait that may go to a PE?"""
        batch = self.enough_for(pe, other, self.number(self.rules.batch))
        return self.is_asked(self.n_sendable(pe, other), batch, nothing_else)

    def candidates(self, pe: PE, nothing_else: bool) -> list[int]:
        """PEs that send is asked about, in this order."""
        asked = [
            other for other in self.others(pe) if self.is_asked_to_send(pe, other, nothing_else)
        ]
        if self.rules.candidates == "owner":
            return asked
        if self.policy.load_info == "two" and len(asked) > 2:
            one = asked[random_draw(self.seed, pe) % len(asked)]
            rest = [other for other in asked if other != one]
            two = (one, rest[random_draw(self.seed, pe) % len(rest)])
            asked = [other for other in asked if other in two]
        return sorted(asked, key=lambda other: self.known_load(pe.clock, pe, other)[0])

    def n_sendable(self, pe: PE, other: int) -> int:
        """How many rays may be sent to a PE."""
        return sum(map(len, self.sendable(pe, other)))

    def may_go(self, pe: PE, obj: int, other: int) -> bool:
        """May rays that need an object go there?"""
        if self.rules.candidates == "owner":
            return self.owner_of(pe.number, obj) == other
        return obj in self.pes[other].resident

    def sendable(self, pe: PE, other: int) -> list[list[int]]:
        """Rays that may be sent to a PE, object by object, in the order of the message."""
        waited_for = {o for _, o, _ in pe.waiting if not pe.in_flight[o]}
        objects = [o for o in waited_for if self.may_go(pe, o, other)]
        by_age = sorted(objects, key=lambda o: pe.sendable_since[o])
        return [pe.rays_of(o) for o in by_age]

    def rays_to_send(self, pe: PE, nothing_else: bool, send: Hook) -> Iterator[tuple[int, Part]]:
        """A batch to each PE that the hook lets any go to: of whole objects, until enough."""
        draws = "random" in names_in(send)
        for owner in self.candidates(pe, nothing_else):
            groups, rays = self.sendable(pe, owner), list[int]()
            waiting = sum(map(len, groups))
            if not self.is_asked_to_send(pe, owner, nothing_else):
                continue
            enough = send(self.view_of_destination(pe, owner, groups, nothing_else, draws))
            most = self.rays_allowed(pe, owner, waiting)
            while groups and len(rays) < min(enough, most):
                rays += groups.pop(0)
            if min(len(rays), most) < enough and (groups or len(rays) > most):
                pe.refused.add("send")
            rays = rays[:most]
            if rays:
                pe.unfile(rays)
                self.spend(pe, owner, len(rays))
                pe.in_flight_to[owner] += len(rays)
                yield owner, Part(RAYS, len(rays) * self.machine.ray_bytes, rays=tuple(rays))

    def unasked(self, pe: PE, obj: int) -> list[tuple[int, int, int]]:
        """Entries of the wait file that no request in flight will serve."""
        entries = [entry for entry in pe.waiting if entry[1] == obj]
        if self.policy.merge_requests:
            return [] if pe.in_flight[obj] else entries
        return entries[pe.in_flight[obj] :]

    def requests(self, pe: PE, nothing_else: bool, ask: Hook) -> Iterator[tuple[int, Part]]:
        """Requests for each object that the hook allows, to whom it says."""
        draws = "random" in names_in(ask)
        oldest = {o: self.unasked(pe, o) for o in {o for _, o, _ in pe.waiting}}
        for obj in sorted((o for o in oldest if oldest[o]), key=lambda o: oldest[o][0]):
            unasked = len(oldest[obj])
            if not self.is_asked(unasked, self.rules.ask_at_least, nothing_else):
                continue
            answer = ask(self.view_of_object(pe, obj, unasked, nothing_else, draws))
            chosen = dict(enumerate(self.island_of(pe.number), 2)).get(int(answer))
            if chosen is None or obj not in self.pes[chosen].resident:
                chosen = self.owner_of(pe.number, obj)
            if answer > 0 and not self.make_room(pe, obj):
                pe.refused.add("ask")
                continue
            for _ in range(0 if answer <= 0 else 1 if self.policy.merge_requests else unasked):
                yield chosen, Part(REQUEST, self.machine.request_bytes, obj)
                pe.in_flight[obj] += 1

    def refresh(self, pe: PE) -> None:
        """The own load to every partner that was sent nothing for long."""
        if self.policy.refresh_ps is None or not (knows_loads(self.rules) or self.steals):
            return
        for other in self.others(pe):
            last, load = pe.last_departure[other], Part(LOAD, 0)
            if self.machine.service == "nic":
                last = max(last, pe.heard[other])
                load = Part(LOAD, self.machine.request_bytes, WHOSE_LOAD)
            if other in pe.peers and pe.clock - last >= self.policy.refresh_ps:
                pe.clock = self.send(pe.clock, pe, other, [load])
