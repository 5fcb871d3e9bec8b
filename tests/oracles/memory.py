"""Memory that ends, in the oracle: what a PE's capacity is for, and used(p) from sets each time."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from fractions import Fraction
from math import floor

from oracles.costs import transfer_ps, unpacking
from oracles.state import PE, Lying, Message
from oracles.world import World
from simmpp.machine.messages import RAYS, REQUEST
from simmpp.placement.rooms import Room

STALLS = ("send", "receive", "ask")
"""What credit or room may refuse."""


@dataclass
class Parts:
    """Bytes of one PE's capacity, by what they are for."""

    capacity: int
    permanent: int
    control: int
    escape: int
    receive: int = 0
    fetch: int = 0
    queue: int = 0
    share: int = 0
    """Of ``receive``, for each other PE."""
    replicas: int = 0
    """Room for those that fill what is left."""


@dataclass
class Peak:
    """The most that a PE held, and what it was."""

    total: int = -1
    resident: int = 0
    fetched: int = 0
    rays: int = 0
    receive: int = 0


@dataclass
class Bounded(World):
    """Credits, admission, room for objects; ``credits`` is off where queues have no end."""

    peaks: dict[int, Peak] = field(default_factory=dict)
    peak_control: int = 0
    escapes: int = 0
    credit_messages: list[Message] = field(default_factory=list)
    stalls: list[tuple[str, int, int]] = field(default_factory=list)
    """(what, from, to): times in which credit or room refused something."""
    eventless: int = 0
    """Events since the last test or finished ray."""
    longest: int = 0
    infeasible: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self.bounds = self.placement.capacity
        self.alive = self.workload.n_primaries
        self.credits = self.bounds is not None and self.bounds.has_credits
        self.island = self.placement.island
        self.has_escape = self.bounds is not None and self.bounds.has_escape
        self.children = [
            [c for c, parent in enumerate(self.workload.parents) if parent == ray]
            for ray in range(self.workload.n_rays)
        ]
        self.most_alive = [0] * self.workload.n_rays
        for ray in reversed(range(self.workload.n_rays)):
            self.most_alive[ray] = max(1, sum(self.most_alive[c] for c in self.children[ray]))
        self.steals = self.policy.steal != "none"
        if self.credits or self.steals:
            for pe in self.pes:
                pe.pixels, pe.ready = pe.ready, []
        self.n_kept = self.placement.transient
        self.before = {pe.number: pe.resident for pe in self.pes}
        if self.bounds is None:
            return
        self.fill()
        for pe in self.pes:
            pe.untouched = set() if self.credits else pe.untouched
        self.peaks = {pe.number: Peak() for pe in self.pes}
        if self.credits:
            self.parts = self.split()
            for pe in self.pes:
                pe.credit = Counter({q: self.parts[q].share for q in self.others(pe)})
        for pe in self.pes:
            self.note_memory(pe)

    # --- the parts of a capacity ---

    def largest_tree(self) -> int:
        """Bytes of the rays of a pixel that can be alive at once, at most."""
        n = self.workload.n_primaries
        return self.machine.ray_bytes * max(self.most_alive[:n], default=0)

    def permanent(self, pe: PE) -> Parts:
        """What is never free, with the capacity still open."""
        assert self.bounds is not None
        lacking = [set(range(len(self.owners))) - self.before[each.number] for each in self.pes]
        escapes = self.bounds.has_escape
        can_ask = any(lacking) and (self.rules.ask is not None or escapes)
        request = self.machine.header_bytes + self.machine.request_bytes
        own = sum(self.object_bytes[o] for o in self.before[pe.number]) + self.copies()
        sizes = [self.object_bytes[o] for o in lacking[pe.number]]
        escape = max(sizes, default=0) if can_ask and escapes else 0
        return Parts(0, own, (self.island - 1) * request if can_ask else 0, escape)

    def copies(self) -> int:
        """Bytes of the tallies that every PE keeps for all objects."""
        kept = self.placement.tallies == "reduce" and self.nb > 1
        return int(self.workload.object_results.sum()) if kept else 0

    def least_receive(self) -> int:
        """A ray, with a header, of each other PE, if any is sent."""
        each = self.machine.header_bytes + self.machine.ray_bytes
        return (self.island - 1) * each if self.anything_lacks() and self.rules.send else 0

    def least(self) -> int:
        """The least capacity."""
        parts = [self.permanent(pe) for pe in self.pes]
        most = max(p.permanent + p.control + p.escape for p in parts)
        return most + self.largest_tree() + self.least_receive()

    def split(self) -> list[Parts]:
        """The parts of each PE."""
        assert self.bounds is not None
        capacity = self.least() if self.bounds.bytes == "least" else self.bounds.bytes
        fills = self.is_filled()
        result = []
        for pe in self.pes:
            parts = self.permanent(pe)
            parts.capacity = capacity
            rest = capacity - parts.permanent - parts.control - parts.escape
            for_rays = self.largest_tree()
            if fills:
                for_rays = max(for_rays, min(rest // 4, rest - self.least_receive()))
            if self.anything_lacks() and self.rules.send:
                wish = min(wished(self.bounds.buffers, rest), rest - for_rays)
                parts.receive = max(self.least_receive(), wish)
            if self.anything_lacks() and self.rules.ask:
                wish = wished(self.bounds.fetch, rest)
                parts.fetch = min(wish, rest - for_rays - parts.receive)
            parts.queue = for_rays if fills else rest - parts.receive - parts.fetch
            parts.replicas = rest - parts.receive - parts.fetch - parts.queue
            parts.share = parts.receive // max(1, self.island - 1)
            result.append(parts)
        return result

    def anything_lacks(self) -> bool:
        """Before replicas fill anything: does a PE lack an object?"""
        return any(set(range(len(self.owners))) - self.before[pe.number] for pe in self.pes)

    def is_filled(self) -> bool:
        """Do replicas take what is left?"""
        return self.placement.filling is not None and self.anything_lacks()

    def fill(self) -> None:
        """Deal replicas, in their order, as long as they fit."""
        filling = self.placement.filling
        if filling is None or not self.is_filled():
            return
        for pe, parts in zip(self.pes, self.split(), strict=True):
            room = parts.replicas
            for obj in filling.ranking(pe.number).tolist():
                room -= self.object_bytes[obj]
                if room < 0:
                    break
                pe.resident = pe.resident | {obj}
        if filling.keeps_as_many:
            mean = Fraction(sum(len(pe.resident) for pe in self.pes), self.nb)
            self.n_kept = floor(mean + Fraction(1, 2))
        for pe in self.pes:
            self.sample_bytes(pe)

    # --- what is held ---

    def started(self, pe: PE) -> set[int]:
        """Rays that take memory."""
        held = set(pe.ready) | {ray for _, _, ray in pe.waiting}
        if pe.stuck is not None:
            held.add(pe.stuck)
        return held if self.credits else held - pe.untouched

    def ray_memory(self, pe: PE) -> int:
        """Bytes of the rays that those of a PE may need, or without credits of those themselves."""
        rays = self.started(pe)
        needed = sum(self.most_alive[ray] for ray in rays) if self.credits else len(rays)
        return self.machine.ray_bytes * needed

    def fetched(self, pe: PE) -> int:
        """Bytes of objects that are kept, in use or asked for."""
        asked = {obj for obj, n in pe.in_flight.items() if n > 0}
        return sum(self.object_bytes[o] for o in asked | self.pinned(pe) | set(pe.transient))

    def unread(self, pe: PE) -> int:
        """Bytes of rays that lie in the inbox or in shares, with the headers of their messages."""
        header, each = self.machine.header_bytes, self.machine.ray_bytes
        lying = [m.n_rays for m in pe.inbox if m.n_rays] + [len(each.rays) for each in pe.shares]
        return sum(header + n * each for n in lying)

    def control(self, pe: PE) -> int:
        """Bytes of unread requests, and of headers without rays."""
        header, each = self.machine.header_bytes, self.machine.request_bytes
        return sum((not m.n_rays) * header + m.count(REQUEST) * each for m in pe.inbox)

    def note_memory(self, pe: PE) -> None:
        """Look what a PE holds: does it fit, is it more than ever before?"""
        if self.bounds is None:
            return
        resident = sum(self.object_bytes[o] for o in pe.resident) + self.copies()
        fetched, rays, unread = self.fetched(pe), self.ray_memory(pe), self.unread(pe)
        self.peak_control = max(self.peak_control, self.control(pe))
        peak, total = self.peaks[pe.number], resident + fetched + rays + unread
        if total > peak.total:
            self.peaks[pe.number] = Peak(total, resident, fetched, rays, unread)
        if self.credits:
            parts = self.parts[pe.number]
            assert fetched <= parts.fetch
            assert rays <= parts.queue
            assert unread <= parts.receive
            used = resident + parts.control + parts.escape + parts.receive + fetched + rays
            assert used <= parts.capacity

    def check_credits(self) -> None:
        """Credit, what is on its way, what lies there and what is owed: each pair's share."""
        if not self.credits:
            return
        header, each = self.machine.header_bytes, self.machine.ray_bytes
        under_way: Counter[tuple[int, int]] = Counter()
        for m in self.flying:
            if m.n_rays:
                under_way[m.source, m.destination] += header + m.n_rays * each
            under_way[m.destination, m.source] += m.credit
        for pe in self.pes:
            for m in pe.inbox:
                if m.n_rays:
                    under_way[m.source, pe.number] += header + m.n_rays * each
                under_way[pe.number, m.source] += m.credit
            for lying in pe.shares:
                under_way[lying.source, pe.number] += header + len(lying.rays) * each
        for sender in self.pes:
            for other in self.others(sender):
                pair, owed = (sender.number, other), self.pes[other].owed[sender.number]
                total = sender.credit[other] + under_way[pair] + owed
                assert total == self.parts[other].share, pair

    # --- rays ---

    def fits(self, pe: PE, ray: int) -> bool:
        """Is there room for all that may come of a ray?"""
        if not self.credits:
            return True
        more = self.machine.ray_bytes * self.most_alive[ray]
        return self.ray_memory(pe) + more <= self.parts[pe.number].queue

    def next_ray(self, pe: PE) -> int | None:
        """The ray to compute; a pixel is started if it is its turn and there is room."""
        is_its_turn = not pe.ready or (self.ready_order == "breadth-first" and not pe.cut)
        if pe.pixels and is_its_turn and self.fits(pe, pe.pixels[0]):
            pe.ready.insert(0, pe.pixels.pop(0))
            self.note_memory(pe)
        pe.cut = False
        if not pe.ready:
            return None
        if pe.ready[0] in pe.untouched:
            pe.untouched.discard(pe.ready[0])
            self.note_memory(pe)
        return pe.ready[0]

    def has_ready(self, pe: PE) -> bool:
        """Is there a ray to compute?"""
        return bool(pe.ready) or bool(pe.pixels and self.fits(pe, pe.pixels[0]))

    def can_unpack(self, pe: PE) -> bool:
        """Does a ray in a share fit?"""
        return any(self.fits(pe, ray) for lying in pe.shares for ray in lying.rays)

    def nothing_else(self, pe: PE) -> bool:
        """Is there nothing to do but to dispatch?"""
        return not (self.has_ready(pe) or pe.inbox or self.can_unpack(pe))

    def admit(self, pe: PE) -> list[int]:
        """Take rays that fit out of the shares, the oldest first; returns these."""
        admitted: list[int] = []
        for lying in pe.shares:
            for ray in list(lying.rays):
                room = self.parts[pe.number].queue - self.ray_memory(pe)
                reserved = sum(self.most_alive[each] for each in [*admitted, ray])
                if self.machine.ray_bytes * reserved <= room:
                    lying.rays.remove(ray)
                    admitted.append(ray)
                    pe.owed[lying.source] += self.machine.ray_bytes
            if not lying.rays:
                pe.owed[lying.source] += self.machine.header_bytes
        pe.shares = [lying for lying in pe.shares if lying.rays]
        pe.make_ready(admitted, self.ready_order)
        return admitted

    def unpack(self, time: int, pe: PE) -> int:
        """Take in what fits now, at its cost per byte; returns the end of that."""
        pe.refresh_allowed = True
        n_bytes = len(self.admit(pe)) * self.machine.ray_bytes
        cost = transfer_ps(n_bytes, self.machine.unpack[RAYS].bytes_per_s)
        clock = self.pay("communication", pe, time, cost)
        self.ledger.did_unpack(pe, time, clock, n_bytes // max(1, self.machine.ray_bytes), n_bytes)
        self.sample_rays(pe)
        return clock

    # --- credit ---

    def rays_allowed(self, pe: PE, other: int, n: int) -> int:
        """Of n rays, how many the credit lets go to a PE in one message."""
        if not self.credits:
            return n
        header, each = self.machine.header_bytes, self.machine.ray_bytes
        while n > 0 and header + n * each > pe.credit[other]:
            n -= 1
        return n

    def spend(self, pe: PE, other: int, n: int) -> None:
        """Rays go to a PE: the credit for them, and for a header, is used."""
        pe.credit[other] -= self.machine.header_bytes + n * self.machine.ray_bytes

    def unpacking(self, pe: PE, message: Message) -> int:
        """What a message costs who receives it; with credits, of the rays that are taken in now."""
        cost = super().unpacking(pe, message)
        pe.credit[message.source] += message.credit
        for part in message.parts:
            if part.kind == RAYS and self.credits:
                pe.shares.append(Lying(message.source, list(part.rays)))
                n_bytes = len(self.admit(pe)) * self.machine.ray_bytes
                cost += unpacking(self.machine, RAYS, n_bytes)
                cost -= unpacking(self.machine, RAYS, part.payload_bytes)
        return cost

    def enough_for(self, pe: PE, other: int, batch: int) -> int:
        """The batch that goes to a PE: no more than its share holds, but a ray."""
        if not self.credits or self.machine.ray_bytes == 0:
            return batch
        room = self.parts[other].share - self.machine.header_bytes
        return min(batch, max(1, room // self.machine.ray_bytes))

    def due_credits(self, pe: PE) -> list[int]:
        """PEs that are owed half of their share or more."""
        owed = pe.owed if self.credits else {}
        return [
            other
            for other in self.others(pe)
            if owed.get(other, 0) > 0 and 2 * owed[other] >= self.parts[pe.number].share
        ]

    def others(self, pe: PE) -> list[int]:
        """All other PEs of the island, beginning with the next one."""
        island = self.island_of(pe.number)
        at = island.index(pe.number)
        return island[at + 1 :] + island[:at]

    # --- objects ---

    def make_room(self, pe: PE, obj: int) -> bool:
        """Is there room to ask for an object, perhaps when kept ones leave?"""
        if not self.credits:
            return True
        room = self.parts[pe.number].fetch
        there = self.pinned(pe) | {o for o, n in pe.in_flight.items() if n > 0}
        kept = [o for o in pe.transient if o not in there]
        least = sum(self.object_bytes[o] for o in there | {obj})
        if least > room:
            return False
        while least + sum(self.object_bytes[o] for o in kept) > room:
            leaving = min(kept, key=lambda o: pe.worth[o])
            kept.remove(leaving)
            pe.transient.remove(leaving)
        return True

    def escape(self, pe: PE) -> int | None:
        """If a PE is stuck, the ray that has waited longest leaves the files; its object."""
        if not self.has_escape or pe.stuck is not None:
            return None
        waiting = [entry for entry in sorted(pe.waiting) if pe.in_flight[entry[1]] == 0]
        if not waiting or not self.nothing_else(pe):
            return None
        _, obj, ray = waiting[0]
        pe.unfile([ray])
        pe.stuck = ray
        self.escapes += 1
        return obj

    def note_stalls(self, time: int, pe: PE) -> None:
        """At the end of a dispatch: what was refused in it, and is no longer."""
        if not self.credits:
            return
        if pe.shares:
            pe.refused.add("receive")
        for what in STALLS:
            if what in pe.refused:
                pe.stalled.setdefault(what, time)
            elif what in pe.stalled:
                self.stalls.append((what, pe.stalled.pop(what), time))
        pe.refused = set()

    def stalled_ps(self, what: str) -> int:
        """Sum over PEs of the times in which something was refused, until the end of the run."""
        end = self.ledger.makespan_ps
        open_ones = [(key, since, end) for pe in self.pes for key, since in pe.stalled.items()]
        spans = [(a, b) for key, a, b in (*self.stalls, *open_ones) if key == what]
        return sum(max(0, min(b, end) - a) for a, b in spans)

    def memory_columns(self) -> dict[str, int]:
        """What is written of a capacity, by column."""
        if self.bounds is None:
            return {}
        peak = max(self.peaks.values(), key=lambda each: each.total)
        end, least = self.ledger.makespan_ps, self.least()
        capacity = least if self.bounds.bytes == "least" else self.bounds.bytes
        exceeds = 0
        if not self.credits:
            controls = [self.permanent(pe).control for pe in self.pes]
            most = max(self.peaks[k].total + n for k, n in enumerate(controls))
            exceeds = max(0, most - capacity)
        columns = {f"stalled_{what}_ps": self.stalled_ps(what) for what in STALLS}
        return columns | {
            "peak_resident": peak.resident,
            "peak_fetched": peak.fetched,
            "peak_ray_queue": peak.rays,
            "peak_receive": peak.receive,
            "peak_control": self.peak_control,
            "credit_messages": sum(m.departure <= end for m in self.credit_messages),
            "escapes": self.escapes,
            "least_bytes": least,
            "fits": int(capacity >= least and exceeds == 0),
            "exceeds_bytes": exceeds,
            "infeasible": int(self.infeasible),
        }

    # --- every event ---

    def roots_later(self, pe: PE) -> list[int]:
        """Of rounds that it has not begun."""
        return [ray for ray in pe.later if self.round_of[ray] >= pe.round]

    def note_event(self, progress: bool) -> None:
        """No more than so many events lie between two tests or finished rays."""
        self.eventless = 0 if progress else self.eventless + 1
        self.longest = max(self.longest, self.eventless)
        if self.credits:
            most = 10 * self.nb**3 + 200 + 10 * self.nb * self.rays_left
            assert self.eventless <= most
            held = sum(len(pe.ready) + len(pe.waiting) + len(pe.pixels) for pe in self.pes)
            held += sum(len(self.roots_later(pe)) for pe in self.pes)
            held += sum(len(lying.rays) for pe in self.pes for lying in pe.shares)
            on_their_way = [*self.flying, *(m for pe in self.pes for m in pe.inbox)]
            held += sum(m.n_rays + m.n_pixels for m in on_their_way)
            held += sum(pe.stuck is not None and pe.stuck not in pe.ready for pe in self.pes)
            assert held == self.alive
        self.check_credits()


def wished(wish: Fraction | Room, rest: int) -> int:
    """Bytes of a wish."""
    return wish.bytes if isinstance(wish, Room) else int(wish * rest)
