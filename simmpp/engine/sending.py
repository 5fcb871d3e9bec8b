"""Packing a message, and the time it takes to arrive without contention."""

from __future__ import annotations

from typing import Any

from simmpp.compiled import njit
from simmpp.engine.state import OUTBOX, PACK, State
from simmpp.engine.tables import NONE, take
from simmpp.engine.waiting import partner_of
from simmpp.machine.messages import OBJECT, RAYS
from simmpp.machine.network import transfer_ps
from simmpp.machine.torus import hops


@njit
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one message: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


@njit
def send(
    s: State,
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
    setup, pe, totals = s.setup[0], s.pes[me], s.totals[0]
    depart_ps = now_ps + setup.send_startup_ps + copy_ps(s.copy_costs[PACK, kind], payload_bytes)
    row = take(s.messages, s.message_marks)
    m = s.messages[row]
    m.kind, m.source, m.destination = kind, me, destination
    m.object, m.first, m.last, m.n = wanted, first, last, n
    m.payload_bytes, m.load = payload_bytes, pe.load
    m.depart_ps, m.number = depart_ps, pe.messages_sent
    m.arrival_ps = depart_ps + flight_ps(s, me, destination, payload_bytes)
    pe.messages_sent += 1
    s.sent_by_kind[kind] += 1
    totals.bytes_sent += payload_bytes + setup.header_bytes
    if setup.refresh_ps != NONE:
        partner = s.partners.rows[partner_of(s, me, destination)]
        partner.sent_ps = depart_ps
        if kind in (OBJECT, RAYS):
            partner.exchanged = 1
    s.outbox[s.report[OUTBOX]] = row
    s.report[OUTBOX] += 1
    return depart_ps


@njit
def flight_ps(s: State, source: int, destination: int, payload_bytes: int) -> int:
    """From departure to arrival on an uncontended torus."""
    setup = s.setup[0]
    n_hops = hops(setup.x, setup.y, setup.z, source, destination)
    return (
        setup.latency_ps
        + n_hops * setup.hop_latency_ps
        + transfer_ps(payload_bytes + setup.header_bytes, setup.bytes_per_s)
    )
