"""Everything a run changes, as plain arrays that both engines share.

The *model* (``activities.py``) is written over these arrays alone: no object of an event-loop
library ever reaches it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit
from simmpp.engine.tables import NONE, Lists, Table, new_lists, new_table
from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.rules import DataflowPolicy
from simmpp.policy.table import POLICIES
from simmpp.workload.workload import Workload

PIGGYBACK, EXACT, NO_INFO = range(3)
LOAD_INFO = {"piggyback": PIGGYBACK, "exact": EXACT, "none": NO_INFO}

PE = np.dtype(
    [
        ("ready_first", "i4"),  # list of ready rays, linked through rays.next
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
        ("n_transient", "i4"),
        ("received_load", "i4"),  # 1 if the last work phase was the receipt of a LOAD message
    ],
    align=True,
)
RAY = np.dtype(
    [
        ("at", "i8"),  # next entry of itinerary_objects
        ("next", "i4"),  # next ray of the list that this ray is in
        ("granted", "i4"),  # 1: the next test uses a fetched object that is pinned for it
    ],
    align=True,
)
WANT = np.dtype(
    [
        ("key", "i8"),  # PE * N + object
        ("since", "i8"),  # pe.waits when its oldest unasked ray began to wait
        ("chain", "i4"),
        ("first", "i4"),  # waiting rays, oldest first
        ("last", "i4"),
        ("n", "i4"),
        ("unasked", "i4"),  # waiting rays that no request covers
        ("requests", "i4"),  # in flight
        ("pinned", "i4"),  # released rays that have not made their test yet
        ("transient", "i4"),  # 1: in transient memory
        ("partner", "i4"),  # row of the owner in ``partners``, if the policy sends
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
        ("arrival_ps", "i8"),
        ("number", "i8"),  # the sender's send number
        ("load", "i8"),  # the sender's, at packing, without the rays in the message
        ("payload_bytes", "i8"),
        ("chain", "i4"),
        ("source", "i4"),
        ("destination", "i4"),
        ("object", "i4"),
        ("first", "i4"),  # rays
        ("last", "i4"),
        ("n", "i4"),
        ("kind", "i4"),  # NONE: a free place
    ],
    align=True,
)
COPY = np.dtype([("fixed_ps", "i8"), ("bytes_per_s", "i8")])
PACK, UNPACK = range(2)
SETUP = np.dtype(
    [
        ("processors", "i8"),
        ("n_objects", "i8"),
        ("x", "i8"),
        ("y", "i8"),
        ("z", "i8"),
        ("send_startup_ps", "i8"),
        ("receive_startup_ps", "i8"),
        ("probe_ps", "i8"),
        ("latency_ps", "i8"),
        ("hop_latency_ps", "i8"),
        ("bytes_per_s", "i8"),  # the smaller of link and injection bandwidth
        ("header_bytes", "i8"),
        ("request_bytes", "i8"),
        ("ray_bytes", "i8"),
        ("ray_ps", "i8"),
        ("quantum", "i8"),
        ("depth_first", "i8"),
        ("transient", "i8"),
        ("all_resident", "i8"),
        ("sends", "i8"),
        ("asks", "i8"),
        ("may_send", "i8"),  # addresses of the policy's rules
        ("may_ask", "i8"),
        ("min_load", "i8"),
        ("initial_load", "i8"),  # floor(n0 / nb): known of a PE before it is heard
        ("batch", "i8"),
        ("ask_at_least", "i8"),
        ("load_info", "i8"),
        ("listens", "i8"),  # remembers the loads in headers
        ("refresh_ps", "i8"),  # NONE: no refresh
        ("merge_requests", "i8"),
        ("record_tests", "i8"),
    ],
    align=True,
)
TOTALS = np.dtype(
    [
        ("rays_left", "i8"),
        ("last_ray_ps", "i8"),  # latest end of a ray's last cost
        ("rays", "i8"),
        ("tests", "i8"),
        ("rays_sent", "i8"),
        ("bytes_sent", "i8"),
        ("received", "i8"),
        ("activities", "i8"),
    ],
    align=True,
)

# What the last step of a PE wants its engine to do, in ``report``.
PHASE, CONSUMED, OUTBOX, BEGAN, TESTS, RAYS_LEFT = range(6)
BEGIN, DISPATCH = 0, 1
NO_ACTIVITY, RECEIVE, COMPUTE = range(3)


class State(NamedTuple):
    """One run. Arrays of the workload are shared and read-only; the others are the run's own."""

    itinerary_offsets: NDArray[np.int64]
    itinerary_objects: NDArray[np.int32]
    child_offsets: NDArray[np.int32]
    object_bytes: NDArray[np.int64]
    test_ps: NDArray[np.int64]
    owners: NDArray[np.int32]
    resident: NDArray[np.uint8]
    """(nb, ceil(N / 8)) uint8: bit o of row k: PE k holds a replica of object o; (0, 0) if none."""
    setup: NDArray[np.void]
    """(1,) SETUP: constants of the run."""
    copy_costs: NDArray[np.void]
    """(2, 4) COPY: PACK and UNPACK of each kind of message."""
    totals: NDArray[np.void]
    """(1,) TOTALS."""
    sent_by_kind: NDArray[np.int64]
    """(4,) int64: messages sent."""
    pes: NDArray[np.void]
    """(nb,) PE."""
    rays: NDArray[np.void]
    """(n,) RAY."""
    wants: Table
    """WANT: objects that a PE lacks, or holds for a while."""
    unasked: Lists
    """Wants with unasked rays: list 2 k of PE k, or 2 k + 1 from ``ask_at_least`` rays on."""
    recent: Lists
    """Wants in the transient memory of each PE, least recently used first."""
    partners: Table
    """PARTNER: what a PE knows of another and holds for it."""
    unsent: Lists
    """Partners with sendable rays: list 2 k of PE k, or 2 k + 1 from ``batch`` rays on."""
    sendable: Lists
    """Wants with sendable rays: one list per partner."""
    messages: NDArray[np.void]
    """(capacity,) MESSAGE: in flight or in an inbox."""
    message_marks: NDArray[np.int32]
    """(2,) int32: free list and high-water mark of ``messages``."""
    outbox: NDArray[np.int32]
    """(capacity,) int32: messages that the last step sent, in order."""
    scratch: NDArray[np.int64]
    """(2, max(N, nb)) int64: keys and items being sorted."""
    tested_rays: NDArray[np.int32]
    tested_objects: NDArray[np.int32]
    report: NDArray[np.int64]
    """(6,) int64: PHASE, CONSUMED, OUTBOX, BEGAN, TESTS, RAYS_LEFT of the last step."""


