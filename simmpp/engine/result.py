"""What a run gives back: integers that add up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.record.counters import Counters
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST


@dataclass(frozen=True, eq=False)
class Result:
    """Makespan, counters and the accounts of every PE, clipped at the makespan."""

    policy: str
    engine: str
    makespan_ps: int
    messages_by_kind: tuple[int, int, int, int]
    """Messages sent: requests, objects, rays, loads."""
    messages_received: int
    """Messages whose receive activity has begun; the others were in flight at the end."""
    bytes_sent: int
    """With headers."""
    rays: int
    """Rays finished."""
    tests: int
    """Ray-object intersections computed."""
    rays_sent: int
    """Rays moved by messages."""
    compute_ps: NDArray[np.int64]
    """(nb,) int64: time of each PE in tests and rays."""
    communication_ps: NDArray[np.int64]
    """(nb,) int64: startups, packing, unpacking, probes."""
    waiting_ps: NDArray[np.int64]
    """(nb,) int64: makespan - compute - communication."""
    pe_peak_rays: NDArray[np.int64]
    """(nb,) int64: most rays that each PE held."""
    pe_peak_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes that each PE held."""
    pe_peak_object_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes of objects, resident and fetched, that each PE held."""
    events: int
    """Activities and arrivals."""
    rules_never_fired: tuple[str, ...] = ()
    """Rules that the policy has but that never sent or asked: "send", "ask"."""
    log: NDArray[np.void] | None = None
    """Event log, if asked for (see ``engine.log``)."""
    counters: Counters | None = None
    """With ``Recording.counters``: what happened when, and who sent how much to whom."""
    ray_hops: NDArray[np.int32] | None = None
    """(n,) int32, with ``Recording.hops``: links crossed for each ray, by itself in a message or by
    the requests and objects that it waited for. A view of the run's state, 16 bytes per ray."""
    tested_rays: NDArray[np.int32] | None = None
    """(tests,) int32, with ``Recording.tests``: the ray of each test in the order performed."""
    tested_objects: NDArray[np.int32] | None = None
    """(tests,) int32, with ``Recording.tests``: the object of each test."""

    @property
    def peak_rays(self) -> int:
        """Rays held (ready and waiting) by the PE that ever held most."""
        return int(self.pe_peak_rays.max())

    @property
    def peak_bytes(self) -> int:
        """Bytes held (resident and fetched objects, rays) by the PE that ever held most."""
        return int(self.pe_peak_bytes.max())

    @property
    def messages(self) -> int:
        """Messages sent, of all kinds."""
        return sum(self.messages_by_kind)

    @property
    def request_messages(self) -> int:
        """Object requests sent."""
        return self.messages_by_kind[REQUEST]

    @property
    def object_messages(self) -> int:
        """Objects sent."""
        return self.messages_by_kind[OBJECT]

    @property
    def ray_messages(self) -> int:
        """Batches of rays sent."""
        return self.messages_by_kind[RAYS]

    @property
    def load_messages(self) -> int:
        """Messages that carried nothing but the sender's load."""
        return self.messages_by_kind[LOAD]

    @property
    def objects_fetched(self) -> int:
        """Objects sent as answers to requests: one in each object message."""
        return self.object_messages
