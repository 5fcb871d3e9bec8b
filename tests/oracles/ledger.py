"""What the oracle writes down during a run, and the totals that come out of it at the end."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from oracles.state import PE, Message
from simmpp.machine.messages import DEPOSIT, MESSAGE_KINDS, OBJECT, RAYS, REQUEST, STEAL, USER


class Slice(NamedTuple):
    """One thing that a PE did."""

    pe: int
    begin: int
    what: str
    """"compute", "receive" or "send"; "serve" or "answer" of a thread or network card."""
    end: int
    tests: int = 0
    rays: int = 0
    """In the message, or finished by the computation."""
    load: int = 0
    """Of the PE at the end."""
    ready: int = 0
    other: int = -1
    """The PE at the other end of the message."""
    kind: int = -1
    number: int = -1
    """The sender's send number; -1 if the message never departed."""
    payload_bytes: int = 0
    objects: int = 0
    """In the message."""
    requests: int = 0
    """In the message."""


Activity = tuple[int, int, str, int, int]


def in_order(activities: list[Activity]) -> list[Activity]:
    """By beginning and PE, those of a thread behind."""
    return sorted(activities, key=lambda row: (*row[:2], row[2].startswith("serve")))


def who(row: Slice) -> tuple[int, bool]:
    """A PE, or what serves beside it: what one of them did is in the order of time."""
    return row.pe, row.what in ("serve", "answer")


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
    parts_by_kind: tuple[int, int, int, int]
    """Requests, objects, batches of rays and loads that messages carried."""
    user_messages: int
    user_dropped: int
    steal_messages: int
    compute_ps: list[int]
    communication_ps: list[int]
    waiting_ps: list[int]
    service_ps: list[int]
    """Of threads."""
    peak_rays: int
    peak_bytes: int
    events: int
    rules_never_fired: tuple[str, ...]
    arrivals: list[tuple[int, int, int, int, str, int]]
    """(time, destination, source, send number, message kind, payload bytes)."""
    activities: list[Activity]
    """(begin, PE, "receive <kind>", "compute" or "serve <kind>", end, tests)."""
    slices: list[Slice]
    """Every message unpacked or packed and every computation, by ``who``, one after another."""
    tested: list[tuple[int, int]]
    """(ray, object) in the order performed: by the beginnings of the computes."""
    ray_hops: list[int]
    """Links crossed for each ray: by itself, or by a request and an object that it waited for."""
    ray_ends: list[int]
    """When each ray was finished."""
    tally_messages: int = 0
    reduction_ps: int = 0
    round_messages: int = 0
    """Of barriers and reductions."""
    round_ends: list[int] = field(default_factory=list)
    """When the last ray of each round was finished; -1 where one was not."""
    memory: dict[str, int] = field(default_factory=dict)
    """What is written of a capacity, by column."""