def new_state(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    parameters: PolicyParameters,
    *,
    ready_order: str,
    record_tests: bool,
) -> State:
    """The state at time 0: all primary rays of its pixels are ready on each PE."""
    policy = POLICIES[parameters.name]
    nb, n_objects = machine.processors, workload.n_objects
    most_wants = min(nb * n_objects, workload.n_rays + nb * (placement.transient + 1))
    most_partners = min(nb * nb, 2 * workload.n_tests + 1)
    # One step sends at most a request per object (per ray, unmerged), a batch and a load per PE.
    most_sent = (n_objects if parameters.merge_requests else workload.n_rays) + 2 * nb + 1
    n_recorded = workload.n_tests if record_tests else 0
    state = State(
        itinerary_offsets=workload.itinerary_offsets,
        itinerary_objects=workload.itinerary_objects,
        child_offsets=workload.child_offsets,
        object_bytes=workload.object_bytes,
        test_ps=machine.test.per_object_ps(workload.object_kinds, workload.object_triangles),
        owners=placement.owners,
        resident=_resident_bits(placement, n_objects),
        setup=_setup(workload, machine, placement, parameters, policy, ready_order, record_tests),
        copy_costs=_copy_costs(machine),
        totals=np.zeros(1, TOTALS),
        sent_by_kind=np.zeros(4, np.int64),
        pes=np.zeros(nb, PE),
        rays=np.zeros(workload.n_rays, RAY),
        wants=new_table(WANT, most_wants + 1),
        unasked=new_lists(2 * nb, most_wants + 1),
        recent=new_lists(nb, most_wants + 1),
        partners=new_table(PARTNER, most_partners + 1),
        unsent=new_lists(2 * nb, most_partners + 1),
        sendable=new_lists(most_partners + 1 if policy.sends else 1, most_wants + 1),
        messages=np.zeros(n_objects + 2 * nb + 1, MESSAGE),
        message_marks=np.array([NONE, 0], np.int32),
        outbox=np.zeros(most_sent, np.int32),
        scratch=np.zeros((2, max(n_objects, nb)), np.int64),
        tested_rays=np.zeros(n_recorded, np.int32),
        tested_objects=np.zeros(n_recorded, np.int32),
        report=np.zeros(6, np.int64),
    )
    state.rays["at"] = workload.itinerary_offsets[:-1]
    state.pes["held_bytes"] = _resident_bytes(workload, placement, policy.all_resident)
    _deal(state, placement.pixel_pes)
    return state


