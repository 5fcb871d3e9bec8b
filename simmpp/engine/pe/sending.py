"""Packing a message, and when it arrives, alone or behind others."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit_reading as njit
from simmpp.engine.arrays.hashtable import take
from simmpp.engine.arrays.layout import NONE, PACK, Row, Run
from simmpp.engine.arrays.views import (
    copy_costs,
    free_ps,
    messages,
    messages_marks,
    outbox,
    partner_rows,
    pes,
    sent_by_kind,
)
from simmpp.engine.pe.misses import note_exchange, partner_of
from simmpp.engine.record.counters import note_departure
from simmpp.engine.record.log import note_send
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.messages import OBJECT, RAYS
from simmpp.machine.torus import ejection_port, hops, injection_port, link_towards
from simmpp.machine.transfer import transfer_ps


@njit
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one message: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


@njit
def send(
    s: Run,
    me: int,
    destination: int,
    kind: int,
    wanted: int,
    first: int,
    last: int,
    n: int,
    payload_bytes: int,
    now_ps: int,
) -> int:
    """Pack a message and let it depart; returns the moment when it has been packed.

    The rays first ... last of a RAYS message must have left the sender's load already.
    """
    pe = pes(s)[me]
    depart_ps = now_ps + s.send_startup_ps + copy_ps(copy_costs(s)[PACK + kind], payload_bytes)
    row = take(messages(s), messages_marks(s))
    m = messages(s)[row]
    m.kind, m.source, m.destination = kind, me, destination
    m.object, m.first, m.last, m.n = wanted, first, last, n
    m.payload_bytes, m.load = payload_bytes, pe.load
    m.depart_ps, m.number = depart_ps, pe.messages_sent
    if s.contends:
        inject(s, m)
    else:
        m.arrival_ps = depart_ps + flight_ps(s, me, destination, payload_bytes)
    pe.messages_sent += 1
    sent_by_kind(s)[kind] += 1
    s.bytes_sent += payload_bytes + s.header_bytes
    if s.refresh_ps != NONE:
        partner = partner_of(s, me, destination)
        partner_rows(s)[partner].sent_ps = depart_ps
        if kind in (OBJECT, RAYS):
            note_exchange(s, me, partner)
    if s.logs:
        note_send(s, me, row, now_ps)
    if s.record_counters:
        note_departure(s, m)
    outbox(s)[s.n_sent] = row
    s.n_sent += 1
    return depart_ps


@njit
def flight_ps(s: Run, source: int, destination: int, payload_bytes: int) -> int:
    """From departure to arrival on an uncontended torus."""
    n_hops = hops(s.x, s.y, s.z, source, destination)
    return (
        s.latency_ps
        + n_hops * s.hop_latency_ps
        + transfer_ps(payload_bytes + s.header_bytes, s.bytes_per_s)
    )


@njit
def inject(s: Run, m: Row) -> None:
    """Take the port of the sender, which no one else uses and which its messages reach in order."""
    m.busy_ps = transfer_ps(m.payload_bytes + s.header_bytes, s.bytes_per_s)
    m.at, m.arrival_ps = m.source, NONE
    m.head_ps = _take(s, injection_port(m.source), m.depart_ps, m.busy_ps) + s.latency_ps


@njit
def move_head(runs: NDArray[np.void], message: int) -> int:
    """The head of a message is at a link or at the last port: it takes it as soon as that is free.

    Returns when the head is at the next one, or when the message arrives, which is known then.
    """
    s: Run = runs[0]
    m = messages(s)[message]
    if m.at == m.destination:
        m.arrival_ps = _take(s, ejection_port(m.at), m.head_ps, m.busy_ps) + m.busy_ps
        return m.arrival_ps
    link, m.at = link_towards((s.x, s.y, s.z), m.at, m.destination)
    m.head_ps = _take(s, link, m.head_ps, m.busy_ps) + s.hop_latency_ps
    return m.head_ps


@njit
def _take(s: Run, row: int, now_ps: int, busy_ps: int) -> int:
    """Keep a link or port busy from when it is free; returns when that is."""
    start_ps = max(now_ps, free_ps(s)[row])
    if start_ps > CLOCK_LIMIT_PS:
        raise OverflowError("the clock")
    free_ps(s)[row] = start_ps + busy_ps
    return start_ps
