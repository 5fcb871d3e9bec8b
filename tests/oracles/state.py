"""What one PE of the oracle holds, in plain lists that are searched from end to end."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from oracles.pace import Go
from simmpp.machine.messages import OBJECT, RAYS

WHOSE_LOAD = -2
"""In place of an object: a get of a PE's load."""


class Part(NamedTuple):
    """What is packed and unpacked at one go: a batch of rays, a request, an object, or nothing."""

    kind: int
    payload_bytes: int
    obj: int = -1
    rays: tuple[int, ...] = ()
    words: tuple[int, ...] = ()
    pixels: tuple[int, ...] | None = None
    """An answer to a thief."""
    of_round: int = 0
    """That a batch of deposits counts for."""
    escape: bool = False
    """A request for, or an object of, the room of an escape."""


@dataclass
class Lying:
    """Rays of one message that lie in their sender's share."""

    source: int
    rays: list[int]


@dataclass
class Message:
    """One message, with what its header and its payload carry."""

    source: int
    destination: int
    send_number: int
    parts: tuple[Part, ...]
    load: int
    """The sender's load at packing, without the rays in this message."""
    departure: int
    credit: int = 0
    """Bytes of the sender's share for the receiver that are free again."""

    @property
    def kind(self) -> int:
        """That of the first part."""
        return self.parts[0].kind

    @property
    def payload_bytes(self) -> int:
        """Of all parts."""
        return sum(part.payload_bytes for part in self.parts)

    @property
    def n_rays(self) -> int:
        """In all parts."""
        return sum(len(part.rays) for part in self.parts)

    @property
    def carries(self) -> bool:
        """Whether rays or an object are in it."""
        return bool(self.count(OBJECT) or self.count(RAYS))

    @property
    def n_pixels(self) -> int:
        """That a thief gets."""
        return len(self.parts[0].pixels or ())

    @property
    def asks_for_load(self) -> bool:
        """Whether it is a get of a load."""
        return self.parts[0].obj == WHOSE_LOAD

    def count(self, kind: int) -> int:
        """How many parts are of a kind."""
        return sum(part.kind == kind for part in self.parts)


