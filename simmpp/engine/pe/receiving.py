"""A message is received: what is in it is unpacked, and requests are answered."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import FOR_ESCAPE, NONE, UNPACK, Row, Run
from simmpp.engine.arrays.views import messages, peer_rows, pes, topology
from simmpp.engine.pe.bounds.admission import unpacking_ps
from simmpp.engine.pe.bounds.escape import admit_escape
from simmpp.engine.pe.bounds.rooms import note_receipt
from simmpp.engine.pe.costs import receiving_ps
from simmpp.engine.pe.fetched import admit_object
from simmpp.engine.pe.peers import note_exchange, peer_of
from simmpp.engine.pe.ready import cross, make_ready
from simmpp.engine.pe.sending import answer, forget, parts_ps
from simmpp.engine.pe.talking import get_on, hear
from simmpp.engine.record.counters import note_load, note_work
from simmpp.engine.record.log import note_receive
from simmpp.machine.messages import LOAD, OBJECT, RAYS, USER
from simmpp.machine.topology import hops


@kernel
def receive(s: Run, me: int, message: int, now_ps: int) -> int:
    """Unpack one message and do what it asks for; returns the end of that work."""
    pe, m = pes(s)[me], messages(s)[message]
    links = hops(topology(s), m.source, me) if s.record_hops else 0
    if links > 0 and m.kind == RAYS:
        cross(s, m.first, m.n, links)
    if s.measures:
        note_receipt(s, me, message)
    clock_ps = now_ps + receiving_ps(s, me, m.source, m.kind)
    if s.bounded:
        clock_ps += unpacking_ps(s, me, message)
    else:
        clock_ps += parts_ps(s, message, UNPACK)
    # Heard before an answer is packed, and whatever the message is.
    _hear(s, me, m.source, m.load, m.kind, clock_ps)
    pe.received_load = 1 if m.kind == LOAD else 0
    part = message
    while part != NONE:
        _take_in(s, me, messages(s)[part], links)
        part = messages(s)[part].part
    if s.logs:
        note_receive(s, me, message, now_ps, clock_ps)
    if s.record_counters and m.kind == RAYS:
        note_load(s, me, clock_ps)
    # Requests are answered as part of the receipt, not by the policy: no one can be left waiting by
    # a rule.
    clock_ps = answer(s, me, message, clock_ps)
    if m.kind == USER:
        clock_ps = hear(s, me, message, clock_ps)
    elif m.kind == OBJECT or m.kind == RAYS:
        get_on(pe)
    s.received += 1
    if s.record_counters:
        note_work(s, me, now_ps, clock_ps, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    if s.bounded and m.kind == RAYS and m.first != NONE:  # what did not fit stays
        forget(s, m.part)
        m.part = NONE
    else:
        forget(s, message)
    return clock_ps


@kernel
def _take_in(s: Run, me: int, m: Row, links: int) -> None:
    """The part of a message that rays or an object are, which came over that many links."""
    if m.kind == OBJECT and m.purpose == FOR_ESCAPE:
        admit_escape(s, me, 2 * links)
    elif m.kind == OBJECT:
        admit_object(s, me, m.obj, 2 * links)
    elif m.kind == RAYS and not s.bounded:
        pe = pes(s)[me]
        pe.load += m.n
        pe.peak_rays = max(pe.peak_rays, pe.load)
        make_ready(s, me, m.first, m.last, m.n)


@kernel
def _hear(s: Run, me: int, source: int, load: int, kind: int, now_ps: int) -> None:
    """Remember the load in a header, and whom rays or objects came from."""
    if s.listens:
        peer_row = peer_of(s, me, source)
        peer_rows(s)[peer_row].load = load
        peer_rows(s)[peer_row].heard_ps = now_ps
        peer_rows(s)[peer_row].in_flight = 0
        if s.refresh_ps != NONE and kind in (OBJECT, RAYS):
            note_exchange(s, me, peer_row)
