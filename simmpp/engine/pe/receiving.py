"""A message is received: what is in it is unpacked, and requests are answered."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import (
    BY_PE,
    BY_THREAD,
    FOR_ESCAPE,
    FOR_PIXELS,
    NONE,
    ORDINARY,
    UNPACK,
    Row,
    Run,
)
from simmpp.engine.arrays.views import messages, pes, topology
from simmpp.engine.pe.bounds.admission import taking_in_ps
from simmpp.engine.pe.bounds.escape import admit_escape
from simmpp.engine.pe.bounds.rooms import note_receipt
from simmpp.engine.pe.costs import parts_ps, receiving_ps
from simmpp.engine.pe.fetched import admit_object
from simmpp.engine.pe.peers import hear_load
from simmpp.engine.pe.ready import cross, make_ready
from simmpp.engine.pe.sending import answer, forget
from simmpp.engine.pe.stealing import end_spell, give_pixels, take_pixels
from simmpp.engine.pe.tables.tallies import take_deposits
from simmpp.engine.pe.talking import get_on, hear
from simmpp.engine.record.counters import note_load, note_work
from simmpp.engine.record.log import note_receive
from simmpp.machine.messages import DEPOSIT, LOAD, OBJECT, RAYS, REQUEST, STEAL, USER
from simmpp.machine.topology import hops


@kernel
def receive(s: Run, me: int, message: int, now_ps: int) -> int:
    """Unpack one message and do what it asks for; returns the end of that work.

    If a thread has done that already, take the message over.
    """
    pe, m = pes(s)[me], messages(s)[message]
    links = hops(topology(s), m.source, me) if s.record_hops else 0
    if links > 0 and m.kind == RAYS:
        cross(s, m.first, m.n, links)
    if s.measures:
        note_receipt(s, me, message)
    if s.service == BY_THREAD:
        clock_ps = now_ps + s.handoff_ps
    else:
        clock_ps = now_ps + unpacking_ps(s, me, message)
        # Heard before an answer is packed, and whatever the message is.
        if s.listens:
            hear_load(s, me, m, clock_ps)
        s.received += 1
    pe.received_load = 1 if m.kind == LOAD else 0
    part = message
    while part != NONE:
        _take_in(s, me, messages(s)[part], links)
        part = messages(s)[part].part
    if s.logs:
        note_receive(s, me, message, now_ps, clock_ps)
    if s.record_counters and m.kind in (RAYS, STEAL):
        note_load(s, me, clock_ps)
    # Requests are answered as part of the receipt, not by the policy: no one can be left waiting by
    # a rule.
    if s.service == BY_PE and (m.kind == REQUEST or m.part != NONE):
        clock_ps = answer(s, me, message, clock_ps, False)
    clock_ps = _react(s, me, pe, message, clock_ps)
    if s.record_counters:
        note_work(s, me, now_ps, clock_ps, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    _forget_what_is_read(s, message)
    return clock_ps


@kernel
def _react(s: Run, me: int, pe: Row, message: int, now_ps: int) -> int:
    """What becomes of other messages, and of the PE; returns the end of that."""
    m = messages(s)[message]
    if m.kind == USER:
        return hear(s, me, message, now_ps)
    if m.kind == STEAL and m.purpose == FOR_PIXELS:
        return give_pixels(s, me, m, now_ps)
    if m.kind == DEPOSIT:
        take_deposits(s, m, now_ps)
    elif m.kind == OBJECT or m.n > 0:  # of rays, or pixels
        get_on(pe)
        if s.steals and m.n > 0:
            end_spell(pe)
    return now_ps


@kernel
def unpacking_ps(s: Run, me: int, message: int) -> int:
    """What a message costs its receiver; with credits, what fits of it is taken in."""
    m = messages(s)[message]
    startup_ps = receiving_ps(s, me, m.source, m.kind)
    if s.bounded:
        return startup_ps + taking_in_ps(s, me, message)
    return startup_ps + parts_ps(s, message, UNPACK)


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
    elif m.kind == STEAL and m.purpose == ORDINARY:
        take_pixels(s, me, m, links)


@kernel
def _forget_what_is_read(s: Run, message: int) -> None:
    """With credits, rays that did not fit stay in their message."""
    m = messages(s)[message]
    if s.bounded and m.kind == RAYS and m.first != NONE:
        forget(s, m.part)
        m.part = NONE
    else:
        forget(s, message)