@dataclass
class PE:
    """One processing element."""

    number: int
    resident: set[int]
    ready: list[int]
    """Rays, the front one first."""
    known_load: list[int]
    heard: Counter[int] = field(default_factory=Counter)
    """PE: when its load was heard last; 0 if never."""
    waiting: list[tuple[int, int, int]] = field(default_factory=list)
    """(rank of beginning to wait, object, ray), the oldest first."""
    in_flight: Counter[int] = field(default_factory=Counter)
    """Object: requests not yet answered."""
    sendable_since: dict[int, int] = field(default_factory=dict)
    """Object: rank of the moment its waiting rays became sendable."""
    granted: set[int] = field(default_factory=set)
    """Ready rays whose next object was fetched for them."""
    transient: list[int] = field(default_factory=list)
    """Fetched objects kept, the least recently used first."""
    inbox: deque[Message] = field(default_factory=deque)
    asleep: bool = False
    to_be_served: deque[Message] = field(default_factory=deque)
    """What its thread has not looked at."""
    in_hand: Message | None = None
    """What its thread unpacks."""
    thread_asleep: bool = True
    thread_instants: int = 0
    instants: int = 0
    sends: int = 0
    ranks: int = 0
    peers: set[int] = field(default_factory=set)
    last_departure: Counter[int] = field(default_factory=Counter)
    clock: int = 0
    """The time at which this PE is with what it sends at a dispatch."""
    ended_load: int = 0
    """Load at the end of the last ended activity."""
    refresh_allowed: bool = True
    in_flight_to: Counter[int] = field(default_factory=Counter)
    """PE: rays sent to it since it was heard."""
    worth: dict[int, float] = field(default_factory=dict)
    """Of objects in the transient memory, as the policy says; infinite if it has not."""
    goes: int = 0
    """At computing so far."""
    go: Go = field(default_factory=Go)
    memory: list[int] = field(default_factory=lambda: [0] * 8)
    """For the policy."""
    draws: int = 0
    """Random numbers that the policy was given."""
    pixels: list[int] = field(default_factory=list)
    """With credits, or stealing: primary rays that are not started, and so are not among the ready
    ones."""
    asked: set[int] = field(default_factory=set)
    """PEs that were asked for pixels since rays or pixels came last."""
    awaits: bool = False
    """One of them has not answered."""
    untouched: set[int] = field(default_factory=set)
    """Without: primary rays among the ready ones that were never the first."""
    later: list[int] = field(default_factory=list)
    """Primary rays of rounds that have not begun."""
    round: int = 0
    """The first of those."""
    deposits: defaultdict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    """PE: rays that have left something in its objects' results, which is not sent yet."""
    owes: int = 0
    """Time for reductions that rounds have begun with."""
    cut: bool = False
    """The front one of the ready rays was cut by the quantum."""
    shares: list[Lying] = field(default_factory=list)
    """Rays that have been received and did not fit, the oldest message first."""
    credit: Counter[int] = field(default_factory=Counter)
    """PE: bytes that may be sent to it."""
    owed: Counter[int] = field(default_factory=Counter)
    """PE: bytes of its share that are free again, and that it has not been told of."""
    stuck: int | None = None
    """A ray whose object comes, or is, in the escape room."""
    refused: set[str] = field(default_factory=set)
    """What credit or room has refused in this dispatch: send, receive, ask."""
    stalled: dict[str, int] = field(default_factory=dict)
    """What is refused: since when."""
    paid: Counter[str] = field(default_factory=Counter)
    """Account: time that all its work has taken."""
    worked: Counter[str] = field(default_factory=Counter)
    """The same when the latest activity or its dispatch began."""
    finished: int = 0
    """Rays that ended here."""
    fetched: int = 0
    """Objects that have come on request."""
    released: int = 0
    """Rays that these made ready."""
    wish: int = 0
    """When the policy wants it to be woken; 0: not at all."""
    last_woken: int = 0
    """When it was; 0: never."""
    said: int = 0
    """Messages of the policy's own since it last got on."""
    times_woken: int = 0
    """Since then."""

    @property
    def load(self) -> int:
        """Rays held."""
        is_away = self.stuck is not None and self.stuck not in self.ready
        return self.n_ready + len(self.waiting) + is_away

    @property
    def n_ready(self) -> int:
        """Rays that wait for nothing but their turn, and room."""
        return len(self.ready) + len(self.pixels)

    def next_rank(self) -> int:
        """One more than the last rank given."""
        self.ranks += 1
        return self.ranks

    def rays_of(self, obj: int) -> list[int]:
        """Rays that wait for an object, the oldest first."""
        return [ray for _, waits_for, ray in self.waiting if waits_for == obj]

    def file(self, ray: int, obj: int) -> None:
        """Let a ray wait for an object, behind all others."""
        rank = self.next_rank()
        if not self.rays_of(obj) and not self.in_flight[obj]:
            self.sendable_since[obj] = rank
        self.waiting.append((rank, obj, ray))

    def unfile(self, rays: list[int]) -> None:
        """Take rays out of the wait files."""
        self.waiting = [entry for entry in self.waiting if entry[2] not in rays]

    def make_ready(self, rays: list[int], ready_order: str) -> None:
        """Put a block of rays to the front (depth-first) or the back."""
        self.ready = rays + self.ready if ready_order == "depth-first" else self.ready + rays

    def use(self, obj: int) -> None:
        """Note that an object of the transient memory was used."""
        if obj in self.transient:
            self.transient.remove(obj)
            self.transient.append(obj)

    def keep(self, obj: int, is_too_much: Callable[[list[int]], bool]) -> None:
        """Put a fetched object into the transient memory; those of the least rank leave."""
        if obj in self.transient:
            self.transient.remove(obj)
        else:
            self.worth[obj] = float("inf")
        self.transient.append(obj)
        while is_too_much(self.transient):
            self.transient.remove(min(self.transient, key=lambda kept: self.worth[kept]))
