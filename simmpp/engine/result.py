"""What a run gives back: integers that add up.

A further column of ``results.csv`` is a name in ``columns`` and a field or property of ``Result``;
what has to be counted for it is declared in ``arrays.records`` and counted where it happens, in
``pe.step.note_peaks`` if it is the most that a PE holds of something.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simmpp.common.displayed import Displayed
from simmpp.common.documented import documented
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST

if TYPE_CHECKING:  # who only reads results needs no numba
    from simmpp.engine.memory_use import MemoryUse
    from simmpp.engine.record.counters import Counters


@documented
@dataclass(frozen=True, eq=False)
class Result(Displayed):
    """Makespan, counters and the accounts of every PE, clipped at the makespan."""

    policy: str
    """Its label or name."""
    engine: str
    """Which event loop ran it; all give the same integers."""
    makespan_ps: int
    """Simulated time until the last ray is finished."""
    messages_by_kind: tuple[int, int, int, int]
    """Messages sent, by the kind of their first part: requests, objects, rays, loads."""
    parts_by_kind: tuple[int, int, int, int]
    """Parts of them; each is a message of its own where nothing is packed."""
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
    """(nb,) int64: time of each PE in computing: tests and rays, and what launch_ps says."""
    communication_ps: NDArray[np.int64]
    """(nb,) int64: startups, packing, unpacking, probes."""
    waiting_ps: NDArray[np.int64]
    """(nb,) int64: makespan - compute - communication."""
    service_ps: NDArray[np.int64]
    """(nb,) int64: time of each PE's thread, beside these; 0 where the machine has none."""
    pe_peak_rays: NDArray[np.int64]
    """(nb,) int64: most rays that each PE held."""
    pe_peak_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes that each PE held."""
    pe_peak_object_bytes: NDArray[np.int64]
    """(nb,) int64: most bytes of objects, resident and fetched, that each PE held."""
    events: int
    """Activities and arrivals."""
    user_messages: int = 0
    """Messages of the policy's own that were sent."""
    user_dropped: int = 0
    """Further ones that were not: too many, or to nobody."""
    steal_messages: int = 0
    """Questions for pixels and answers to them."""
    launch_ps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(nb,) int64: of compute_ps, startups of computing, and what lanes left empty add."""
    work_ps: int = 0
    """What all tests and rays cost: T(1), the makespan of one PE that holds everything."""
    bound_ps: int = 0
    """That over the sum of all PEs' speeds (nb where all have 1), rounded up."""
    round_ends_ps: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    """(rounds,) int64: when the last ray of each round was finished; -1 where a run came to no end
    before."""
    residuals_ps: dict[str, int] = field(default_factory=dict)
    """When little was left to be done, of tables that say what is left: see ``residuals.LEFT``."""
    barriers: int = 0
    """Ends of rounds that others waited for."""
    barrier_ps: int = 0
    """Time of them all, from the last ray's end until every PE knew."""
    round_messages: int = 0
    """Messages of barriers, and of reductions that rounds began with."""
    tally_messages: int = 0
    """Messages of deposits, or of the reduction in which the copies of all tallies are added."""
    deposits: int = 0
    """Deposits in them."""
    reduction_ps: int = 0
    """Time of that reduction, when the last ray is finished; in the makespan, and in
    communication_ps of every PE."""
    rules_never_fired: tuple[str, ...] = ()
    """Rules that the policy has but that never sent or asked: "send", "ask"."""
    memory: MemoryUse | None = None
    """What became of the memory of PEs, where it has a capacity."""
    log: NDArray[np.void] | None = None
    """Event log, if asked for (see ``engine.log``)."""
    counters: Counters | None = None
    """With ``Recording.counters``: what happened when, and who sent how much to whom."""
    ray_hops: NDArray[np.int32] | None = None
    """(n,) int32, with ``Recording.hops``: links crossed for each ray, by itself in a message or by
    the requests and objects that it waited for. A view of the run's state, 16 bytes per ray."""
    ray_ends_ps: NDArray[np.int64] | None = None
    """(n,) int64, with ``Recording.ends``: when each ray was finished."""
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
        own = self.user_messages + self.steal_messages
        own += self.round_messages + self.tally_messages
        return sum(self.messages_by_kind) + own

    @property
    def parts(self) -> int:
        """Parts of messages, of all kinds."""
        return sum(self.parts_by_kind)

    @property
    def request_messages(self) -> int:
        """Messages of nothing but object requests."""
        return self.messages_by_kind[REQUEST]

    @property
    def object_messages(self) -> int:
        """Messages of objects."""
        return self.messages_by_kind[OBJECT]

    @property
    def ray_messages(self) -> int:
        """Messages with rays."""
        return self.messages_by_kind[RAYS]

    @property
    def load_messages(self) -> int:
        """Messages that carried nothing but the sender's load."""
        return self.messages_by_kind[LOAD]

    @property
    def request_parts(self) -> int:
        """Object requests sent."""
        return self.parts_by_kind[REQUEST]

    @property
    def object_parts(self) -> int:
        """Objects sent."""
        return self.parts_by_kind[OBJECT]

    @property
    def ray_parts(self) -> int:
        """Batches of rays sent."""
        return self.parts_by_kind[RAYS]

    @property
    def objects_fetched(self) -> int:
        """Objects sent as answers to requests."""
        return self.object_parts

    @property
    def peak_object_bytes(self) -> int:
        """Bytes of objects (resident, fetched) held by the PE that ever held most of them."""
        return int(self.pe_peak_object_bytes.max())
