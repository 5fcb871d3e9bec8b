"""Packing messages, one function for each kind; each returns the moment when it has been packed."""

from __future__ import annotations

from typing import Any

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import take
from simmpp.engine.arrays.records import NONE, PACK, Run
from simmpp.engine.arrays.views import (
    copy_costs,
    message_marks,
    messages,
    object_bytes,
    outbox,
    owners,
    peer_rows,
    pes,
    sent_by_kind,
)
from simmpp.engine.network import depart
from simmpp.engine.pe.misses import note_exchange, peer_of
from simmpp.engine.record.counters import note_departure
from simmpp.engine.record.log import note_send
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST
from simmpp.machine.transfer import transfer_ps


@kernel
def copy_ps(cost: Any, payload_bytes: int) -> int:
    """Packing or unpacking of one message: fixed + per byte of payload."""
    return cost.fixed_ps + transfer_ps(payload_bytes, cost.bytes_per_s)


@kernel
def send_request(s: Run, me: int, obj: int, now_ps: int) -> int:
    """Ask the owner of an object for it."""
    row = _new_message(s, REQUEST, owners(s)[obj], s.request_bytes)
    messages(s)[row].obj = obj
    return _send(s, me, row, now_ps)


@kernel
def answer(s: Run, me: int, requester: int, obj: int, now_ps: int) -> int:
    """Send an object to who asked for it."""
    row = _new_message(s, OBJECT, requester, object_bytes(s)[obj])
    messages(s)[row].obj = obj
    return _send(s, me, row, now_ps)


@kernel
def send_rays(s: Run, me: int, owner: int, first: int, last: int, n: int, now_ps: int) -> int:
    """Send n linked rays, first ... last, which must have left the sender's load already."""
    row = _new_message(s, RAYS, owner, n * s.ray_bytes)
    m = messages(s)[row]
    m.first, m.last, m.n = first, last, n
    return _send(s, me, row, now_ps)


@kernel
def send_load(s: Run, me: int, other: int, now_ps: int) -> int:
    """Tell another PE the load, which is in every header: there is nothing else in this message."""
    return _send(s, me, _new_message(s, LOAD, other, 0), now_ps)


@kernel
def _new_message(s: Run, kind: int, destination: int, payload_bytes: int) -> int:
    row = take(messages(s), message_marks(s))
    m = messages(s)[row]
    m.kind, m.destination, m.payload_bytes = kind, destination, payload_bytes
    m.obj, m.n = NONE, 0
    return row


@kernel
def _send(s: Run, me: int, row: int, now_ps: int) -> int:
    """Pack a message and let it depart."""
    pe, m = pes(s)[me], messages(s)[row]
    cost_ps = s.send_startup_ps + copy_ps(copy_costs(s)[PACK + m.kind], m.payload_bytes)
    m.source, m.load, m.number = me, pe.load, pe.messages_sent
    m.depart_ps = now_ps + cost_ps
    depart(s, m)
    pe.messages_sent += 1
    sent_by_kind(s)[m.kind] += 1
    s.bytes_sent += m.payload_bytes + s.header_bytes
    if s.refresh_ps != NONE:
        peer_row = peer_of(s, me, m.destination)
        peer_rows(s)[peer_row].sent_ps = m.depart_ps
        if m.kind in (OBJECT, RAYS):
            note_exchange(s, me, peer_row)
    if s.logs:
        note_send(s, me, row, now_ps)
    if s.record_counters:
        note_departure(s, m)
    outbox(s)[s.n_sent] = row
    s.n_sent += 1
    return m.depart_ps
