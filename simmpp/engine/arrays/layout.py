"""How the state of a run lies in memory: one record of scalars and of where its arrays are.

The model gets this one record. Thirty arrays as arguments would be copied word by word at every
call between compiled functions; a record is one pointer.
"""

from __future__ import annotations

from typing import Any

import numpy as np

# --- how the counters of a run lie in memory: of bins of time, of pairs of PEs, of PEs ---


BINS = 1024
"""Bins of time; a run fills more than half of them."""
SIZES = 48
"""Sizes of messages are counted by powers of two."""

MOMENT = np.dtype(
    [
        ("finished", "i8"),  # rays finished by computations that ended in the bin
        ("batches", "i8"),  # messages of rays that departed in it,
        ("rays", "i8"),  # rays in them,
        ("largest", "i8"),  # rays in the largest
    ]
)
"""What all PEs together did in a bin."""
TRAFFIC = np.dtype([("messages", "i8"), ("bytes", "i8")])
"""From one PE to another, with headers."""
SLICE = np.dtype(
    [
        ("begin_ps", "i8"),  # of the PE's latest work: communication, then
        ("tests_ps", "i8"),  # tests and rays from here on
        ("end_ps", "i8"),
        ("load", "i8"),
        ("since_ps", "i8"),  # when the load became that
        ("load_ps", "i8"),  # rays held times how long, until then
    ]
)
"""What is counted of a PE when it works again, or the run is over: it may end before the work."""


Run = Any
"""A RUN record; numba's type, which Python has no name for."""
Row = Any
"""A record of one of the arrays."""

NONE = -1

PE = np.dtype(
    [
        ("ready_first", "i4"),  # list of ready rays, linked through RAY.next
        ("ready_last", "i4"),
        ("n_ready", "i8"),
        ("load", "i8"),  # rays held: ready + waiting
        ("settled_load", "i8"),  # load at the end of the last ended activity
        ("waits", "i8"),  # rays that ever began to wait: orders waiting rays by age
        ("messages_sent", "i8"),
        ("busy_until_ps", "i8"),
        ("compute_ps", "i8"),
        ("communication_ps", "i8"),
        ("held_bytes", "i8"),  # resident and fetched objects
        ("peak_rays", "i8"),
        ("peak_bytes", "i8"),
        ("peak_object_bytes", "i8"),  # of held_bytes
        ("n_transient", "i4"),
        ("received_load", "i4"),  # 1 if the last work phase was the receipt of a LOAD message
    ],
    align=True,
)
RAY = np.dtype(
    [
        ("tested", "i4"),  # objects of its itinerary that it has been tested against
        ("next", "i4"),  # next ray of the list that this ray is in
        ("granted", "i4"),  # 1: the next test uses a fetched object that is pinned for it
        ("hops", "i4"),  # with record_hops: links crossed for it
    ],
    align=True,
)
WANT = np.dtype(
    [
        ("key", "i8"),  # PE * N + object
        ("since", "i8"),  # PE.waits when its oldest unasked ray began to wait
        ("chain", "i4"),
        ("first", "i4"),  # waiting rays, oldest first
        ("last", "i4"),
        ("n", "i4"),
        ("unasked", "i4"),  # waiting rays that no request covers
        ("requests", "i4"),  # in flight
        ("pinned", "i4"),  # released rays that have not made their test yet
        ("transient", "i4"),  # 1: in transient memory
        ("partner", "i4"),  # row of the owner in ``partners``, if the policy sends
        ("hops", "i4"),  # with record_hops: links to the owner
    ],
    align=True,
)
PARTNER = np.dtype(
    [
        ("key", "i8"),  # PE * nb + the other PE
        ("load", "i8"),  # last heard; NONE if never
        ("heard_ps", "i8"),
        ("sent_ps", "i8"),  # departure of the last message to it, 0 if none
        ("chain", "i4"),
        ("sendable", "i4"),  # rays waiting for its objects that may be sent
        ("exchanged", "i4"),  # 1: rays or objects went from one to the other
    ],
    align=True,
)
MESSAGE = np.dtype(
    [
        ("depart_ps", "i8"),
        ("number", "i8"),  # the sender's send number
        ("load", "i8"),  # the sender's, at packing, without the rays in the message
        ("payload_bytes", "i8"),
        ("arrival_ps", "i8"),
        ("busy_ps", "i8"),  # with contention: how long it keeps each link and port busy,
        ("head_ps", "i8"),  # when its head is at the next link or port,
        ("at", "i4"),  # and the PE where that is
        ("destination", "i4"),
        ("source", "i4"),
        ("chain", "i4"),
        ("object", "i4"),
        ("first", "i4"),  # rays
        ("last", "i4"),
        ("n", "i4"),
        ("kind", "i4"),  # NONE: a free place
    ],
    align=True,
)
COPY = np.dtype([("fixed_ps", "i8"), ("bytes_per_s", "i8")])
"""Cost of packing (4 kinds of message), then of unpacking (4 kinds)."""