def room_for_messages(state: State) -> State:
    """The state with place for all that one more step may send."""
    rays_left = int(state.totals["rays_left"][0])
    needed = min(len(state.outbox), rays_left + 2 * len(state.pes) + 1)
    if len(state.messages) - state.message_marks[1] >= needed:
        return state
    bigger = np.zeros(2 * len(state.messages) + needed, MESSAGE)
    bigger[: len(state.messages)] = state.messages
    return state._replace(messages=bigger)


def _resident_bits(placement: Placement, n_objects: int) -> NDArray[np.uint8]:
    if len(placement.replica_objects) == 0:
        return np.zeros((0, 0), np.uint8)
    bits = np.zeros((placement.processors, (n_objects + 7) // 8), np.uint8)
    _set_bits(bits, placement.replica_offsets, placement.replica_objects)
    return bits


@njit
def _set_bits(
    bits: NDArray[np.uint8], offsets: NDArray[np.int64], objects: NDArray[np.int32]
) -> None:
    for pe in range(offsets.size - 1):
        for at in range(offsets[pe], offsets[pe + 1]):
            bits[pe, objects[at] >> 3] |= np.uint8(1 << (objects[at] & 7))


def _resident_bytes(
    workload: Workload, placement: Placement, all_resident: bool
) -> NDArray[np.int64]:
    nb = placement.processors
    if all_resident:
        return np.full(nb, workload.object_bytes.sum(), np.int64)
    total = np.zeros(nb, np.int64)
    np.add.at(total, placement.owners, workload.object_bytes)
    holders = np.repeat(np.arange(nb), np.diff(placement.replica_offsets))
    np.add.at(total, holders, workload.object_bytes[placement.replica_objects])
    return total


def _setup(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    parameters: PolicyParameters,
    policy: DataflowPolicy,
    ready_order: str,
    record_tests: bool,
) -> NDArray[np.void]:
    setup = np.zeros(1, SETUP)
    nb, n0 = machine.processors, workload.n_primaries
    load_info = LOAD_INFO[parameters.load_info]
    limits = [b for b in (machine.link_bytes_per_s, machine.injection_bytes_per_s) if b]
    min_load = parameters.min_load
    values: dict[str, object] = {
        **{name: getattr(machine, name) for name in SETUP.names or () if hasattr(machine, name)},
        "n_objects": workload.n_objects,
        "bytes_per_s": min(limits, default=0),
        "depth_first": ready_order == "depth-first",
        "transient": placement.transient,
        "all_resident": policy.all_resident,
        "sends": policy.sends,
        "asks": policy.asks,
        "may_send": policy.may_send.address,
        "may_ask": policy.may_ask.address,
        # A load is an integer: it exceeds a fraction exactly if it exceeds its floor.
        "min_load": min_load if isinstance(min_load, int) else min_load * n0 // nb,
        "initial_load": n0 // nb,
        "batch": parameters.batch,
        "ask_at_least": policy.ask_at_least or parameters.ask_at_least,
        "load_info": load_info,
        "listens": policy.knows_loads and load_info == PIGGYBACK,
        "refresh_ps": NONE if parameters.refresh_ps is None else parameters.refresh_ps,
        "merge_requests": parameters.merge_requests,
        "record_tests": record_tests,
    }
    values["x"], values["y"], values["z"] = machine.shape
    for name, value in values.items():
        setup[name] = value
    return setup


def _copy_costs(machine: Machine) -> NDArray[np.void]:
    return np.array(
        [
            [(cost.fixed_ps, cost.bytes_per_s) for cost in costs]
            for costs in (machine.pack, machine.unpack)
        ],
        COPY,
    )


@njit
def _deal(s: State, pixel_pes: NDArray[np.int32]) -> None:
    for k in range(s.pes.size):
        s.pes[k].ready_first = NONE
        s.pes[k].ready_last = NONE
    for ray in range(pixel_pes.size):
        pe = s.pes[pixel_pes[ray]]
        s.rays[ray].next = NONE
        if pe.ready_first == NONE:
            pe.ready_first = ray
        else:
            s.rays[pe.ready_last].next = ray
        pe.ready_last = ray
        pe.n_ready += 1
    for k in range(s.pes.size):
        pe = s.pes[k]
        pe.load = pe.n_ready
        pe.settled_load = pe.n_ready
        pe.peak_rays = pe.n_ready
        pe.peak_bytes = pe.held_bytes + pe.n_ready * s.setup[0].ray_bytes
    s.totals[0].rays_left = pixel_pes.size
