"""Gets that come to a network card: what they ask for departs at once, without the PE.

``machine.service: nic``; the PE that gets is in ``sending`` and ``step`` like any that sends and
receives. A message of a get becomes its answer, in its place.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import ITS_LOAD, NONE, Row, Run
from simmpp.engine.arrays.views import (
    messages,
    object_bytes,
    outbox,
    parts_by_kind,
    pes,
    sent_by_kind,
)
from simmpp.engine.network import depart
from simmpp.engine.record.counters import count_message
from simmpp.engine.record.log import note_answer
from simmpp.machine.messages import OBJECT, REQUEST
from simmpp.machine.service import LOAD_BYTES


@kernel
def is_get(m: Row) -> bool:
    """Is it for the network card of its destination?"""
    return m.kind == REQUEST or m.obj == ITS_LOAD


@kernel
def send_back(s: Run, message: int) -> None:
    """A get has arrived: what it asks for departs, and is in the outbox."""
    m = messages(s)[message]
    m.depart_ps = m.arrival_ps
    asked, asking = m.destination, m.source
    m.source, m.destination = asked, asking
    if m.kind == REQUEST:
        m.kind, m.payload_bytes = OBJECT, object_bytes(s)[m.obj]
    else:
        m.obj, m.payload_bytes = NONE, LOAD_BYTES
    m.part_bytes = m.payload_bytes
    m.load = pes(s)[asked].settled_load  # not one in the middle of an activity
    m.number = pes(s)[asked].messages_sent
    depart(s, m)
    pes(s)[asked].messages_sent += 1
    sent_by_kind(s)[m.kind] += 1
    parts_by_kind(s)[m.kind] += 1
    s.bytes_sent += m.payload_bytes + s.header_bytes
    s.received += 1
    if s.logs:
        note_answer(s, message, m.depart_ps)
    if s.record_counters:
        count_message(s, m, 1)
    outbox(s)[0], s.n_sent = message, 1