EVENT = np.dtype(
    [
        ("time_ps", "i8"),  # when a message arrives, or the PE begins
        ("end_ps", "i8"),  # when the PE is done, a message sent departs; of an arrival: time_ps
        ("number", "i8"),  # the sender's send number; NONE if there is no message or it never left
        ("payload_bytes", "i8"),
        ("tests", "i8"),
        ("pe", "i4"),  # who receives, computes or sends; destination of an arrival
        ("other", "i4"),  # who the message comes from or, SEND, goes to; NONE without one
        ("rays", "i4"),  # in the message; finished by a COMPUTE
        ("load", "i4"),  # of the PE, when it is done
        ("ready", "i4"),  # rays of the load that are ready then; the others wait
        ("event", "i2"),  # ARRIVAL, RECEIVE, COMPUTE or SEND
        ("kind", "i2"),  # of the message; NONE without one
    ]
)
"""One row of the event log, a cache line."""

I1, I4, I8 = np.dtype("u1"), np.dtype("i4"), np.dtype("i8")

ARRAYS: dict[str, np.dtype[Any]] = {
    # of the workload and the placement: shared, only read
    "itinerary_offsets": I8,
    "itinerary_objects": I4,
    "child_offsets": I4,
    "object_bytes": I8,
    "test_ps": I8,
    "owners": I4,
    # Replicas as bits (bit o of the row_bytes at k * row_bytes: PE k holds object o) or, where
    # that takes less memory, as sorted ids (CSR); the other form is empty.
    "resident": I1,
    "replica_offsets": I8,
    "replica_objects": I4,
    # of the run
    "copy_costs": COPY,
    "sent_by_kind": I8,
    "pes": PE,
    "rays": RAY,
    "wants": WANT,  # objects that a PE lacks, or holds for a while
    "wants_buckets": I4,
    "wants_marks": I4,
    "partners": PARTNER,  # what a PE knows of another and holds for it
    "partners_buckets": I4,
    "partners_marks": I4,
    "messages": MESSAGE,  # in flight or in an inbox
    "messages_marks": I4,
    # Wants with unasked rays: list 2 k of PE k, or 2 k + 1 from ask_at_least rays on.
    "unasked_ends": I4,
    "unasked_links": I4,
    # Wants in the transient memory of each PE, least recently used first.
    "recent_ends": I4,
    "recent_links": I4,
    # Partners with sendable rays: list 2 k of PE k, or 2 k + 1 from batch rays on.
    "unsent_ends": I4,
    "unsent_links": I4,
    # Partners that rays or objects were exchanged with, one list per PE (for refresh).
    "exchanged_ends": I4,
    "exchanged_links": I4,
    # Wants with sendable rays: one list per partner.
    "sendable_ends": I4,
    "sendable_links": I4,
    "outbox": I4,  # messages that the last step sent, in order
    "sort_keys": I8,
    "sort_items": I8,
    "tested_rays": I4,
    "tested_objects": I4,
    "free_ps": I8,  # from when on each link and port is free; empty without contention
    "log": EVENT,
    # What a PE did in each bin, BINS per PE; this and what follows: empty without record_counters.
    "compute_bins": I8,
    "communication_bins": I8,
    "moments": MOMENT,
    "traffic": TRAFFIC,  # from PE i to j at nb i + j
    "sizes": I8,  # SIZES per kind of message
    "slices": SLICE,
}
"""Every array of a run; ``<name>_at`` in RUN is its address, ``<name>_n`` its length."""

PARAMETERS = (
    "processors",
    "n_objects",
    "x",  # shape of the torus
    "y",
    "z",
    "send_startup_ps",
    "receive_startup_ps",
    "probe_ps",
    "latency_ps",
    "hop_latency_ps",
    "bytes_per_s",  # the smaller of link and injection bandwidth
    "contends",  # links and ports serve one message at a time
    "header_bytes",
    "request_bytes",
    "ray_bytes",
    "ray_ps",
    "quantum",
    "depth_first",
    "transient",
    "row_bytes",  # of ``resident``; 0 if replicas are not kept as bits
    "all_resident",
    "sends",
    "asks",
    "may_send",  # addresses of the policy's rules
    "may_ask",
    "min_load",
    "initial_load",  # floor(n0 / nb): known of a PE before it is heard
    "batch",
    "ask_at_least",
    "load_info",
    "listens",  # remembers the loads in headers
    "refresh_ps",  # NONE: no refresh
    "merge_requests",
    "record_tests",
    "record_hops",
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
)
REPORT = (
    "phase",  # of the PE's next instant
    "consumed",  # 1: the message of the inbox was received
    "n_sent",  # messages in the outbox
)
"""What the last step of a PE wants its engine to know."""

RUN = np.dtype(
    [(name, "i8") for name in (*PARAMETERS, *COUNTERS, *REPORT)]
    + [(f"{name}_{what}", "i8") for name in ARRAYS for what in ("at", "n")]
)

PIGGYBACK, EXACT, NO_INFO = range(3)
LOAD_INFO = {"piggyback": PIGGYBACK, "exact": EXACT, "none": NO_INFO}
BEGIN, DISPATCH = range(2)
ARRIVAL, RECEIVE, COMPUTE, SEND = range(4)
PACK, UNPACK = 0, 4
