"""How the state of a run lies in memory: one record of scalars and of where its arrays are.

The model gets this one record. Forty arrays as arguments would be copied word by word at every
call between compiled functions; a record is one pointer.

An example: ray 7 on PE 2 needs object 40 of 100, which PE 5 owns, and waits.

    rays[7].next             NONE: it is the last that waits
    misses[row]              of key 2 * 100 + 40: first = last = 7, n = 1, unasked = 1, requests = 0
    miss_buckets             hashed by that key: where ``row`` is found
    unasked_ends, _links     ``row`` in list 2 * 2 (or 2 * 2 + 1 from ``ask_from`` rays on)
    peers[miss.peer]         of key 2 * nb + 5: sendable = 1, load = what PE 5 said last
    pes[2].load              still counts the ray

Once it is asked for, ``unasked`` is 0, ``requests`` 1 and the row in no such list; a REQUEST lies
in ``messages``, and its place there in ``outbox``, from where an engine takes it on its way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.arrays.records import (
    BINS,
    COPY,
    CREDIT,
    EVENT,
    EVENT_KEY,
    HELD,
    MESSAGE,
    MISS,
    MOMENT,
    PACE,
    PE,
    PEER,
    PROCESS,
    RAY,
    ROOM,
    ROUND,
    SIZES,
    SLICE,
    TRAFFIC,
)
from simmpp.machine.machine import Machine
from simmpp.machine.messages import MESSAGE_KINDS, USER_WORDS
from simmpp.policy.record import VIEW

I1, I4, I8 = np.dtype("u1"), np.dtype("i4"), np.dtype("i8")


@dataclass(frozen=True)
class Sizes:
    """What the lengths of arrays are made of."""

    nb: int
    island: int
    """PEs of an island."""
    objects: int
    rays: int
    misses: int
    """Rows: objects that PEs lack at the same time, at most."""
    peers: int
    """Rows: pairs of PEs that know of each other, at most."""
    sent: int
    """Messages that one step of a PE sends at most."""
    messages: int
    """In flight or in an inbox, to begin with."""
    talks: bool
    """The policy may send messages of its own."""
    deposits: bool
    """Tests leave deposits that their owners are sent."""
    steals: bool
    """PEs ask others for pixels."""
    tested: int
    """Tests that are recorded."""
    ended: int
    """Rays whose end is recorded."""
    logged: int
    """Rows of the event log that are kept before they are handed on."""
    counted: int
    """PEs whose time is counted: nb, or 0 without counters."""
    bounded: bool = False
    """Credits say how many rays may be sent."""
    measured: bool = False
    """There is a capacity to compare with."""


class Array(NamedTuple):
    """One array of a run; ``<name>_at`` in RUN is its address, ``<name>_n`` its length."""

    dtype: np.dtype[Any]
    length: Callable[[Sizes], int] | None = None
    """Zeros to begin with; None: it is given, by workload, placement or machine."""


def _hashed(rows: int) -> int:
    """Buckets for that many rows: a power of two."""
    return 1 << max(4, (rows - 1).bit_length())


ARRAYS = {
    # of the workload and the placement: shared, only read
    "itinerary_offsets": Array(I8),  # (n + 1,)
    "itinerary_objects": Array(I4),  # (tests,)
    "child_offsets": Array(I4),  # (n + 1,)
    "object_bytes": Array(I8),  # (N,)
    "test_ps": Array(I8),  # (N,)
    "test_scales": Array(I1),  # (n,) tests of this ray cost 2^k of that; empty if all k are 0
    "owners": Array(I4),  # (N,), in each island, counted from its first PE
    # PEs that hold each object for good (CSR); empty where the policy does not want to know.
    "holder_offsets": Array(I8),
    "holder_pes": Array(I4),
    # Replicas as bits (bit o of the row_bytes at k * row_bytes: PE k holds object o) or, where
    # that takes less memory, as sorted ids (CSR); the other form is empty.
    "resident": Array(I1),
    "replica_offsets": Array(I8),
    "replica_objects": Array(I4),
    "pixels": Array(I4),  # (n0,) primary rays, those of each PE in a row, by round
    "ray_rounds": Array(I4),  # (n,); this and the next are empty where all rays are of one round
    "rounds": Array(ROUND),
    "leaves": Array(I1),  # (tests,) 1: a deposit; this and the next are empty if none is sent
    "deposits": Array(I4, lambda n: n.peers if n.deposits else 0),  # beside ``peers``: not sent yet
    "deposit_rounds": Array(I4, lambda n: n.peers if n.deposits else 0),  # that they count for
    # Peers with deposits: list 2 k of PE k, or 2 k + 1 from deposits_from on.
    "deposit_ends": Array(I4, lambda n: 4 * n.nb if n.deposits else 0),
    "deposit_links": Array(I4, lambda n: 2 * n.peers if n.deposits else 0),
    # of a capacity; empty without one
    "rooms": Array(ROOM),  # (nb,)
    "most_alive": Array(I4),  # (n,) rays of its tree that can be alive at once
    "waited": Array(I8, lambda n: n.rays if n.bounded else 0),  # PE.waits when a ray began to wait
    "credits": Array(CREDIT, lambda n: n.peers if n.bounded else 0),  # beside ``peers``
    # Peers that are owed half of their share or more.
    "due_ends": Array(I4, lambda n: 2 * n.nb if n.bounded else 0),
    "due_links": Array(I4, lambda n: 2 * n.peers if n.bounded else 0),
    # of machine and policy
    "copy_costs": Array(COPY),
    "noise_factors": Array(I8),  # equally likely ones; empty without noise
    "topology": Array(I8),  # as ``machine.topology`` reads it
    # What hooks are shown, filled anew for each question: one for all PEs or, where a policy has a
    # memory, one for each.
    "policy_views": Array(VIEW),
    # of the run
    "sent_by_kind": Array(I8, lambda n: len(MESSAGE_KINDS)),
    "parts_by_kind": Array(I8, lambda n: len(MESSAGE_KINDS)),  # that all messages are made of
    "pes": Array(PE, lambda n: n.nb),
    "rays": Array(RAY, lambda n: n.rays),
    "misses": Array(MISS, lambda n: n.misses),  # objects that a PE lacks, or holds for a while
    "miss_buckets": Array(I4, lambda n: _hashed(n.misses)),
    "miss_marks": Array(I4, lambda n: 2),
    "peers": Array(PEER, lambda n: n.peers),  # what a PE knows of another and holds for it
    "peer_buckets": Array(I4, lambda n: _hashed(n.peers)),
    "peer_marks": Array(I4, lambda n: 2),
    # in flight or in an inbox; grows
    "messages": Array(MESSAGE, lambda n: n.messages),
    "message_marks": Array(I4, lambda n: 2),
    # Words of messages of the policy's own, USER_WORDS for each place; empty if it sends none.
    "user_words": Array(I8, lambda n: USER_WORDS * n.messages if n.talks else 0),
    # Of PE k and the one at place i of its island at k * island + i: the idle spell in which k has
    # asked that for pixels; the load that it has told last, plus 1, 0 for none.
    "asked_in": Array(I4, lambda n: n.nb * n.island if n.steals else 0),
    "told_loads": Array(I4, lambda n: n.nb * n.island if n.steals else 0),
    # Misses with unasked rays: list 2 k of PE k, or 2 k + 1 from ask_from rays on.
    "unasked_ends": Array(I4, lambda n: 4 * n.nb),
    "unasked_links": Array(I4, lambda n: 2 * n.misses),
    # Misses in the transient memory of each PE, least recently used first.
    "recent_ends": Array(I4, lambda n: 2 * n.nb),
    "recent_links": Array(I4, lambda n: 2 * n.misses),
    # Peers with sendable rays: list 2 k of PE k, or 2 k + 1 from send_from rays on.
    "unsent_ends": Array(I4, lambda n: 4 * n.nb),
    "unsent_links": Array(I4, lambda n: 2 * n.peers),
    # Peers that rays or objects were exchanged with, one list per PE (for refresh).
    "exchanged_ends": Array(I4, lambda n: 2 * n.nb),
    "exchanged_links": Array(I4, lambda n: 2 * n.peers),
    # Misses with sendable rays: one list per peer or, with holders as candidates, per PE.
    "sendable_ends": Array(I4, lambda n: 2 * max(n.peers, n.nb)),
    "sendable_links": Array(I4, lambda n: 2 * n.misses),
    "outbox": Array(I4, lambda n: n.sent),  # messages that the last step sent, in order
    # First parts, plus 1, of the messages that a dispatch is making up: of rays and what goes with
    # them by distance in the ring, of requests alone nb further on.
    "made_up": Array(I4, lambda n: 2 * n.nb),
    "sort_keys": Array(I8, lambda n: max(n.objects, n.sent)),
    "sort_items": Array(I8, lambda n: max(n.objects, n.sent)),
    "tested_rays": Array(I4, lambda n: n.tested),
    "tested_objects": Array(I4, lambda n: n.tested),
    "ends_ps": Array(I8, lambda n: n.ended),  # of finished rays
    "free_ps": Array(I8),  # from when on each link and port is free; empty without contention
    "log": Array(EVENT, lambda n: n.logged),
    # What a PE did in each bin, BINS per PE; this and what follows: empty without counters.
    "compute_bins": Array(I8, lambda n: n.counted * BINS),
    "communication_bins": Array(I8, lambda n: n.counted * BINS),
    "moments": Array(MOMENT, lambda n: BINS if n.counted else 0),
    "traffic": Array(TRAFFIC, lambda n: n.counted**2),  # from PE i to j at nb i + j
    "sizes": Array(I8, lambda n: len(MESSAGE_KINDS) * SIZES if n.counted else 0),  # of each kind
    "slices": Array(SLICE, lambda n: n.counted),
    "held_bins": Array(HELD, lambda n: n.counted * BINS if n.measured else 0),  # BINS per PE
    # of the compiled event loop
    "heap": Array(EVENT_KEY, lambda n: 0),  # grows
    "processes": Array(PROCESS, lambda n: 2 * n.nb),  # PEs, then their threads
}
"""Every array of a run, declared nowhere else."""


def allocated(sizes: Sizes) -> dict[str, NDArray[Any]]:
    """The arrays that are not given. The system gives memory only to pages that are touched."""
    return {
        name: np.zeros(array.length(sizes), array.dtype)
        for name, array in ARRAYS.items()
        if array.length is not None
    }


MACHINE = tuple(name for name, kind in get_type_hints(Machine).items() if kind is int)
"""Constants of the machine: its whole numbers."""

PARAMETERS = (
    *MACHINE,
    "processors",
    "island",  # PEs of an island
    "n_objects",
    *PACE,
    "contends",  # links and ports serve one message at a time
    "service",  # who answers requests: BY_PE, BY_THREAD or BY_NIC
    "depth_first",
    "keeps",  # fetched objects, in transient memory
    "transient",  # objects that it holds, 0: as many as fit
    "transient_bytes",  # bytes that it holds, 0: any
    "row_bytes",  # of ``resident``; 0 if replicas are not kept as bits
    "all_resident",
    "sends",
    "asks",
    "send",  # addresses of the policy's hooks, 0 for one that it does not have
    "ask",
    "keep",
    "heard",
    "idle",
    "send_from",  # waiting rays from which on they are asked
    "ask_from",
    "send_reads",  # groups of the view's fields
    "ask_reads",
    "keep_reads",
    "heard_reads",
    "idle_reads",
    "steals",  # PEs without rays ask others for pixels
    "talks",  # the policy may send messages of its own
    "remembers",  # each PE has a view of its own
    "to_holders",  # rays may go to any PE that holds what they need
    "random_key",
    "initial_load",  # floor(n0 / nb): known of a PE before it is heard
    "load_info",
    "listens",  # remembers the loads in headers
    "refresh_ps",  # NONE: no refresh
    "sample_ps",  # between two samples of all loads
    "merge_requests",
    "measures",  # there is a capacity to compare with,
    "bounded",  # credits, and room for rays and objects,
    "least_share",  # of rays that any PE has room for from another one
    "escapes",  # and a PE that can't go on fetches an object
    "n_rounds",
    "window",  # rounds that may be there together
    "barrier_ps",  # from the end of a round until all know
    "choosing_ps",  # of the reduction that a round begins with
    "deposits_from",  # deposits for one owner that are sent together
    "packing",  # what goes to one PE at one dispatch in one message
    "record_tests",
    "record_hops",
    "record_ends",
    "logs",
    "record_counters",
)
COUNTERS = (
    "rays_left",
    "last_ray_ps",  # latest end of a ray's last cost
    "rays_done",
    "tests",
    "rays_sent",
    "bytes_sent",
    "received",
    "activities",
    "n_logged",
    "bin_width",  # k: the bins of the counters are 2^k ps wide
    "n_events",  # in the heap of the compiled event loop
    "taken",  # 1: the first of them is being handled
    "arrivals",  # that it has seen
    "progress_at",  # ``activities`` at the last test or finished ray
    "sampled_ps",  # when all loads were last sampled
    "next_sample_ps",
    "user_dropped",  # messages of the policy's own that were one too many, or to nobody
    "deposited",  # deposits sent
    "n_over",  # rounds that are over
    "over_ps",  # when they were
    "next_round",  # that is to be announced,
    "is_announced",  # or is and has not begun
    "n_stale",  # events in the heap of sleepers whom a message woke before their time
)
REPORT = (
    "phase",  # of the PE's next instant
    "consumed",  # 1: the message of the inbox was received
    "n_sent",  # messages in the outbox
    "round_ps",  # when the round begins that this step has announced; NONE: it has not
    "handed",  # the message that a thread has handed over to its PE; NONE: none
)
"""What the last step of a PE wants its engine to know."""

RUN = np.dtype(
    [(name, "i8") for name in (*PARAMETERS, *COUNTERS, *REPORT)]
    + [(f"{name}_{what}", "i8") for name in ARRAYS for what in ("at", "n")]
)