@dataclass
class Ledger:
    """Every cost, message, arrival, activity and test of a run, in lists."""

    costs: list[tuple[str, int, int, int]] = field(default_factory=list)
    """(account, PE, from, to)."""
    sent: list[Message] = field(default_factory=list)
    received: int = 0
    arrivals: list[tuple[int, int, int, int, str, int]] = field(default_factory=list)
    open: dict[int, tuple[int, str, int]] = field(default_factory=dict)
    """PE: (begin, kind, tests) of the activity that has not ended; -1 - PE: of its thread."""
    activities: list[tuple[int, int, str, int, int]] = field(default_factory=list)
    slices: list[Slice] = field(default_factory=list)
    tested: list[tuple[int, int]] = field(default_factory=list)
    finished_ps: list[int] = field(default_factory=list)
    """The ends of finished rays."""
    deposited_ps: list[int] = field(default_factory=list)
    """When batches of deposits were received."""
    ray_hops: list[int] = field(default_factory=list)
    ray_ends: list[int] = field(default_factory=list)
    dropped: int = 0
    """Messages of the policy's own that were not sent."""
    held_rays: list[int] = field(default_factory=list)
    held_bytes: list[int] = field(default_factory=list)

    @property
    def makespan_ps(self) -> int:
        """The end of the last ray's last cost, or of the receipt of the last deposits."""
        return max([*self.finished_ps, *self.deposited_ps], default=0)

    def pay(self, account: str, pe: int, clock: int, cost: int) -> int:
        """Write down a cost; returns the time when it has been paid."""
        self.costs.append((account, pe, clock, clock + cost))
        return clock + cost

    def arrived(self, time: int, m: Message) -> None:
        """Write down an arrival."""
        kind = MESSAGE_KINDS[m.kind]
        self.arrivals.append((time, m.destination, m.source, m.send_number, kind, m.payload_bytes))

    def end_activity(self, pe: int, end: int) -> None:
        """Write down an activity that is over."""
        begin, kind, n_tests = self.open.pop(pe)
        self.activities.append((begin, max(pe, -1 - pe), kind, end, n_tests))

    def did(self, pe: PE, begin: int, what: str, end: int, m: Message | None, **more: int) -> None:
        """Write down what a PE did."""
        state = {"load": pe.load, "ready": pe.n_ready}
        if what in ("serve", "answer"):  # the PE may be in an activity
            state = {"load": -1, "ready": -1}
        if m is not None:
            state |= {"kind": m.kind, "number": m.send_number, "payload_bytes": m.payload_bytes}
            state |= {"other": m.source if what in ("receive", "serve") else m.destination}
            state |= {"rays": m.n_rays + m.n_pixels}
            state |= {"objects": m.count(OBJECT), "requests": m.count(REQUEST)}
        self.slices.append(Slice(pe.number, begin, what, end, **(state | more)))

    def did_unpack(self, pe: PE, begin: int, end: int, rays: int, n_bytes: int) -> None:
        """Write down that rays were taken out of their shares."""
        of = {"rays": rays, "payload_bytes": n_bytes, "kind": RAYS}
        self.did(pe, begin, "receive", end, None, **of)

    def clipped(self, end: int) -> list[Slice]:
        """What was done until the end of the run, by PE and time."""
        kept = [s for s in self.slices if s.end <= end or s.begin < end]
        late = [s._replace(end=end) for s in kept]
        late = [s._replace(number=-1) if s.what in ("send", "answer") else s for s in late]
        found = [s if s.end <= end else short for s, short in zip(kept, late, strict=True)]
        return sorted(found, key=who)

    def account(self, name: str, pe: int) -> int:
        """Time of a PE in an account, clipped at the makespan."""
        end = self.makespan_ps
        return sum(
            min(to, end) - min(since, end)
            for account, number, since, to in self.costs
            if account == name and number == pe
        )

    def outcome(self, processors: int, header_bytes: int, rules: tuple[str, ...]) -> Outcome:
        """The totals; ``rules`` are those that the policy has ("send", "ask")."""
        end = self.makespan_ps
        for pe in list(self.open):
            self.end_activity(pe, end)
        sent = [m for m in self.sent if m.departure <= end]
        by_kind = [sum(m.kind == kind for m in sent) for kind in range(4)]
        requests, objects, rays, loads = by_kind
        parts = [sum(m.count(kind) for m in sent) for kind in range(4)]
        fired = {"send": parts[RAYS] > 0, "ask": parts[REQUEST] > 0}
        compute = [self.account("compute", k) for k in range(processors)]
        communication = [self.account("communication", k) for k in range(processors)]
        activities = [(*row[:3], min(row[3], end), row[4]) for row in self.activities]
        return Outcome(
            makespan_ps=end,
            messages_by_kind=(requests, objects, rays, loads),
            messages_received=self.received,
            bytes_sent=sum(m.payload_bytes + header_bytes for m in sent),
            rays=len(self.finished_ps),
            tests=len(self.tested),
            rays_sent=sum(m.n_rays for m in sent),
            user_messages=sum(m.kind == USER for m in sent),
            user_dropped=self.dropped,
            tally_messages=sum(m.kind == DEPOSIT for m in sent),
            steal_messages=sum(m.kind == STEAL for m in sent),
            parts_by_kind=(parts[0], parts[1], parts[2], parts[3]),
            compute_ps=compute,
            communication_ps=communication,
            waiting_ps=[end - a - b for a, b in zip(compute, communication, strict=True)],
            service_ps=[self.account("service", k) for k in range(processors)],
            peak_rays=max(self.held_rays),
            peak_bytes=max(self.held_bytes),
            events=len(activities) + len(self.arrivals),
            rules_never_fired=tuple(rule for rule in rules if not fired[rule]),
            arrivals=sorted(self.arrivals),
            activities=in_order(activities),
            slices=self.clipped(end),
            tested=self.tested,
            ray_hops=self.ray_hops,
            ray_ends=self.ray_ends,
        )
